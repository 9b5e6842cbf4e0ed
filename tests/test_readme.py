import re
import shutil
from pathlib import Path

import gymnasium
import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_code_in_the_readme_runs(two_rooms, tmp_path, monkeypatch) -> None:
    pytest.importorskip("torch")
    shutil.copytree(two_rooms, tmp_path / "out" / "remqa")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert len(blocks) >= 4
    for block in blocks:
        exec(block, names)
    assert names["sample"]["start_rgb"].shape == (3, 300, 300)
    assert isinstance(names["env"], gymnasium.Env)
    assert "error" in names["info"]
    assert (tmp_path / "kitchen.json").stat().st_size > 10_000
    assert names["seen"].rgb.shape == (300, 300, 3)
    fridge = names["world"].ids.index(names["fridge"])
    assert (names["seen"].objects == fridge).mean() > 0.2


def test_names_that_an_older_readme_or_card_used_still_work() -> None:
    from remqa_data import RemqaDataset, dataset
    from remqa_data.floorplans import load_scene
    from remqa_data.generators.floorplans import ithor
    from remqa_data.sim import Camera, World, WorldView, camera, view, world

    assert dataset.RemqaDataset is RemqaDataset
    assert (camera.Camera, view.WorldView, world.World) == (Camera, WorldView, World)
    assert ithor.load_scene("FloorPlan1").name == load_scene("FloorPlan1").name
