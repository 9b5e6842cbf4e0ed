"""One exception class per cause. All derive from `RemqaError`, so a caller can catch the whole family."""

from __future__ import annotations

import difflib
import reprlib
from collections.abc import Iterable
from itertools import islice
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import ValidationError

_SHORT = reprlib.Repr()
_SHORT.maxstring = 120


def counted(number: int, name: str) -> str:
    """So many of something.

    >>> counted(1, "scene"), counted(12, "scene")
    ('1 scene', '12 scenes')
    """
    return f"{number} {name}" if number == 1 else f"{number} {name}s"


def one_line(error: object) -> str:
    r"""What an error says, in one line: those of other libraries come in several, and what files say may be anything.

    >>> one_line(ValueError("not a number:\n  'x'"))
    "not a number: 'x'"
    >>> print(one_line("a name that clears the screen: \x1b[2J"))
    a name that clears the screen: \x1b[2J
    """
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in " ".join(str(error).split()))


def named(names: Iterable[str], most: int) -> str:
    """Some names, and how many more there are.

    >>> named(["a", "b", "c"], most=2), named(["a"], most=2)
    ('a, b and 1 more', 'a')
    """
    every = list(names)
    return ", ".join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")


def what_is_invalid(error: ValidationError) -> str:
    """The first field of which pydantic complains, and what is wrong with it, in one line."""
    first = error.errors()[0]
    field = ".".join(str(part) for part in first["loc"]) or "the whole text"
    return f"{one_line(field)}: {one_line(first['msg'])}"


class _RaisedAnew(type):
    """Of errors: `type(error)(error)` is that error, as Gymnasium's AsyncVectorEnv raises what a process of its own met."""

    def __call__(cls, *arguments: Any, **named: Any) -> Any:
        if len(arguments) == 1 and type(arguments[0]) is cls:
            return arguments[0]
        return super().__call__(*arguments, **named)


class RemqaError(Exception, metaclass=_RaisedAnew):
    """Base of every error this package raises on purpose; its text is meant for the person who reads it."""


MOST_TOLD = 4
"""So many names that are known are told where none is near."""


class UnknownNameError(RemqaError, KeyError):
    """A name that is not known, with the nearest names that are, or a few of them where none is near.

    Of objects none is told that was not asked for: an agent may not have seen them.

    Parameters
    ----------
    kind : str
        What the name stands for, such as "scene" or "object type".
    name : str
        The name that was given; what is no text has no names near it.
    known : iterable of str
        All names that would have been right.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind, self.name, known = kind, name, list(known)
        self.nearest = nearest_names(name, known) if isinstance(name, str) else []
        self.some = [] if self.nearest or kind == "object" else sorted(known)[: MOST_TOLD + 1]
        msg = f"unknown {kind} {_SHORT.repr(name)}"
        if self.nearest:
            msg += f"; did you mean {' or '.join(repr(near) for near in self.nearest)}?"
        elif self.some:
            more = ", ..." if len(self.some) > MOST_TOLD else ""
            msg += f"; known are {', '.join(repr(other) for other in self.some[:MOST_TOLD])}{more}"
        self.message = msg
        super().__init__(msg)

    def __str__(self) -> str:
        return self.message  # KeyError would show the repr of the text

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.kind, self.name, self.nearest or self.some)  # whole again after a worker process


class CatalogError(RemqaError, ValueError):
    """A file of object types that cannot be read: says which type, which field and why."""


class FloorPlanError(RemqaError, ValueError):
    """A floor plan row that cannot be used: says which row, which field and why."""


class AssetError(RemqaError, ValueError):
    """An asset that cannot be built as asked, or a builder that broke its promise."""


class SceneFormatError(RemqaError, ValueError):
    """A stored scene description that cannot be read: says where and why."""


class SceneGraphError(RemqaError, ValueError):
    """Graph updates that cannot be read, or that do not fit together: says which node or field and why."""


class ProgramError(RemqaError, ValueError):
    """A referring expression or its program that cannot be read or executed: says which step or word and why."""


class ActionError(RemqaError):
    """What no agent or environment can be told: says what is wrong and what to do; what a room refuses is no error."""


class MisuseError(RemqaError, ValueError):
    """An action of AI2-THOR that cannot be read: unknown, or with arguments that do not fit it.

    Parameters
    ----------
    code : str
        AI2-THOR's errorCode, such as "InvalidAction".
    message : str
        What is wrong.
    """

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code


class SchemaError(RemqaError, ValueError):
    """A row that does not fit its table: says which table, row and field, and what was expected."""


class ImageFormatError(RemqaError, ValueError):
    """An array that cannot be stored as an image, or bytes that are not one."""


class DatasetError(RemqaError):
    """A folder that is not a dataset that can be read, or not one that can be written to: says why and what to do."""


class DamagedShardError(DatasetError):
    """A file of a dataset that is not as it was written.

    Parameters
    ----------
    path : path
        The file.
    reason : str
        What is wrong.
    row_group : int, optional
        Where in the file, counted from 0; None for the file as a whole.
    column : str, optional
        The damaged column, such as "rgb.bytes".
    """

    def __init__(self, path: object, reason: str, row_group: int | None = None, column: str | None = None) -> None:
        self.path, self.reason, self.row_group, self.column = path, reason, row_group, column
        where = f"{path}" if row_group is None else f"{path}, row group {row_group}, column {column}"
        super().__init__(f"damaged shard: {where}: {reason}; fetch or generate this file again")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.path, self.reason, self.row_group, self.column)  # whole again after a worker process


class ForgedRowError(DatasetError):
    """A row of a dataset that no generation writes: a value is missing, out of bounds, or more than is read.

    Parameters
    ----------
    path : path
        The file.
    row : int
        In the file, from 0.
    field : str
        Such as "objects[].box".
    reason : str
        What is wrong.
    """

    def __init__(self, path: object, row: int, field: str, reason: str) -> None:
        self.path, self.row, self.field, self.reason = path, row, field, reason
        super().__init__(f"{path}: row {row}, field {field}: {reason}; fetch or generate this file again")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.path, self.row, self.field, self.reason)  # whole again after a worker process


class DamagedPartError(DatasetError):
    """A finished room of an unfinished dataset that is not as it was written; it no longer counts as finished."""


class BusyDatasetError(DatasetError):
    """A dataset into which another run is writing, or that has passed on to another run."""


class OutputError(RemqaError, OSError):
    """A file that cannot be written where it was asked for, or was not written whole: says which and why."""


class StorageError(RemqaError, OSError):
    """A bucket that cannot be reached, read or written.

    Parameters
    ----------
    root : str
        Its URI.
    reason : str
        What it answered.
    advice : str
        What to do.
    """

    def __init__(
        self,
        root: str,
        reason: str,
        advice: str = "check the bucket's name, and credentials, region and endpoint (AWS_...)",
    ) -> None:
        self.root, self.reason, self.advice = root, reason, advice
        super().__init__(f"{root}: {reason}; {advice}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.root, self.reason, self.advice)


class WorkersLostError(RemqaError):
    """Processes that make rooms died again and again: says during which rooms, and what to try."""


class ClusterError(RemqaError):
    """A Ray cluster that cannot be reached, or that loses a job again and again."""


class VoxelError(RemqaError, ValueError):
    """A frame or stored voxels that do not fit the voxel map: says which and why."""


class ConfigError(RemqaError, ValueError):
    """A configuration file that cannot be used: says which file, which key and why."""


class QuotaError(RemqaError):
    """Questions that were asked for and cannot be had: says which scene or split, which kind, and why.

    `kind` says it again for a program that asks for fewer of that kind.
    """

    def __init__(self, message: str, kind: str = "") -> None:
        super().__init__(message)
        self.kind = kind


class ArrangementError(RemqaError):
    """Things that cannot be hidden as wished: says in which room and place, and what went wrong.

    `place_id`, `relation` and `types` say it again for a program that plans anew without what failed.
    """

    def __init__(self, message: str, place_id: str = "", relation: str = "", types: Iterable[str] = ()) -> None:
        super().__init__(message)
        self.place_id, self.relation, self.types = place_id, relation, tuple(types)


class NoPathError(RemqaError):
    """There is no way between two places, or one of them is not a place where the agent can be."""


class SubmissionError(RemqaError, ValueError):
    """A file of predictions that cannot be scored.

    Parameters
    ----------
    path : path
        The file.
    where : str
        Such as "line 12, field actions[3]"; empty for the file as a whole.
    reason : str
        What is wrong, and what is expected.
    """

    def __init__(self, path: object, where: str, reason: str) -> None:
        self.path, self.where, self.reason = path, where, reason
        super().__init__(f"{path}: {where}: {reason}" if where else f"{path}: {reason}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.path, self.where, self.reason)


class ResultsError(RemqaError, ValueError):
    """A results.json that cannot be read, or two that cannot be compared: says which file and why."""


class MissingExtraError(RemqaError, ImportError):
    """An optional dependency is not installed; the text names the extra that brings it."""

    def __init__(self, package: str, extra: str, instead: str = "") -> None:
        hint = f", {instead}" if instead else ""
        super().__init__(
            f"{package} is not installed; run: pip install 'remqa-data[{extra}]', or in a clone: pip install '.[{extra}]'{hint}"
        )


class OpenCVError(RemqaError, ImportError):
    """OpenCV cannot be loaded: not there, or replaced by a build that needs the libraries of a screen."""

    def __init__(self, error: object) -> None:
        super().__init__(
            f"OpenCV cannot be loaded ({one_line(error)}); run: pip uninstall --yes opencv-python && "
            "pip install --force-reinstall --no-deps opencv-python-headless"
        )


def nearest_names(name: str, known: Iterable[str], count: int = 3) -> list[str]:
    """The known names most like `name`, best first, ignoring case; if there is none, ids of objects of the type so called.

    >>> nearest_names("mugg", ["Mug", "Fridge", "Cup"])
    ['Mug']
    >>> nearest_names("mug", ["Mug|+00.13|+01.10|-00.60", "Cup|+00.37|+01.64|-02.58"])
    ['Mug|+00.13|+01.10|-00.60']
    """
    by_lower = {candidate.lower(): candidate for candidate in known}
    close = difflib.get_close_matches(name.lower(), by_lower, n=count, cutoff=0.6)
    of_type = (candidate for candidate in by_lower if candidate.startswith(f"{name.lower()}|"))
    return [by_lower[hit] for hit in close or islice(of_type, count)]
