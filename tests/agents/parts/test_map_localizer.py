import numpy as np
import pytest

from remqa_data.agents.knowledge.instance import choose_instance
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.agents.parts.map_localizer import MapLocalizer
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.room_records import thing
from tests.helpers.walked_rooms import memory_of, percept_of

ASKED = read_question("Is there a mug in the fridge?")
FRIDGE = thing("Fridge|1", (0.0, 0.1, 0.0), (0.8, 0.8, 1.8))
RNG = np.random.default_rng(0)


def test_the_box_is_that_of_the_pixels_and_the_point_is_one_of_them() -> None:
    mask = np.zeros((10, 20), dtype=bool)
    mask[2:6, 4:8] = True
    mask[5, 4:16] = True
    sighting = Sighting.of_mask(mask)
    assert sighting.box == (0.2, 0.2, 0.8, 0.6)
    x, y = sighting.point
    assert mask[int(y * 10), int(x * 20)]


def test_a_ring_is_pointed_at_on_itself_and_not_in_its_hole() -> None:
    mask = np.ones((11, 11), dtype=bool)
    mask[2:9, 2:9] = False
    x, y = Sighting.of_mask(mask).point
    assert mask[int(y * 11), int(x * 11)]


@pytest.mark.slow
def test_nothing_is_seen_where_the_target_is_not_in_view_or_was_never_seen() -> None:
    memory = memory_of([FRIDGE], (-2.0, -3.0, 2.0, 0.5))
    instance = choose_instance(ASKED.target, memory)
    ahead, away = AgentPose((0, -6), 90), AgentPose((0, -6), 270)
    found = MapLocalizer().locate(ASKED, memory, percept_of(ahead, instance), RNG)
    assert found is not None
    assert found.box[0] < 0.5 < found.box[2]
    # The screen is at 1.6 m, where the fridge of 0.8 m is 0.25 of a view that is 3.2 m wide.
    assert found.box[2] - found.box[0] == pytest.approx(0.25, abs=0.01)
    assert MapLocalizer().locate(ASKED, memory, percept_of(away, instance), RNG) is None
    assert MapLocalizer().locate(read_question("Is there a mug in the safe?"), memory, percept_of(ahead), RNG) is None
