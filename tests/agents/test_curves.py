"""Curves of trainings as a picture."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from remqa_data.agents.cli import app
from remqa_data.agents.figures.curves import write_curves_picture
from remqa_data.errors import ConfigError
from remqa_data.opencv import cv2

HEAD = "epoch,loss,val_success,val_steps\n"


def trained(folder: Path, name: str, *scores: float | None) -> None:
    (folder / name).mkdir()
    rows = [f"{k},0.5,{'' if score is None else score},31.5\n" for k, score in enumerate(scores, 1)]
    (folder / name / "curves.csv").write_text(HEAD + "".join(rows))


@pytest.mark.slow
def test_seeds_share_a_panel_and_networks_have_their_own(tmp_path: Path) -> None:
    trained(tmp_path, "a3c", 0.1, 0.2)
    assert write_curves_picture(tmp_path, tmp_path / "one.png") == 1
    trained(tmp_path, "a3c-1", 0.3, None, 0.1)
    assert write_curves_picture(tmp_path, tmp_path / "seeds.png") == 2
    trained(tmp_path, "scene_priors", 0.3)
    assert write_curves_picture(tmp_path, tmp_path / "two.png") == 3
    one, seeds, two = (cv2.imread(str(tmp_path / f"{name}.png")) for name in ("one", "seeds", "two"))
    assert one.shape == seeds.shape
    assert (one != seeds).any()
    assert two.shape[1] == 2 * one.shape[1]
    assert write_curves_picture(tmp_path, tmp_path / "chosen.png", ["scene_priors"]) == 1


@pytest.mark.slow
def test_what_has_no_curves_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="any network"):
        write_curves_picture(tmp_path, tmp_path / "none.png")
    trained(tmp_path, "a3c", 0.1)
    done = CliRunner().invoke(app, ["curves", "savn", "--weights", str(tmp_path), "-o", str(tmp_path / "none.png")])
    assert done.exit_code == 2
    assert "no curves of savn" in done.output
    assert not (tmp_path / "none.png").exists()
