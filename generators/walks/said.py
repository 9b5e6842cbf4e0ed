"""Which referring expressions a walk keeps, and the frame that each is about: one in which the words are needed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from remqa_data.generators.questions.expressions import Expression
from remqa_data.tables.rows import FrameRow

LEAST_PIXELS = 0.25
"""A frame that shows another thing of the target's type is taken if it shows so much of the target as the best one does."""
MOST_ALONE = 0.4
"""Share of the expressions, at most, whose target is the only thing of its type in the frame: a detector finds those."""


class Said(NamedTuple):
    """An expression, its number among those that are kept of its target, and the frame that it is about."""

    expression: Expression
    number: int
    frame: FrameRow


def said_of(frames: Sequence[FrameRow], expressions: Mapping[str, Sequence[Expression]]) -> list[Said]:
    """The expressions to keep of one configuration, in their order.

    Parameters
    ----------
    frames : sequence of FrameRow
        All frames of the walk.
    expressions : mapping of str to sequence of Expression
        By target id, best first.

    Returns
    -------
    Each with a frame that shows its target and its landmark, and if possible another thing of the target's type; of those,
    the one that shows the target best. Of the expressions whose target is alone of its type in the frame there are no
    more than `MOST_ALONE`, the best of each target first.
    """
    views = [_View(frame) for frame in frames]
    found: list[tuple[Said, bool]] = []
    for own in expressions.values():
        for number, expression in enumerate(own):
            view = _best(views, expression)
            if view is not None:
                found.append((Said(expression, number, view.frame), view.is_alone(expression.target_id)))
    contested = sum(not alone for _, alone in found)
    alone = sorted((i for i, (_, alone) in enumerate(found) if alone), key=lambda i: (found[i][0].number, i))
    kept = set(alone[: int(MOST_ALONE / (1 - MOST_ALONE) * contested)])
    numbers: Counter[str] = Counter()
    chosen = []
    for i, (said, is_alone) in enumerate(found):
        if not is_alone or i in kept:
            target = said.expression.target_id
            chosen.append(said._replace(number=numbers[target]))
            numbers[target] += 1
    return chosen


class _View:
    """What a frame shows: pixels by object, and the types of the objects."""

    def __init__(self, frame: FrameRow) -> None:
        self.frame = frame
        self.pixels = {seen.id: seen.pixels for seen in frame.objects}
        self.types = {seen.id: seen.type for seen in frame.objects}

    def is_alone(self, object_id: str) -> bool:
        """Whether nothing else of an object's type is seen."""
        return list(self.types.values()).count(self.types[object_id]) == 1


def _best(views: Sequence[_View], expression: Expression) -> _View | None:
    """The view that an expression is kept for; None if no frame shows both its target and its landmark."""
    target = expression.target_id

    def fitting() -> Iterator[_View]:
        for view in views:
            if target in view.pixels and (expression.anchor_id is None or expression.anchor_id in view.pixels):
                yield view

    shown = list(fitting())
    if not shown:
        return None
    most = max(view.pixels[target] for view in shown)
    contested = [v for v in shown if not v.is_alone(target) and v.pixels[target] >= LEAST_PIXELS * most]
    return max(contested or shown, key=lambda view: view.pixels[target])
