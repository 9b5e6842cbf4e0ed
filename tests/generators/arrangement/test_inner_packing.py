"""Things put so that they lie to one another as asked; checked by their middles and sides alone."""

from dataclasses import replace

import numpy as np
import pytest

from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.inner_packing import RelationConstraint, inner_fits, packed_with_constraint
from remqa_data.language.inner_relations import Partner
from remqa_data.sim.navigation.viewpoints import AgentPose

AREA = Area((0.0, 0.0, 0.5), 0.0, (0.3, 0.22), 0.3)
SHELF = HidingPlace(
    "Fridge|1",
    "Fridge",
    "Open",
    "in",
    AgentPose((0, -4), 90),
    (AgentPose((1, -4), 90),),
    (),
    (AREA,),
    (AREA,),
    frozenset(),
    0.0,
)
"""Its front looks towards -y, and the agent stands a metre before it."""
MUG, EGG = (0.11, 0.09, 0.1), (0.07, 0.06, 0.06)
PLATE = (0.26, 0.26, 0.03)


def put(relation, holds, seed, others=MUG, types=None):
    """Egg, what it lies to, and a third thing that is in the way: middles of their bottoms."""
    count = 2 if relation == "between" else 1
    sizes = [EGG, *[others] * count, (0.06, 0.06, 0.12)]
    names = ["Egg", *[types or "Mug"] * count, "PepperShaker"]
    constraint = RelationConstraint(0, tuple(range(1, 1 + count)), relation, holds)
    puts = packed_with_constraint(SHELF, names, sizes, constraint, np.random.default_rng(seed))
    assert puts is not None
    return [np.array(one.position) for one in puts]


SEEDS = range(8)


@pytest.mark.parametrize("seed", SEEDS)
def test_behind_is_at_the_back_of_it(seed) -> None:
    egg, mug, _ = put("behind", True, seed)
    assert 0.06 <= egg[1] - mug[1] <= 0.2
    assert abs(egg[0] - mug[0]) <= 0.05
    egg, mug, _ = put("behind", False, seed)
    assert not (0.06 <= egg[1] - mug[1] <= 0.2 and abs(egg[0] - mug[0]) <= 0.05)


@pytest.mark.parametrize("seed", SEEDS)
def test_next_to_is_beside_it(seed) -> None:
    egg, mug, _ = put("next to", True, seed)
    assert 0.07 <= abs(egg[0] - mug[0]) <= 0.13
    egg, mug, _ = put("next to", False, seed)
    assert max(abs(egg - mug)[:2]) > 0.13


@pytest.mark.parametrize("seed", SEEDS)
def test_between_is_in_the_middle(seed) -> None:
    egg, one, two, _ = put("between", True, seed)
    assert min(one[0], two[0]) < egg[0] < max(one[0], two[0])
    assert np.linalg.norm(egg - (one + two) / 2) < 0.05
    egg, one, two, _ = put("between", False, seed)
    assert np.linalg.norm(egg - (one + two) / 2) > 0.05


@pytest.mark.parametrize("seed", SEEDS)
def test_on_is_over_it_and_not_on_is_beside_it(seed) -> None:
    egg, plate, _ = put("on", True, seed, PLATE, "Plate")
    assert egg[2] == pytest.approx(plate[2] + 0.03, abs=0.002)
    assert np.linalg.norm((egg - plate)[:2]) < 0.1
    egg, plate, _ = put("on", False, seed, PLATE, "Plate")
    assert egg[2] == plate[2]
    assert max(abs(egg - plate)[:2]) > 0.15


def test_what_fits_depends_on_the_room_there_is_and_on_who_looks() -> None:
    assert inner_fits(SHELF, "Egg", Partner("behind", "Mug"))
    assert not inner_fits(replace(SHELF, areas=(replace(AREA, half=(0.07, 0.07)),)), "Egg", Partner("behind", "Mug"))
    askew = replace(SHELF, goal=AgentPose((8, -1), 180))
    assert not inner_fits(askew, "Egg", Partner("behind", "Mug"))
    assert inner_fits(askew, "Egg", Partner("next to", "Mug"))
    assert not inner_fits(replace(SHELF, type="Box"), "Egg", Partner("behind", "Mug"))  # it opens at its top
    assert inner_fits(SHELF, "Egg", Partner("on", "Plate"))
    assert not inner_fits(SHELF, "Egg", Partner("on", "Mug"))
