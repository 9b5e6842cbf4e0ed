import numpy as np

from remqa_data.mapping.map_picture import STRUCTURE_COLOR, UNKNOWN_COLOR, draw_plan, paint_plan, plan_legend
from remqa_data.mapping.semantic_map import SemanticPlan

LABELS = np.array([[0, 1, 1], [-1, 1, 2]], dtype=np.int16)
"""Two columns along x, three along y."""
PLAN = SemanticPlan(LABELS, LABELS >= 0, LABELS >= 0, (0, 0), 0.05, 0.0, ("structure", "Mug", "Fridge"))


def test_a_plan_has_x_to_the_right_and_y_up() -> None:
    image = paint_plan(PLAN)
    assert image.shape == (3, 2, 3)
    assert tuple(image[2, 0]) == STRUCTURE_COLOR, "the corner with the least x and y is below on the left"
    assert tuple(image[2, 1]) == UNKNOWN_COLOR
    assert tuple(image[0, 0]) == tuple(image[1, 1]), "both are mugs"


def test_the_legend_has_the_colours_of_the_plan_and_begins_with_the_largest() -> None:
    legend = plan_legend(PLAN)
    assert [name for name, _ in legend] == ["Mug", "structure", "Fridge"]
    assert dict(legend)["Fridge"] == tuple(paint_plan(PLAN)[0, 1])


def test_a_drawn_plan_has_the_same_colours() -> None:
    drawn = draw_plan(PLAN, voxel_px=6)
    assert np.array_equal(drawn[10:28:6, 10:22:6][:3, :2], paint_plan(PLAN))
