"""The space of questions: Gymnasium's Text, whose observations are also right in vector environments with shared memory.

`AsyncVectorEnv(shared_memory=True)`, which is its default, reads the shared memory once, when it is made, and hands out
copies of what it read (`gymnasium/vector/async_vector_env.py`, `self.observations`). Arrays are views, so they change with
the memory; but `_read_text_from_shared_memory` in `gymnasium/vector/utils/shared_memory.py` makes texts of it, which stay as
they were before the first reset (Gymnasium 1.0 to 1.4). The reader here gives texts that are read when they are asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from multiprocessing.sharedctypes import SynchronizedArray
from typing import Any, cast, overload

from gymnasium.spaces import Text
from gymnasium.vector.utils.shared_memory import read_from_shared_memory

_read_texts = read_from_shared_memory.dispatch(Text)


class QuestionText(Text):
    """Questions of up to `max_length` characters of `charset`; see `gymnasium.spaces.Text`."""


class LiveTexts(Sequence[str]):
    """The texts that lie in shared memory now, one for each environment; a copy is a tuple of str."""

    def __init__(self, space: Text, memory: SynchronizedArray[int], count: int) -> None:
        self._space, self._memory, self._count = space, memory, count

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...
    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        return self._now()[index]

    def __len__(self) -> int:
        return self._count

    def __eq__(self, other: object) -> bool:
        return self._now() == tuple(other) if isinstance(other, Sequence) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self._now())

    def __copy__(self) -> tuple[str, ...]:
        return self._now()

    def __deepcopy__(self, memo: dict[int, Any]) -> tuple[str, ...]:
        return self._now()

    def _now(self) -> tuple[str, ...]:
        return cast("tuple[str, ...]", _read_texts(self._space, self._memory, n=self._count))


@read_from_shared_memory.register(QuestionText)
def _read(space: QuestionText, shared_memory: SynchronizedArray[int], n: int = 1) -> LiveTexts:
    return LiveTexts(space, shared_memory, n)
