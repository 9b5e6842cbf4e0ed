"""A corridor of five cells in which agents learn to walk: views are told apart by where one is and where one looks."""

import numpy as np

from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.training.cached_walks import Errand, distances_to
from remqa_data.env.cached.walk import ACTIONS
from remqa_data.sim.agent.actions import WALKING
from remqa_data.views.reader import RoomViews
from remqa_data.views.states import TURNS, States
from remqa_data.views.tasks import NavigationTask
from remqa_data.views.transitions import Transitions

CELLS = 5
QUESTION = "How many mugs are there in the fridge?"


def corridor_room() -> RoomViews:
    """Cells (0, 0) to (4, 0); heading 90 degrees walks towards the last one, 270 back, the others nowhere."""
    states = States(tuple((i, 0) for i in range(CELLS)), 0.25)
    table = np.tile(np.arange(len(states))[:, None], (1, len(WALKING)))
    for state in range(len(states)):
        cell, turn = divmod(state, len(TURNS))
        yaw, horizon, stands = TURNS[turn]
        ahead = {90: 1, 270: -1}.get(yaw, 0)
        if 0 <= cell + ahead < CELLS:
            table[state, ACTIONS.index("MoveAhead")] = state + ahead * len(TURNS)
        for name, by in (("RotateLeft", -90), ("RotateRight", 90)):
            new = TURNS.index(((yaw + by) % 360, horizon, stands))
            table[state, ACTIONS.index(name)] = cell * len(TURNS) + new
    features = np.zeros((len(states), 49, 64), dtype=np.float16)
    for state in range(len(states)):
        cell, turn = divmod(state, len(TURNS))
        features[state, :, cell] = 1
        features[state, :, CELLS + (TURNS[turn][0] // 90)] = 1
    return RoomViews(
        states=states,
        transitions=Transitions(table, np.zeros(table.shape, dtype=np.uint8), ("",)),
        is_reachable=np.ones(len(states), dtype=np.bool_),
        frames=np.zeros((len(states), 84, 84, 3), dtype=np.uint8),
        features=features,
        pixels=np.zeros(0, dtype=np.uint16),
        colors=np.zeros((0, 3), dtype=np.uint8),
        patch_starts=[0] * (len(states) + 1),
        succeeding={},
    )


def corridor_errand(start: tuple[int, int] = (0, 0)) -> Errand:
    """To the last cell, looking ahead (90 degrees, horizon 0); from a cell and a heading, horizon 0."""
    room = corridor_room()
    task = NavigationTask(
        "q", QUESTION, "Corridor", 0, (0.0, 0.0, 0.0, 0.0), np.array([[1.0, 0.0]]), "f", "Fridge", 1.0
    )
    succeeds = np.zeros(len(room.states), dtype=np.bool_)
    goal = room.states.number(1.0, 0.0, 90.0, 0.0)
    cell, yaw = start
    begin = room.states.number(cell * 0.25, 0.0, yaw, 0.0)
    assert goal is not None
    assert begin is not None
    succeeds[goal] = True
    return Errand(task, read_question(QUESTION), room, begin, (1, 0), distances_to(room, succeeds))
