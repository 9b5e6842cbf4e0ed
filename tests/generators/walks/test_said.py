from types import SimpleNamespace

from remqa_data.generators.questions.expressions import Expression
from remqa_data.generators.walks.said import MOST_ALONE, said_of


def frame(name: str, **pixels: int):
    """A frame that shows so many pixels of some objects, called Type_number."""
    shown = [SimpleNamespace(id=key, type=key.split("_")[0], pixels=n) for key, n in pixels.items()]
    return SimpleNamespace(frame_id=name, objects=shown)


def phrase(target: str, anchor: str | None = None) -> Expression:
    kind = target.split("_")[0]
    return Expression(
        f"the {target} by {anchor}", target, kind, anchor and "on", anchor, "bare", (("filter_type", kind),)
    )


def test_the_frame_shows_the_landmark_and_a_rival_where_one_does() -> None:
    frames = [
        frame("nearest", Mug_1=900),
        frame("with the landmark", Mug_1=500, Desk_1=900),
        frame("with a rival too", Mug_1=300, Desk_1=500, Mug_2=90),
        frame("too far", Mug_1=100, Desk_1=90, Mug_2=90),
    ]
    (said,) = said_of(frames, {"Mug_1": [phrase("Mug_1", "Desk_1")]})
    assert said.frame.frame_id == "with a rival too"
    (plain,) = said_of([*frames[:2], frame("rival", Mug_1=300, Mug_2=1)], {"Mug_1": [phrase("Mug_1")]})
    assert plain.frame.frame_id == "rival"


def test_what_no_frame_shows_with_its_landmark_is_not_said() -> None:
    frames = [frame("a", Mug_1=900, Mug_2=100), frame("b", Desk_1=900)]
    assert said_of(frames, {"Mug_1": [phrase("Mug_1", "Desk_1")]}) == []


def test_few_targets_are_the_only_ones_of_their_type() -> None:
    cups = {f"Cup_{i}": [phrase(f"Cup_{i}")] for i in range(6)}
    others = {
        f"{kind}_0": [phrase(f"{kind}_0"), phrase(f"{kind}_0")]
        for kind in ("Bed", "Box", "Sofa", "Fridge", "Safe", "Pen")
    }
    shown = frame("all", **dict.fromkeys([*cups, *others], 100))
    said = said_of([shown], {**cups, **others})
    alone = [one for one in said if not one.expression.target_id.startswith("Cup")]
    assert len(said) - len(alone) == 6
    assert len(alone) == 4 == int(MOST_ALONE * len(said))
    assert {one.number for one in alone} == {0}  # the best phrase of each


def test_what_is_kept_of_a_target_is_numbered_from_0() -> None:
    phrases = [phrase("Mug_1", "Desk_1"), phrase("Mug_1"), phrase("Mug_1")]
    said = said_of([frame("no desk", Mug_1=90, Mug_2=90)], {"Mug_1": phrases, "Mug_2": [phrase("Mug_2")]})
    assert [(one.expression.target_id, one.number) for one in said] == [("Mug_1", 0), ("Mug_1", 1), ("Mug_2", 0)]
