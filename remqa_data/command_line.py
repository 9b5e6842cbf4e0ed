"""What the three commands share.

An error on purpose (`RemqaError`) or a file that cannot be read or written becomes one line on stderr and exit code 2.
"""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperGroup

from remqa_data.errors import RemqaError, one_line
from remqa_data.processes.interrupts import PromptInterrupts


class OneLineErrors(TyperGroup):
    """Commands whose errors on purpose become one line on stderr and exit code 2; they stop at once when told to."""

    when_stopped = "stopped"
    """What to say to Ctrl-C and SIGTERM."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was named."""
        try:
            with PromptInterrupts(f"{self.name}: {self.when_stopped}"):
                return super().invoke(ctx)
        except (RemqaError, OSError, RuntimeError) as error:
            if isinstance(error, RuntimeError) and _NO_THREAD not in str(error):
                raise
            typer.echo(f"{self.name}: {one_line(_in_words(error))}", err=True)
            raise typer.Exit(2) from error


_NO_THREAD = "can't start new thread"
"""What Python says when the system refuses."""


def _in_words(error: Exception) -> str:
    """What is wrong, where first; without the number that the system gives it."""
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        return f"{error.filename}: {error.strerror}; choose another path"
    if _NO_THREAD in str(error):
        return "the system starts no more threads (ulimit -u)"
    return str(error)
