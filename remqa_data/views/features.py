"""Features of a backbone, kept beside the frames.

A backbone is any function `features(frames)` that takes (n, size, size, 3) uint8 and gives an (n, ...) array; it is named
as "module:function", so that worker processes find it.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from remqa_data.errors import ConfigError, MissingExtraError, RemqaError, one_line
from remqa_data.geometry.types import U8
from remqa_data.views.arrays import features_name, new_array
from remqa_data.views.manifest import CachedRoom, ViewFile
from remqa_data.views.reader import RoomViews, read_room

BATCH = 64

Features = Callable[[U8], npt.ArrayLike]


def load_function(name: str) -> Features:
    """The function of a name such as "mypackage.backbone:features".

    Raises
    ------
    ConfigError
        If there is none.
    MissingExtraError
        If it needs PyTorch, and that is not installed.
    """
    module, _, function = name.partition(":")
    if not (module and function):
        raise ConfigError(f"--features {name!r}: name a function as module:function")
    try:
        found = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, TypeError, ValueError) as error:  # the last two: of a name such as ".a"
        if isinstance(error, ModuleNotFoundError) and error.name == "torch":
            raise MissingExtraError("torch", "agents") from None
        raise ConfigError(f"--features {name}: {one_line(error)}") from None
    if not callable(found):
        raise ConfigError(f"--features {name}: this is a {type(found).__name__}, no function")
    features: Features = found
    return features


def add_features(folder: Path, room: CachedRoom, name: str) -> tuple[ViewFile, ...]:
    """Write the features of a finished room, float16; states that a configuration does not have are zeros.

    Raises
    ------
    ConfigError
        If the function gives what cannot be stored: says what it gave.
    """
    function = load_function(name)
    files = []
    for configuration in room.configurations:
        path = f"{room.scene}/{features_name(configuration)}"
        _write(folder / path, read_room(folder, room, configuration), function, name)
        files.append(ViewFile.of(folder, path))
    return tuple(files)


def _write(path: Path, views: RoomViews, function: Features, name: str) -> None:
    states = np.flatnonzero(views.is_reachable)
    with ExitStack() as stack:
        stored: npt.NDArray[Any] | None = None
        for first in range(0, len(states), BATCH):
            batch = states[first : first + BATCH]
            found = _features(function, name, np.stack([views.frame(state) for state in batch.tolist()]))
            if stored is None:
                shape = (len(views.states), *found.shape[1:])
                stored = stack.enter_context(new_array(path, shape, np.float16))
            if found.shape[1:] != stored.shape[1:]:
                raise ConfigError(f"--features {name}: gave {found.shape[1:]} after {stored.shape[1:]} for a frame")
            stored[batch] = found


def _features(function: Features, name: str, frames: U8) -> npt.NDArray[np.float16]:
    try:
        found = np.asarray(function(frames))
    except RemqaError:
        raise
    except Exception as error:  # whatever somebody's function raises
        raise ConfigError(f"--features {name}: {type(error).__name__}: {one_line(error)}") from error
    if found.ndim < 2 or len(found) != len(frames) or 0 in found.shape or found.dtype.kind not in "fiu":
        raise ConfigError(
            f"--features {name}: gave {found.dtype} {found.shape} for {len(frames)} frames; give ({len(frames)}, ...) numbers"
        )
    with np.errstate(over="ignore"):
        half = found.astype(np.float16)
    if not np.isfinite(half).all():
        raise ConfigError(f"--features {name}: gave numbers that float16 does not hold; scale them below 65504")
    return half
