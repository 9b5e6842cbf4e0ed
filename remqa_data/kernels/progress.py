"""Tells who wants to know which kernels are being compiled; nothing here loads Numba, so that a command can listen before."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Compiling:
    """A kernel that is being compiled: its name, the how manyth it is, and how many are known by now."""

    name: str
    number: int
    known: int


_listeners: list[Callable[[Compiling], None]] = []


@contextmanager
def listening(listener: Callable[[Compiling], None]) -> Iterator[None]:
    """Call a function with each kernel that is compiled meanwhile in this process."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def tell(kernel: Compiling) -> None:
    """Log it and call the listeners."""
    logger.info("compiling kernel %s (%d of %d), once", kernel.name, kernel.number, kernel.known)
    for listener in _listeners:
        listener(kernel)
