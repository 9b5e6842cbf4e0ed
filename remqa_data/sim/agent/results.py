"""What comes of an action."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ActionResult:
    """What came of an action: whether it was done, why not, and what it answers."""

    success: bool
    error: str = ""
    value: Any = None


DONE = ActionResult(True)
