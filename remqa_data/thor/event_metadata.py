"""An event's metadata, whose `objects` are worked out when they are first read: of most steps nobody reads them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ai2thor.server import MetadataWrapper

from remqa_data.thor.state.events import Listing

OBJECTS = "objects"


class EventMetadata(MetadataWrapper):  # type: ignore[misc]  # AI2-THOR has no types
    """AI2-THOR's dictionary of an event. It has its `objects` as soon as they, or all of it, are asked for.

    Parameters
    ----------
    rest : mapping
        All but the objects.
    listing : Listing
        The objects.
    """

    def __init__(self, rest: Mapping[str, Any], listing: Listing) -> None:
        super().__init__(rest)
        self._listing: Listing | None = listing

    def _complete(self) -> None:
        listing = self._listing  # another thread may be here, too
        if listing is not None:
            dict.setdefault(self, OBJECTS, listing.read())
            self._listing = None

    def __missing__(self, key: str) -> Any:
        if key == OBJECTS:
            self._complete()
            if super().__contains__(OBJECTS):
                return super().__getitem__(OBJECTS)
        raise KeyError(key)

    def __contains__(self, key: object) -> bool:
        return (key == OBJECTS and self._listing is not None) or super().__contains__(key)

    def get(self, key: str, default: Any = None) -> Any:
        """As of a dictionary."""
        if key == OBJECTS:
            self._complete()
        return super().get(key, default)

    def __iter__(self) -> Iterator[str]:
        self._complete()
        yield from super().__iter__()

    def __reduce__(self) -> tuple[type[MetadataWrapper], tuple[dict[str, Any]]]:
        return MetadataWrapper, (dict(self),)


def _of_all(name: str) -> Callable[..., Any]:
    """A dictionary's method, of one that is complete."""
    plain = getattr(dict, name)

    def method(self: EventMetadata, *arguments: Any, **more: Any) -> Any:
        for one in (self, *arguments):
            if isinstance(one, EventMetadata):
                one._complete()
        return plain(self, *arguments, **more)

    method.__name__, method.__doc__ = name, plain.__doc__
    return method


_OF_ALL = ("__delitem__", "__eq__", "__ior__", "__len__", "__ne__", "__or__", "__repr__", "__reversed__", "__ror__")
for _name in (*_OF_ALL, "clear", "copy", "items", "keys", "pop", "popitem", "setdefault", "values"):
    setattr(EventMetadata, _name, _of_all(_name))
