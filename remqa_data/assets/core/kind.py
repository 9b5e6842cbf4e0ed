"""How a module of builder functions announces the object types it draws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from remqa_data.assets.core.builder import Builder


@dataclass(frozen=True)
class Kind:
    """One object type: the function that draws it and how many visibly different variants it knows."""

    draw: Callable[[Builder], None]
    variants: int = 4
