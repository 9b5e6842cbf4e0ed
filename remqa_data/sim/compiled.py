"""Two decorators that compile a function to machine code, with types kept for mypy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def exact(function: Function) -> Function:
    """Compile with every rounding as written: for anything that decides which triangle a pixel shows."""
    return cast(Function, njit(cache=True, nogil=True, error_model="numpy")(function))


def relaxed(function: Function) -> Function:
    """Compile with reordered and fused arithmetic: for colours, where the last bit does not matter.

    The result is still the same on the same machine: the reordering happens once, when the code is compiled.
    """
    return cast(Function, njit(cache=True, nogil=True, error_model="numpy", fastmath=True)(function))
