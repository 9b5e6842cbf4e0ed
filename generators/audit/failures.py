"""What a check reports: which truth does not hold, where, and how."""

from __future__ import annotations

from typing import Literal, NamedTuple

from remqa_data.generators.samples import Truth as SampleTruth

Truth = SampleTruth | Literal["consistent", "unbiased", "complete", "reproducible"]
"""Those of `samples.Truth`, and more: `consistent` is that rows and files say the same as one another and as the room that
they are about; `unbiased` is that nothing but looking gives the answer away; `complete` is that the rows and files are
those that the configuration asks for, in their order, and no others; `reproducible` is that the configuration makes them
again, bit for bit."""

Broken = tuple[Truth, str]
"""Which truth is broken, and how."""


class Failure(NamedTuple):
    """What does not hold.

    Attributes
    ----------
    where : str
        Id of a row, or the name of a file or of what several rows share.
    truth : Truth
        Which truth is broken.
    reason : str
        How.
    """

    where: str
    truth: Truth
    reason: str
