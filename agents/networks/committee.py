"""Several matchers that say together what an expression means."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import torch

from remqa_data.agents.networks.detection.regions import Regions
from remqa_data.agents.networks.matcher import Match, Matcher
from remqa_data.datasets.vocabulary import Vocabulary


class Member(NamedTuple):
    """A matcher, the words that it knows, and how much its scores count."""

    matcher: Matcher
    vocabulary: Vocabulary
    weight: float = 1.0


@dataclass(frozen=True)
class Committee:
    """Matchers that have learnt apart from each other; a matcher that is alone is a committee of one.

    Attributes
    ----------
    members : tuple of Member
        They see through the same detector. The first one says where objects end, and which words it has looked at.
    """

    members: tuple[Member, ...]

    def to(self, device: str) -> Committee:
        """The same on a device."""
        return Committee(tuple(member._replace(matcher=member.matcher.to(device)) for member in self.members))

    @torch.no_grad()
    def match(self, texts: Sequence[str], regions: Regions) -> Match:
        """How well the objects of a picture fit expressions: the sum of what all members say, by their weights."""
        matches = [self._asked(member, texts, regions) for member in self.members]
        scores = torch.stack(
            [match.scores * member.weight for match, member in zip(matches, self.members, strict=True)]
        )
        return matches[0]._replace(scores=scores.sum(0))

    @staticmethod
    def _asked(member: Member, texts: Sequence[str], regions: Regions) -> Match:
        numbers = torch.from_numpy(member.vocabulary.encode_batch(texts)[0])
        match: Match = member.matcher(numbers.to(regions.looks.device), regions)
        return match


def alone(matcher: Matcher, vocabulary: Vocabulary) -> Committee:
    """A committee of one."""
    return Committee((Member(matcher, vocabulary),))
