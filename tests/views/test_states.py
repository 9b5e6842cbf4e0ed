"""States are poses, numbered."""

import pytest

from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, HORIZONS_DEG
from remqa_data.views.states import States

STATES = States.of([(3, -1), (0, 0), (3, -1)], 0.25)


def test_every_state_is_a_pose_and_every_pose_a_state() -> None:
    poses = [STATES.pose(state) for state in range(len(STATES))]
    assert len(set(poses)) == len(STATES) == 2 * len(HEADINGS_DEG) * len(HORIZONS_DEG) * 2
    assert [STATES.number(*pose) for pose in poses] == list(range(len(STATES)))
    assert poses[0] == (0.0, 0.0, 0.0, -30.0, True)
    assert {pose[:2] for pose in poses} == {(0.0, 0.0), (0.75, -0.25)}
    assert STATES.poses().tolist() == [list(pose) for pose in poses]
    assert list(STATES.of_cells([(3, -1)])) == list(range(32, 64))


@pytest.mark.parametrize(
    "pose", [(0.1, 0.0, 90, 0), (0.25, 0.0, 90, 0), (0.0, 0.0, 45, 0), (0.0, 0.0, 89.9, 0), (0.0, 0.0, 90, 15)]
)
def test_poses_between_states_have_no_number(pose: tuple[float, float, float, float]) -> None:
    assert STATES.number(*pose) is None
    assert STATES.number(0.0, 0.0, 450, 0) == STATES.number(0.0, 0.0, 90, 0)
