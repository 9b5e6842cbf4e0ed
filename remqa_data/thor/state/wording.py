"""What the agent and the room say when they refuse something, in AI2-THOR's words: its clients look for them."""

from __future__ import annotations

import re

WORDS = {
    r".+ is not (?:visible|within reach)": "Target object not found within the specified visibility.",
    r"unknown object '([^']*)'(.*)": r"objectId: \1 is not the objectId on any object in the scene!\2",
    r"(.+) is not openable": r"\1 is not an Openable object",
    r"(.+) is not pickupable": r"\1 must have the property CanPickup to be picked up.",
    r".+ is not a receptacle": "This target object is NOT a receptacle!",
    r".+ is not moveable": "Target Primary Property type incompatible with push/pull",
    r"cannot pick up .+: already holding .+": "Agent hand has something in it already! Can't pick up anything else",
    r"(.+) is not sliceable": r"\1 Does not have the CanBeSliced property!",
    r"(.+) is not dirty": r"\1 is already Clean!",
    r".+ is not filled": "object already empty",
    r".+ is in the hand, and allowTeleportOutOfHand is not set": "Cannot teleport object in hand.",
    r".+ is already (on|off)": r"can't toggle object \1 if it's already \1!",
}
"""By what is said here, as regular expressions of all of it."""


CODES = {r"can't look down beyond .+": "LookDownCantExceedMin", r"can't look up beyond .+": "LookUpCantExceedMax"}
"""AI2-THOR's errorCode of what is said, where it has one."""


def error_code(error: str) -> str | None:
    """AI2-THOR's errorCode of an error in its words.

    >>> error_code("can't look down beyond 60 degrees below the forward horizon")
    'LookDownCantExceedMin'
    """
    return next((code for words, code in CODES.items() if re.fullmatch(words, error)), None)


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
