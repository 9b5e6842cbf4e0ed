"""A decorator that compiles a function to machine code, with types kept for mypy.

The machine code is kept on disk, so that only the first run on a machine waits for the compiler. Numba renews it when
the function's own file changes, but not when a function it calls in another file does; so the folder is named after a
hash of all files with compiled functions.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.core import config, event

from remqa_data.kernels.cache import kernel_cache
from remqa_data.kernels.progress import Compiling, tell

Function = TypeVar("Function", bound=Callable[..., object])

SOURCES = (
    "compiled",
    "mapping/voxel_votes",
    "sim/arm/obstacles",
    "sim/light/bake",
    "sim/light/gather",
    "sim/light/patches",
    "sim/light/volume",
    "sim/light/voxels",
    "sim/render/antialias",
    "sim/render/camera",
    "sim/render/counting",
    "sim/render/mipmap",
    "sim/render/mirrors",
    "sim/render/outline",
    "sim/render/pixels",
    "sim/render/raster",
    "sim/render/shade",
    "sim/render/shadow",
)
"""Modules with compiled functions, or with what these use; tests/kernels/test_compiled.py finds them."""

# Nothing calls kernels from C; an entrance for that would take the compiler a while.
_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}


def exact(function: Function) -> Function:
    """Compile with every rounding as written, so that each processor computes the same bits.

    Nothing is reordered and no product is fused with a sum (`fastmath` would do both, each processor in its own way).
    """
    _teller.known += 1
    usual: str = config.CACHE_DIR  # type: ignore[attr-defined]
    config.CACHE_DIR = _cache_folder(usual)  # type: ignore[attr-defined]
    try:
        return cast(Function, njit(**_OPTIONS)(function))
    finally:
        config.CACHE_DIR = usual  # type: ignore[attr-defined]


def is_cache_empty() -> bool:
    """Whether nothing has been compiled yet with these sources where machine code is kept."""
    folder = Path(_cache_folder(config.CACHE_DIR))  # type: ignore[attr-defined]
    return next(folder.rglob("*.nbi"), None) is None


@cache
def _cache_folder(usual: str) -> str:
    here = Path(__file__).parent
    digest = hashlib.sha256(b"".join((here / f"{module}.py").read_bytes() for module in SOURCES)).hexdigest()
    return str(kernel_cache(usual, here / "__pycache__") / f"compiled-{digest[:12]}")


class _Teller(event.Listener):
    """Tells which of our functions Numba compiles; it is silent about those that it finds in the cache."""

    def __init__(self) -> None:
        self.known, self.begun = 0, 0

    def on_start(self, happened: event.Event) -> None:
        function = happened.data["dispatcher"].py_func
        if function.__module__.startswith("remqa_data."):
            self.begun += 1
            tell(Compiling(function.__name__, self.begun, max(self.begun, self.known)))

    def on_end(self, happened: event.Event) -> None:
        pass


_teller = _Teller()
event.register("numba:compile", _teller)  # type: ignore[no-untyped-call]
