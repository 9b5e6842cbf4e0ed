"""Objects made by hand for tests of graphs and phrases: no simulator, every number is worked out on paper."""

from typing import Literal

from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata


def thing(
    name: str,
    at: tuple[float, float, float],
    size: tuple[float, float, float],
    on: str | None = None,
    kind: Literal["in", "on"] = "on",
    color: str = "white",
    substance: str = "wooden",
    openness: float = 0.0,
    facing_deg: float | None = -90.0,
) -> ObjectMetadata:
    """An object called "Type|number" whose box stands with the middle of its bottom at a point."""
    (x, y, z), (w, d, h) = at, size
    return ObjectMetadata(
        id=name,
        type=name.split("|")[0],
        color=color,
        substance=substance,
        box=(x - w / 2, y - d / 2, z, x + w / 2, y + d / 2, z + h),
        openness=openness,
        is_picked_up=False,
        support=on,
        support_kind=None if on is None else kind,
        facing_deg=facing_deg,
    )


def kitchen() -> list[ObjectMetadata]:
    """A wall of a kitchen, seen from -y.

    From left to right: fridge (0 to 0.8), three drawers over one another (0.8 to 1.3), a cabinet below the sink (1.3 to
    2.1), another cabinet (2.1 to 2.6). Above: a cabinet over the sink. On the worktop: a toaster over the drawers, a red
    and a blue mug on the right. A card under a pillow lies on the floor; an apple is in a bowl in the fridge.
    """
    floor = "Floor|1"
    return [
        thing(floor, (1.5, -1, -0.1), (6, 6, 0.1)),
        thing("CounterTop|1", (1.7, 0, 0.88), (1.8, 0.6, 0.04)),
        thing("Fridge|1", (0.4, 0, 0), (0.8, 0.7, 1.8), floor),
        thing("Drawer|1", (1.05, 0, 0.1), (0.5, 0.5, 0.25)),
        thing("Drawer|2", (1.05, 0, 0.36), (0.5, 0.5, 0.25)),
        thing("Drawer|3", (1.05, 0, 0.62), (0.5, 0.5, 0.25)),
        thing("Cabinet|1", (1.7, 0, 0.1), (0.8, 0.5, 0.78)),
        thing("Sink|1", (1.7, 0, 0.72), (0.7, 0.45, 0.2)),
        thing("Cabinet|2", (2.35, 0, 0.1), (0.5, 0.5, 0.78)),
        thing("Cabinet|3", (1.7, 0.1, 1.5), (0.8, 0.3, 0.7)),
        thing("Toaster|1", (1.05, 0, 0.92), (0.3, 0.2, 0.2), "CounterTop|1"),
        thing("Mug|1", (2.3, 0, 0.92), (0.1, 0.1, 0.1), "CounterTop|1", color="red"),
        thing("Mug|2", (2.5, 0, 0.92), (0.1, 0.1, 0.1), "CounterTop|1", color="blue"),
        thing("Pillow|1", (2.0, -2, 0.002), (0.5, 0.4, 0.15), floor),
        thing("CreditCard|1", (2.0, -2, 0), (0.09, 0.05, 0.001), floor),
        thing("Bowl|1", (0.4, 0, 1.0), (0.2, 0.2, 0.1), "Fridge|1", "in"),
        thing("Apple|1", (0.4, 0, 1.03), (0.08, 0.08, 0.08), "Bowl|1", "in"),
    ]


def kitchen_graph() -> SceneGraph:
    """The graph of `kitchen`."""
    return SceneGraph.from_objects(kitchen())
