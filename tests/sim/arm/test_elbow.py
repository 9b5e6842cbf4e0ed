import math

import numpy as np
import pytest

from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.elbow import ELBOW, STEP_RAD, elbow_angle, elbow_way
from remqa_data.sim.arm.postures import HOME, ArmBase, link_poses, postures_to

pytestmark = pytest.mark.slow

BASE = ArmBase(0.5, -1.0, 30.0, 0.1)


def starts(count: int) -> list[np.ndarray]:
    """Postures with the hand somewhere before the agent."""
    rng, home, found = np.random.default_rng(0), HOME.posture(), []
    ahead = np.array([math.cos(math.radians(30.0)), math.sin(math.radians(30.0)), 0.0])
    while len(found) < count:
        point = np.array([0.5, -1.0, 0.1]) + rng.uniform(0.3, 0.7) * ahead + [*rng.uniform(-0.2, 0.2, 2), 0.8]
        axis = ahead + rng.uniform(-0.4, 0.4, 3)
        postures = postures_to(BASE, point, home[None, :2], axis[None] / np.linalg.norm(axis), home)
        found += list(postures[:1])
    return found


def placed(posture: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shoulder, elbow and hand."""
    poses = link_poses(BASE, posture[None])[0]
    return poses[0, :3, 3] + [0.0, 0.0, jaco.SHOULDER_M], poses[ELBOW, :3, 3], poses[jaco.HAND, :3, 3]


@pytest.mark.parametrize("degrees", [10.0, -10.0, 25.0])
def test_the_elbow_goes_round_and_the_hand_stays(degrees: float) -> None:
    ways = [(start, elbow_way(BASE, start, math.radians(degrees))) for start in starts(30)]
    possible = [(start, way) for start, way in ways if way is not None]
    assert len(possible) > 12
    for start, way in possible:
        _, _, hand = placed(start)
        for posture in way:
            assert np.allclose(placed(posture)[2], hand, atol=1e-6)
            assert posture[:2].tolist() == start[:2].tolist()
            assert (posture[2:] >= jaco.LIMITS[:, 0]).all()
            assert (posture[2:] <= jaco.LIMITS[:, 1]).all()
        gone = math.degrees(elbow_angle(BASE, way[-1]) - elbow_angle(BASE, start))
        assert (gone + 180) % 360 - 180 == pytest.approx(degrees, abs=0.02)
        angles = np.unwrap([elbow_angle(BASE, posture) for posture in (start, *way)])
        assert np.abs(np.diff(angles)).max() < 1.1 * STEP_RAD


def test_the_angle_is_that_about_the_line_from_shoulder_to_hand() -> None:
    found = starts(10)
    assert len(found) == 10
    for start in found:
        shoulder, elbow, hand = placed(start)
        line = (hand - shoulder) / np.linalg.norm(hand - shoulder)
        above = np.array([0.0, 0.0, 1.0]) - line[2] * line
        angle = elbow_angle(BASE, start)
        aside = np.cross(line, above / np.linalg.norm(above))
        radius = np.linalg.norm(elbow - shoulder - ((elbow - shoulder) @ line) * line)
        expected = radius * (math.cos(angle) * above / np.linalg.norm(above) + math.sin(angle) * aside)
        assert np.allclose(elbow - shoulder - ((elbow - shoulder) @ line) * line, expected, atol=1e-9)


def test_there_is_an_end_to_how_far_it_goes_round() -> None:
    ends = [elbow_way(BASE, start, math.radians(170.0)) is None for start in starts(8)]
    assert any(ends)
