"""One exception class per cause. All derive from `RemqaError`, so a caller can catch the whole family."""

import difflib
from collections.abc import Iterable


class RemqaError(Exception):
    """Base of every error this package raises on purpose; its text is meant for the person who reads it."""


class UnknownNameError(RemqaError, KeyError):
    """A name that is not known, with the nearest names that are.

    Parameters
    ----------
    kind : str
        What the name stands for, such as "scene" or "object type".
    name : str
        The name that was given.
    known : iterable of str
        All names that would have been right.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind, self.name = kind, name
        self.nearest = nearest_names(name, known)
        msg = f"unknown {kind} {name!r}"
        if self.nearest:
            msg += f"; did you mean {' or '.join(repr(near) for near in self.nearest)}?"
        self.message = msg
        super().__init__(msg)

    def __str__(self) -> str:
        return self.message  # KeyError would show the repr of the text


class CatalogError(RemqaError, ValueError):
    """A file of object types that cannot be read: says which type, which field and why."""


class FloorPlanError(RemqaError, ValueError):
    """A floor plan row that cannot be used: says which row, which field and why."""


class AssetError(RemqaError, ValueError):
    """An asset that cannot be built as asked, or a builder that broke its promise."""


class SceneFormatError(RemqaError, ValueError):
    """A stored scene description that cannot be read: says where and why."""


class ActionError(RemqaError):
    """An action that the simulated world refuses, with the reason."""


class MissingExtraError(RemqaError, ImportError):
    """An optional dependency is not installed; the text names the extra that brings it."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(f"{package} is not installed; run: pip install 'remqa-data[{extra}]'")


def nearest_names(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """The known names most like `name`, best first, ignoring case.

    >>> nearest_names("mugg", ["Mug", "Fridge", "Cup"])
    ['Mug']
    """
    by_lower = {candidate.lower(): candidate for candidate in known}
    return [by_lower[hit] for hit in difflib.get_close_matches(name.lower(), by_lower, n=count, cutoff=0.6)]
