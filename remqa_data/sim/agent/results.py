"""What comes of an action."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class ActionResult:
    """What came of an action.

    Attributes
    ----------
    success : bool
        Whether it was done.
    error : str
        Why not.
    value
        What it answers.
    blocked_by : str, optional
        What the agent met on its way.
    """

    success: bool
    error: str = ""
    value: Any = None
    blocked_by: str | None = None

    def without_name(self) -> ActionResult:
        """The same for an agent that may not see what it met."""
        met = self.blocked_by
        return self if met is None else replace(self, error=self.error.replace(met, "something"), blocked_by=None)


SUCCEEDED = ActionResult(True)
