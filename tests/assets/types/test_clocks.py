"""Dials and digits of clocks can be read from the front."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build


@pytest.mark.parametrize("size", [(0.19, 0.094, 0.182), (0.27, 0.09, 0.12), (0.14, 0.08, 0.20), (0.19, 0.20, 0.12)])
@pytest.mark.parametrize("variant", [0, 3])
def test_dial_is_round_and_nothing_is_before_it(size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec("AlarmClock", size, variant))
    surfaces = asset.links[0].surfaces
    dial = next(s for s in surfaces if s.material.texture == "clock_face")
    assert len(surfaces) > 1
    width, _, height = np.ptp(dial.vertices, axis=0)
    assert dial.normals[:, 1].max() < -0.99
    assert 0.8 < width / height < 1.25
    centre, radius = dial.vertices.mean(axis=0), width / 2
    for surface in surfaces:
        if surface is dial:
            continue
        offset = np.abs(surface.vertices - centre)
        before = surface.vertices[:, 1] < dial.vertices[:, 1].min() - 1e-4
        assert not (before & (np.hypot(offset[:, 0], offset[:, 2]) < 0.9 * radius)).any()
