"""PyBullet, imported without the line about its build time that it prints on stderr, and a client of it."""

from __future__ import annotations

import os
import weakref
from functools import partial
from typing import Any

_stderr = os.dup(2)
_null = os.open(os.devnull, os.O_WRONLY)
os.dup2(_null, 2)
try:
    import pybullet
finally:
    os.dup2(_stderr, 2)
    os.close(_stderr)
    os.close(_null)

__all__ = ["BulletClient", "pybullet"]


class BulletClient:
    """A simulation without a screen: its attributes are PyBullet's functions, which act on it alone.

    It is like `pybullet_utils.bullet_client.BulletClient`, but may be closed more than once.

    Attributes
    ----------
    number : int
        What PyBullet calls `physicsClientId`; -1 once it is closed.

    Examples
    --------
    >>> client = BulletClient()
    >>> client.getNumBodies()
    0
    >>> client.close()
    """

    def __init__(self) -> None:
        self.number = int(pybullet.connect(pybullet.DIRECT))
        self._disconnect = weakref.finalize(self, pybullet.disconnect, self.number)

    def __getattr__(self, name: str) -> Any:
        return partial(getattr(pybullet, name), physicsClientId=self.number)

    def close(self) -> None:
        """Give PyBullet's memory back, which the last reference to this does, too."""
        self._disconnect()  # the first time only
        self.number = -1
