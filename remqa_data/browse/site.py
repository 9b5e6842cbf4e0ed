"""Every address of the pages and what lies there; served one by one, or written to files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from remqa_data.browse.answers import AgentAnswers
from remqa_data.browse.dataset import BrowsedDataset, RoomKey
from remqa_data.browse.filters import Filters
from remqa_data.browse.models import model_script
from remqa_data.browse.pages import FOLDER, Pages, Scope
from remqa_data.browse.pictures import depth_picture, media_type, objects_picture, plan_picture
from remqa_data.browse.walks import Walks
from remqa_data.generators.audit.recount.report import Figure

HTML = "text/html; charset=utf-8"
SCRIPT = "text/javascript; charset=utf-8"
STYLES = {
    "browse.css": "text/css; charset=utf-8",
    "browse.js": SCRIPT,
    "room.js": SCRIPT,
    "three.js": SCRIPT,
    "icon.svg": "image/svg+xml",
}
QUESTION_PICTURES = ("start.jpg", "end.jpg", "start-depth.jpg", "end-depth.jpg", "start-objects.jpg", "end-objects.jpg")


@dataclass(frozen=True)
class Found:
    """What lies at an address.

    Attributes
    ----------
    body : bytes
    media_type : str
    """

    body: bytes
    media_type: str


class Site:
    """The pages and pictures of a dataset by their addresses, which are relative and the same on disk and served.

    Parameters
    ----------
    dataset : BrowsedDataset
    agents : sequence of AgentAnswers
    audit : tuple of Figure
    is_static : bool
        Whether the pages are to be files.
    limit : int, optional
        Only so many questions, spread evenly, and their rooms.
    """

    def __init__(
        self,
        dataset: BrowsedDataset,
        agents: Sequence[AgentAnswers] = (),
        audit: tuple[Figure, ...] = (),
        *,
        is_static: bool = False,
        limit: int | None = None,
    ) -> None:
        self._dataset, self._walks = dataset, Walks(dataset)
        self.scope = _scope(dataset, is_static, limit)
        self._pages = Pages(dataset, self._walks, agents, audit, self.scope)

    def get(self, path: str, query: Mapping[str, str] | None = None) -> Found | None:
        """What lies at an address, such as "q/FloorPlan1-COUNTING-00-c2.html"; None where nothing does."""
        if path in ("", "index.html"):
            return _page(self._pages.questions(Filters.of(query or {})))
        if path == "rooms.html":
            return _page(self._pages.rooms())
        if path == "statistics.html":
            return _page(self._pages.statistics())
        match path.split("/"):
            case ["style", name] if name in STYLES:
                return Found((FOLDER / name).read_bytes(), STYLES[name])
            case ["q", name]:
                row = self._dataset.rows.get(name.removesuffix(".html"))
                return None if row is None else _page(self._pages.question(row))
            case ["w", name]:
                key = self._keys.get(name.removesuffix(".html"))
                return None if key is None else _page(self._pages.walk(key))
            case ["r", name]:
                return self._of_model(name)
            case ["p", "q", name, picture]:
                row = self._dataset.rows.get(name)
                return None if row is None or picture not in QUESTION_PICTURES else self._of_question(row, picture)
            case ["p", "w", name, picture]:
                key = self._keys.get(name)
                return None if key is None else self._of_walk(key, picture)
        return None

    def missing(self, path: str) -> Found:
        """The page for an address where nothing lies."""
        return _page(self._pages.missing("../" * path.count("/")))

    def addresses(self) -> Iterator[str]:
        """All addresses, but for filtered lists; that of the first page comes last."""
        yield from (f"style/{name}" for name in STYLES)
        names = {row: name for name, row in self._dataset.rows.items()}
        for row in self.scope.rows:
            yield from (f"p/q/{names[row]}/{picture}" for picture in QUESTION_PICTURES)
            yield f"q/{names[row]}.html"
        for key in sorted(self.scope.rooms):
            for number in range(len(self._dataset.walk_places.get(key, []))):
                yield f"p/w/{key.slug}/f{number}.jpg"
                yield f"p/w/{key.slug}/m{number}.png"
            yield f"p/w/{key.slug}/map.png"
            if key in self.scope.models:
                yield f"r/{key.slug}.js"
                yield f"r/{key.slug}.html"
            yield f"w/{key.slug}.html"
        yield from ("statistics.html", "rooms.html", "index.html")

    @cached_property
    def _keys(self) -> dict[str, RoomKey]:
        return {key.slug: key for key in self.scope.rooms}

    def _of_model(self, name: str) -> Found | None:
        stem, _, kind = name.rpartition(".")
        key = self._keys.get(stem)
        if key is None or key not in self.scope.models or kind not in ("html", "js"):
            return None
        if kind == "html":
            return _page(self._pages.model(key))
        return Found(model_script(self._dataset.scene_json(key), key.slug), SCRIPT)

    def _of_question(self, row: int, picture: str) -> Found:
        when, _, what = picture.removesuffix(".jpg").partition("-")
        if what == "depth":
            (depth,) = self._dataset.question_pictures(row, [f"{when}_depth"])
            return _picture(depth_picture(depth))
        if what == "objects":
            rgb, instances = self._dataset.question_pictures(row, [f"{when}_rgb", f"{when}_instances"])
            return _picture(objects_picture(rgb, instances))
        return _picture(self._dataset.question_pictures(row, [f"{when}_rgb"])[0])

    def _of_walk(self, key: RoomKey, picture: str) -> Found | None:
        if picture == "map.png":
            room = self._dataset.room(key)
            return None if room is None else _picture(plan_picture(room.plan))
        named = re.fullmatch(r"(?:f(\d{1,9})\.jpg|m(\d{1,9})\.png)", picture, re.ASCII)
        if named is None:
            return None
        places = self._dataset.walk_places.get(key, [])
        if named[1] is not None:
            number = int(named[1])
            return _picture(self._dataset.walk_pictures(places[number], ["rgb"])[0]) if number < len(places) else None
        grown = self._walks.map_after(key, int(named[2])) if int(named[2]) < len(places) else None
        return self._of_walk(key, "map.png") if grown is None else _picture(grown)


def _scope(dataset: BrowsedDataset, is_static: bool, limit: int | None) -> Scope:
    count = dataset.index.num_rows
    if limit is None or limit >= count:
        return Scope(range(count), frozenset(dataset.room_places), is_static)
    rows = np.unique(np.linspace(0, count - 1, limit).round().astype(int)).tolist()
    briefs = (dataset.brief(row) for row in rows)
    rooms = {RoomKey(one["scene"], one["configuration"]) for one in briefs} & dataset.room_places.keys()
    return Scope(rows, frozenset(rooms), is_static)


def _page(html: str) -> Found:
    return Found(html.encode(), HTML)


def _picture(data: bytes) -> Found:
    return Found(data, media_type(data))
