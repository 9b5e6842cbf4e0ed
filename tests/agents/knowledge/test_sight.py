import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.sight import seen_of
from remqa_data.sim.render.camera import Camera


def test_pixels_show_an_object_if_their_depth_lies_in_its_box() -> None:
    # A camera at the origin that looks along +x, 90 degrees wide: at 1 m depth a pixel of 100 is 0.02 m wide.
    camera = Camera((0.0, 0.0, 0.0), 0.0, 0.0, 90.0, 100, 100)
    depth = np.full((100, 100), 1.0, dtype=np.float32)
    depth[:, :10] = 0.0  # nothing is seen there
    box = Instance("Box", (0.95, -0.2, -0.1, 1.05, 0.2, 0.1), None, "graph")
    rows, columns = np.nonzero(seen_of(box, depth, camera))
    assert (columns.min(), columns.max() + 1) == (40, 60)  # y from 0.2 to -0.2
    assert (rows.min(), rows.max() + 1) == (45, 55)
    assert not seen_of(box, depth + np.float32(0.1), camera).any()  # a wall behind it
