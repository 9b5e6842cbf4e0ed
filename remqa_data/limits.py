"""How much a dataset, or a submission, may hold: what is read from files is refused beyond this.

A dataset may come from anywhere, and what it says decides how much memory and time reading it takes. Each limit is
several times what generation makes (in brackets: the most in the 120 floor plans and the sampled ones), and so low that
whatever keeps all of them is read, drawn and simulated within seconds and 2 GB.
"""

from __future__ import annotations

MOST_TEXT_BYTES = 4096
"""Of an id, a question, an expression, a program [400]: they are looked for, split into words, and shown."""
MOST_SCENE_JSON_BYTES = 1 << 20
"""Of a room as JSON [60,000]."""
MOST_ITEMS = 10_000
"""Of a list, such as the edges of a graph or the cells of a grid [1,500]."""
MOST_VOXELS = 1_000_000
"""Of a semantic map [100,000]."""

MOST_IMAGE_BYTES = 1 << 26
"""Of an encoded image [30,000]."""
MOST_IMAGE_PX = 4096
"""Width and height of an image [300]; `remqa-gen` makes none that are larger. It takes 50 MB as RGB."""

MOST_OBJECTS = 400
"""Of a room [110]: each is built, drawn and asked about, and pairs of them are looked at."""
MOST_STRUCTURE_BOXES, MOST_LIGHTS = 2000, 3
"""Of a building [130, 1]; the renderer has no more than three lamps."""
MOST_ROOM_M, MOST_ROOM_HEIGHT_M = 30.0, 8.0
"""Sides of a room's floor [11] and its height [3.1]: of such a room, a map of 5 cm voxels takes 240 MB."""
MOST_FAR_M = 1000.0
"""From the origin to anything [15]: float32 still tells millimetres apart."""
MOST_OUTSIDE_M = 10.0
"""From a room to what belongs to it, such as the thickness of its walls [0.7]."""
LEAST_ASSET_M, MOST_ASSET_M = 0.002, MOST_ROOM_M
"""A side of an object [0.0035 to 11]."""
MOST_ASSETS_M = 300.0
"""Longest sides of all objects of a room together [56]: some are drawn from more pieces the longer they are, at worst in
0.1 s for each metre."""
MOST_ASSET_PARTS = 64
"""Heights, pockets and rectangles that an object's shape is told by [15]: each becomes a part of it."""

MOST_SEED = 2**63 - 1
"""It is stored as an int64."""

MAX_ACTIONS = 500
"""Of a walk in a submission."""
MAX_TEXT, MAX_NAME = 300, 200
"""Characters of an id, an answer or a manipulation in a submission, and of its agent's name, its split or its dataset."""
MAX_PX = 10_000
"""Coordinates of a box in a submission."""
MAX_COORDINATE = 10_000
"""Of a pose in a submission, in metres or degrees."""
