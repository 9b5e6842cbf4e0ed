from pathlib import Path

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.committee import Committee, Member, alone
from remqa_data.agents.networks.matcher import AnchoredMatcher, PlainMatcher
from remqa_data.agents.training.config import committees, load_committee_config
from remqa_data.agents.training.weights import load_committee, load_network, weights_path
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import ConfigError
from tests.agents.networks.test_matcher import BOXES, TYPES, regions

TEXTS = ("the red mug", "the pillow next to the sofa")
FIRST_WORDS, OTHER_WORDS = ("the", "mug", "red"), ("sofa", "the", "pillow", "mug", "next", "to")


def members() -> tuple[Member, Member]:
    """Two that know other words."""
    torch.manual_seed(3)
    one, other = Vocabulary.build(FIRST_WORDS, ()), Vocabulary.build(OTHER_WORDS, ())
    return (
        Member(AnchoredMatcher(len(one.words), TYPES, True).eval(), one, 1.0),
        Member(PlainMatcher(len(other.words), TYPES, True).eval(), other, 0.25),
    )


def test_scores_count_by_their_weights_and_the_first_says_where_objects_end() -> None:
    first, second = members()
    found = regions(scores=np.full(len(BOXES), 0.5, dtype=np.float32))
    said = Committee((first, second)).match(TEXTS, found)
    one, other = (alone(member.matcher, member.vocabulary).match(TEXTS, found) for member in (first, second))
    assert torch.allclose(said.scores, one.scores + 0.25 * other.scores)
    assert not torch.allclose(one.scores, other.scores)
    assert said.fit is not None
    assert one.fit is not None
    assert torch.equal(said.fit.boxes, one.fit.boxes)
    assert torch.equal(said.attention, one.attention)


def test_who_is_alone_says_what_the_matcher_says() -> None:
    member, _ = members()
    numbers = torch.from_numpy(member.vocabulary.encode_batch(TEXTS)[0])
    assert torch.equal(
        alone(member.matcher, member.vocabulary).match(TEXTS, regions()).scores,
        member.matcher(numbers, regions()).scores,
    )


def test_committees_that_come_with_the_package_are_of_its_weights() -> None:
    assert committees()
    for name in committees():
        committee, about = load_committee(name)
        config = load_committee_config(name)
        assert [member.weight for member in committee.members] == list(config.members.values())
        assert about == load_network(weights_path(next(iter(config.members))))[1]


@pytest.mark.parametrize(
    ("members", "problem"),
    [
        ("{anchored_matcher: 1.0, answerer: 0.5}", "'answerer' is no matcher"),
        (
            "{anchored_matcher: 1.0, language_attention: 0.5}",
            "'language_attention' is no matcher, or sees through other",
        ),
        ("{anchored_matcher: 1.0, nobody: 0.5}", "no weights of 'nobody'"),
        ("{anchored_matcher: 1.0}", "members: .*at least 2"),
        ("{anchored_matcher: 1.0, plain_matcher: 0.0}", "members.plain_matcher: .*greater than 0"),
    ],
)
def test_what_is_no_committee_is_refused_in_one_line(members: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(f"title: mine\nmembers: {members}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=problem) as caught:
        load_committee(str(path))
    assert "\n" not in str(caught.value)
