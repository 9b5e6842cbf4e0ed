import subprocess
import sys

import pytest

THEIRS = """
import ai2thor.controller
from ai2thor.controller import Controller

for kind in (Controller, ai2thor.controller.Controller):
    controller = kind(scene="FloorPlan401", width=32, height=32)
    assert controller.step("RotateRight").frame.shape == (32, 32, 3)
    assert isinstance(controller, Controller)
    controller.stop()
from ai2thor.controller import BFSController
controller = BFSController(grid_size=0.5)
assert isinstance(controller, Controller)
controller.search_all_closed("FloorPlan401")
assert len(controller.grid_points) > 5
controller.stop()
print(Controller.__module__)
"""


@pytest.mark.slow
def test_code_that_cannot_be_edited_gets_our_controller(tmp_path) -> None:
    script = tmp_path / "theirs.py"
    script.write_text(THEIRS)
    start = f"import remqa_data.thor.compat, runpy; runpy.run_path({str(script)!r}, run_name='__main__')"
    done = subprocess.run([sys.executable, "-c", start], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["remqa_data.thor.controller"]


@pytest.mark.slow
def test_without_it_ai2thor_is_as_it_was() -> None:
    start = "import remqa_data.thor, ai2thor.controller; print(ai2thor.controller.Controller.__module__)"
    done = subprocess.run([sys.executable, "-c", start], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["ai2thor.controller"]
