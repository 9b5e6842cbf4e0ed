"""Which questions a list shows: read from an address, and written into one, so that a list can be shared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from urllib.parse import urlencode

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.geometry.types import Flags

CHOICES = {
    "kind": "kind",
    "room": "room_type",
    "scene": "scene",
    "split": "split",
    "do": "manipulation",
    "answer": "answer",
}
"""What can be chosen, by name in an address, and the column that it is about."""
SEARCHED = ("question", "question_id", "target_type", "answer_type")
MOST_LETTERS = 200
MOST_WORDS = 12
PAGE = 24


@dataclass(frozen=True)
class Filters:
    """What a list shows.

    Attributes
    ----------
    chosen : mapping of str to str
        By name of `CHOICES`; what is not there is not asked.
    text : str
        Words that must all occur, in any order, as they begin a word or within one.
    page : int
        From 1.
    """

    chosen: Mapping[str, str] = field(default_factory=dict)
    text: str = ""
    page: int = 1

    @classmethod
    def of(cls, query: Mapping[str, str]) -> Filters:
        """Read from the parameters of an address; what is unknown is left out."""
        page = query.get("page", "1")
        return cls(
            {name: query[name] for name in CHOICES if query.get(name)},
            query.get("q", "").strip()[:MOST_LETTERS],
            min(max(int(page), 1), 10**6) if page.isascii() and page.isdigit() and len(page) < 8 else 1,
        )

    def query(self, **changed: int) -> str:
        """As the end of an address: "?kind=COUNTING&page=2", or nothing."""
        now = replace(self, **changed)  # type: ignore[arg-type]
        parts = {**now.chosen, **({"q": now.text} if now.text else {}), **({"page": now.page} if now.page > 1 else {})}
        return "?" + urlencode(parts) if parts else ""

    def rows(self, index: pa.Table, searched: pa.Array) -> list[int]:
        """The rows of an index that are shown, in its order; `searched` is `searched_text` of it."""
        mask = np.ones(index.num_rows, dtype=np.bool_)
        for name, value in self.chosen.items():
            mask &= _is_true(pc.equal(index[CHOICES[name]], value))
        for word in self.text.lower().split()[:MOST_WORDS]:
            mask &= _is_true(pc.match_substring(searched, word))
        return [int(row) for row in np.flatnonzero(mask)]


def searched_text(index: pa.Table) -> pa.Array:
    """What the words of a search are looked for in, one text for each row, in small letters."""
    return pc.utf8_lower(pc.binary_join_element_wise(*(index[name] for name in SEARCHED), " "))


def _is_true(values: pa.ChunkedArray | pa.Array) -> Flags:
    return np.asarray(pc.fill_null(values, False).to_numpy(zero_copy_only=False), dtype=np.bool_)
