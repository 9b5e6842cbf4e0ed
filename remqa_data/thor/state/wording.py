"""What the agent and the room say when they refuse something, in AI2-THOR's words: its clients look for them."""

from __future__ import annotations

import re

WORDS = {
    r".+ is not (?:visible|within reach)": "Target object not found within the specified visibility.",
    r"unknown object '([^']*)'(.*)": r"objectId: \1 is not the objectId on any object in the scene!\2",
    r"(.+) is not openable": r"\1 is not an Openable object",
    r"(.+) is not pickupable": r"\1 must have the property CanPickup to be picked up.",
    r".+ is not a receptacle": "This target object is NOT a receptacle!",
    r".+ is already (on|off)": r"can't toggle object \1 if it's already \1!",
}
"""By what is said here, as regular expressions of all of it."""


def in_thors_words(error: str) -> str:
    """An error as AI2-THOR says it, where it has words of its own.

    >>> in_thors_words("Cup|1 is not openable")
    'Cup|1 is not an Openable object'
    >>> in_thors_words("no room to drop Cup|1")
    'no room to drop Cup|1'
    """
    for ours, theirs in WORDS.items():
        if found := re.fullmatch(ours, error):
            return found.expand(theirs)
    return error
