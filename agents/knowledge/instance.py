"""Which object of the room an expression means, by what the walk has shown.

The scene graph is asked first: the program of the expression is executed on it, so that "the drawer next to the toaster" is
found by the toaster. Where the graph does not have the answer, because the walk has not seen all that the expression leans
on, less and less is asked for: what the words may roughly mean, then any object of the type, then what the semantic map
labels with the type.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import ndimage

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.geometry.types import F64, Box
from remqa_data.language.referring import Program, candidates, resolve
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import relation_rules

FoundBy = Literal["graph", "graph, roughly", "type", "map"]


@dataclass(frozen=True)
class Instance:
    """An object that an agent remembers.

    Attributes
    ----------
    type : str
        Its label.
    box : Box
        x0, y0, z0, x1, y1, z1 in metres.
    facing_deg : float or None
        Where its front looks, counter-clockwise from +x; None if it has none, or it is not known.
    found_by : str
        What has said that it is the one: "graph" (the expression, exactly), "graph, roughly", "type" or "map".
    """

    type: str
    box: Box
    facing_deg: float | None
    found_by: FoundBy

    @property
    def centre(self) -> F64:
        """(3,) middle of its box, metres."""
        return np.asarray((np.array(self.box[:3]) + self.box[3:]) / 2)


def choose_instance(target: Program, memory: WalkMemory) -> Instance | None:
    """The object that the program of an expression means, or None where the walk has seen none of its type.

    Of several that fit equally, the first by its id: the agent has no better reason.
    """
    graph, wanted = memory.graph, str(target[0][1])
    exact = resolve(target, graph)
    if len(exact) == 1:
        return _of_graph(graph, exact[0], "graph")
    loose = SceneGraph.from_objects(graph.objects.values(), relation_rules().loosened())
    of_type = [name for name in sorted(graph.objects) if graph.node(name).type == wanted]
    rough = [name for name in candidates(target, loose) if name in of_type]
    for found, by in ((exact, "graph, roughly"), (rough, "graph, roughly"), (of_type, "type")):
        if found:
            return _of_graph(graph, found[0], by)  # type: ignore[arg-type]  # two of the texts of FoundBy
    return _of_map(memory, wanted)


def _of_graph(graph: SceneGraph, name: str, by: FoundBy) -> Instance:
    record = graph.node(name)
    return Instance(record.type, record.box, record.facing_deg, by)


def _of_map(memory: WalkMemory, wanted: str) -> Instance | None:
    """The largest connected piece of the voxels with a label, as an object without a known front."""
    if wanted not in memory.plan.names:
        return None
    pieces, count = ndimage.label(memory.labels == memory.plan.names.index(wanted))
    sizes = ndimage.sum_labels(pieces > 0, pieces, range(1, count + 1))
    voxels = np.argwhere(pieces == int(np.argmax(sizes)) + 1)
    x0, y0, z0 = memory.corner_of(voxels.min(axis=0)).tolist()
    x1, y1, z1 = memory.corner_of(voxels.max(axis=0) + 1).tolist()
    return Instance(wanted, (x0, y0, z0, x1, y1, z1), None, "map")
