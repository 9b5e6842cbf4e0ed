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
from ai2thor.video_controller import VideoController
with VideoController(scene="FloorPlan401", width=32, height=32) as video:
    done, step = [], video.step
    video.step = lambda *request, **more: done.append(step(*request, **more)) or done[-1]
    video.play(video.MoveBack(0.2, frames=2), video.OrbitCameraAnimation(-1.5, 2, 3, frames=2))
    video.play(video.RotateLeft(frames=2), video.RelativeCameraAnimation(px=0.1, rx=5, frames=2))
    video.play(video.AbsoluteCameraAnimation(-1.5, 4, 2, 90, 0, 0, frames=2, FOVstart=60, FOVend=40))
    video.ToggleCeiling()
    video.wait(1)
    assert len(done) == 14 and all(event.metadata["lastActionSuccess"] for event in done)
    assert {frame.shape for frame in video.saved_frames} == {(32, 32, 3)}
    assert len({frame.tobytes() for frame in video.saved_frames}) >= 6
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
