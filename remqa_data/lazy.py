"""Names that a package offers, loaded when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def lazy_names(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """A module's `__getattr__` for names that live in other modules.

    Parameters
    ----------
    package : str
        Whose names they are, for the error.
    homes : mapping of str to str
        The module in which each name is defined.

    Returns
    -------
    A function that returns what is asked for, and raises AttributeError for any other name.
    """

    def load(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name]), name)

    return load
