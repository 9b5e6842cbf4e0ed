"""The pages as HTML: what each shows, gathered and put into its template. Every text is escaped by the template."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from remqa_data.browse.answers import AgentAnswers, given_answers
from remqa_data.browse.dataset import Arrangement, BrowsedDataset, RoomKey, slug
from remqa_data.browse.filters import CHOICES, PAGE, Filters, searched_text
from remqa_data.browse.models import carried, hung
from remqa_data.browse.neighbours import neighbourhood
from remqa_data.browse.pictures import object_color, objects_shown
from remqa_data.browse.programs import graph_of, noun, steps_in_words
from remqa_data.browse.room_map import RoomMap, way
from remqa_data.browse.statistics import StatisticsPage, statistics_page
from remqa_data.browse.walks import WalkedFrame, Walks
from remqa_data.extras import require
from remqa_data.generators.audit.recount.report import Figure
from remqa_data.mapping.map_picture import plan_legend
from remqa_data.published import SOURCE
from remqa_data.tables.images import image_size

FOLDER = Path(__file__).parent
CARD = (
    "question_id",
    "kind",
    "question",
    "answer",
    "scene",
    "room_type",
    "split",
    "manipulation",
    "target_type",
    "answer_type",
)


@dataclass(frozen=True)
class Scope:
    """What pages there are besides those that there always are.

    Attributes
    ----------
    rows : sequence of int
        Of the index: the questions that have a page.
    rooms : collection of RoomKey
        The arrangements that have a page.
    is_static : bool
        Whether the pages are files, so that a script does what the server does else.
    """

    rows: Sequence[int]
    rooms: Collection[RoomKey]
    is_static: bool

    @cached_property
    def models(self) -> frozenset[RoomKey]:
        """The arrangements that are shown in 3D: of files only the first of each room, as each is some megabytes."""
        if not self.is_static:
            return frozenset(self.rooms)
        first = {key.scene: key for key in sorted(self.rooms, reverse=True)}
        return frozenset(first.values())


class Pages:
    """Makes the pages of a dataset.

    Parameters
    ----------
    dataset : BrowsedDataset
    walks : Walks
        Of the same dataset.
    agents : sequence of AgentAnswers
        Whose answers are shown.
    audit : tuple of Figure
        Shown on the page of statistics; empty if it was not made.
    scope : Scope

    Raises
    ------
    MissingExtraError
        If jinja2 is not installed.
    """

    def __init__(
        self,
        dataset: BrowsedDataset,
        walks: Walks,
        agents: Sequence[AgentAnswers],
        audit: tuple[Figure, ...],
        scope: Scope,
    ) -> None:
        jinja2 = require("jinja2", "browse")
        self._dataset, self._walks, self._agents, self._audit, self.scope = dataset, walks, agents, audit, scope
        self._in_scope = frozenset(scope.rows)
        self._environment = jinja2.Environment(
            loader=jinja2.FileSystemLoader(FOLDER),
            autoescape=True,
            undefined=jinja2.StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        self._environment.filters |= {"slug": slug, "noun": noun, "words": lambda name: str(name).replace("_", " ")}

    def questions(self, filters: Filters) -> str:
        """The list: one page of the questions that filters let through, or all of them if a script is to filter."""
        if self.scope.is_static:
            rows, shown = list(self.scope.rows), list(self.scope.rows)
        else:
            rows = filters.rows(self._dataset.index, self._searched)
            first = (min(filters.page, self._pages(len(rows))) - 1) * PAGE
            shown = rows[first : first + PAGE]
        cards = self._dataset.index.select(CARD).take(pa.array(shown, pa.int64())).to_pylist()
        return self._render(
            "list.html.j2",
            root="",
            filters=filters,
            choices=self._choices,
            cards=cards,
            count=len(rows),
            pages=self._pages(len(rows)),
            page_size=PAGE,
        )

    def question(self, row: int) -> str:
        """One question."""
        dataset = self._dataset
        asked = dataset.question(row)
        key = RoomKey(asked["scene"], asked["configuration"])
        room = dataset.room(key)
        graph = None if room is None else graph_of(room.objects)
        siblings = [(other, dataset.brief(other)) for other in dataset.groups[asked["group"]]]
        names = ["start_rgb", "start_instances", "end_instances"]
        view, start, end = dataset.question_pictures(row, names)
        place = self.scope.rows.index(row) if row in self._in_scope else 0
        near = [self.scope.rows[i] if 0 <= i < len(self.scope.rows) else None for i in (place - 1, place + 1)]
        return self._render(
            "question.html.j2",
            root="../",
            asked=asked,
            room=room,
            has_walk=key in self.scope.rooms,
            room_slug=key.slug,
            view_size=image_size(view),
            steps=steps_in_words(asked["program"], graph),
            siblings=[(other in self._in_scope, brief) for other, brief in siblings],
            shown={"start": self._legend(start, asked["object_ids"]), "end": self._legend(end, asked["object_ids"])},
            map=None if room is None else self._question_map(room, asked),
            legend=[] if room is None else plan_legend(room.plan),
            graph=None if room is None else neighbourhood(room, asked["target_id"]),
            given=given_answers(self._agents, asked["question_id"], asked["answer"]),
            has_agents=bool(self._agents),
            before=None if near[0] is None else dataset.brief(near[0])["question_id"],
            after=None if near[1] is None else dataset.brief(near[1])["question_id"],
        )

    def rooms(self) -> str:
        """All rooms, and how many questions about each have a page."""
        counts = Counter(self._dataset.frame["scene"].iloc[list(self.scope.rows)])
        found: dict[str, list[tuple[str, list[RoomKey], int]]] = {}
        for scene in sorted({key.scene for key in self.scope.rooms}, key=_natural):
            keys = sorted(key for key in self.scope.rooms if key.scene == scene)
            room_type = self._room_types.get(scene, "other")
            found.setdefault(room_type, []).append((scene, keys, counts[scene]))
        return self._render("rooms.html.j2", root="", rooms=found)

    def walk(self, key: RoomKey) -> str:
        """The walk through one arrangement of a room."""
        room = self._dataset.room(key)
        assert room is not None, "only rooms in scope have pages"
        frame = RoomMap.of(room)
        frames = self._walks.frames(key, frame)
        step_of = {node: number for number, one in enumerate(frames) for node in one.nodes}
        boxes = {thing.id: thing.box for thing in room.objects}
        dots = [(node, frame.centre(boxes[node]), step) for node, step in step_of.items() if node in boxes]
        lines = [
            (frame.centre(boxes[source]), frame.centre(boxes[target]), number)
            for number, one in enumerate(frames)
            for source, relation, target in one.edges
            if source in boxes and target in boxes and not (relation == "next to" and source > target)
        ]
        configurations = sorted(other for other in self.scope.rooms if other.scene == key.scene)
        return self._render(
            "walk.html.j2",
            root="../",
            room=room,
            slug_=key.slug,
            map=frame,
            frames=frames,
            data=[_told(one) for one in frames],
            dots=dots,
            lines=lines,
            legend=plan_legend(room.plan),
            configurations=configurations,
            questions=self._asked_about(key),
            has_model=key in self.scope.models,
        )

    def model(self, key: RoomKey) -> str:
        """One arrangement of a room in 3D."""
        room = self._dataset.room(key)
        assert room is not None, "only rooms in scope have pages"
        return self._render(
            "room.html.j2",
            root="../",
            room=room,
            slug_=key.slug,
            carried=carried(room.objects),
            hung=hung(room.objects),
        )

    def statistics(self) -> str:
        """The dataset in numbers."""
        return self._render("statistics.html.j2", root="", statistics=self._statistics, source=SOURCE)

    def missing(self, root: str = "") -> str:
        """What is shown where there is nothing."""
        return self._render("missing.html.j2", root=root)

    def _render(self, template: str, **context: Any) -> str:
        page = self._environment.get_template(template).render(
            **context,
            name=self._dataset.root.name or str(self._dataset.root),
            total=self._dataset.index.num_rows,
            is_static=self.scope.is_static,
        )
        return str(page)

    @cached_property
    def _searched(self) -> Any:
        return searched_text(self._dataset.index)

    @cached_property
    def _statistics(self) -> StatisticsPage:
        return statistics_page(self._dataset.frame, self._dataset.manifest.splits("questions"), self._audit)

    @cached_property
    def _room_types(self) -> dict[str, str]:
        frame = self._dataset.frame
        return dict(zip(frame["scene"], frame["room_type"], strict=True))

    @cached_property
    def _choices(self) -> dict[str, list[tuple[str, int]]]:
        """By name of a filter, its values and how many questions have them, in natural order."""
        index = (
            self._dataset.index.take(pa.array(self.scope.rows, pa.int64()))
            if self.scope.is_static
            else self._dataset.index
        )
        found = {}
        for name, column in CHOICES.items():
            counts = [(str(one["values"]), int(one["counts"])) for one in pc.value_counts(index[column]).to_pylist()]
            found[name] = sorted(counts, key=lambda item: _natural(item[0]) if name == "scene" else (0, item[0]))
        return found

    def _asked_about(self, key: RoomKey) -> list[tuple[bool, dict[str, Any]]]:
        frame = self._dataset.frame
        rows = frame.index[(frame["scene"] == key.scene) & (frame["configuration"] == key.configuration)].tolist()
        return [(row in self._in_scope, self._dataset.brief(row)) for row in rows]

    def _legend(self, instances: bytes, ids: Sequence[str]) -> list[tuple[str, tuple[int, int, int]]]:
        shown = [number for number in objects_shown(instances) if number <= len(ids)]
        return [(ids[number - 1], object_color(number)) for number in shown]

    def _question_map(self, room: Arrangement, asked: dict[str, Any]) -> dict[str, Any]:
        frame = RoomMap.of(room)
        boxes = {thing.id: thing.box for thing in room.objects}
        target = boxes.get(asked["target_id"])
        return {
            "frame": frame,
            "way": way(room, frame, asked["initial_pose"], asked["actions"]),
            "start": frame.standing(asked["initial_pose"]),
            "goals": [frame.standing(pose) for pose in asked["goal_poses"]],
            "target": None if target is None else frame.rectangle(target),
            "answers": [frame.rectangle(boxes[name]) for name in asked["answer_ids"] if name in boxes],
        }

    @staticmethod
    def _pages(count: int) -> int:
        return max(1, -(-count // PAGE))


def _natural(scene: str) -> tuple[int, str]:
    """By what rooms are ordered: FloorPlan2 comes before FloorPlan10."""
    return len(scene), scene


def _told(frame: WalkedFrame) -> dict[str, Any]:
    """What the slider's script shows of a frame."""
    return {
        "id": frame.id,
        "seen": frame.seen,
        "nodes": frame.nodes,
        "edges": [" ".join(edge) for edge in frame.edges],
        "allNodes": frame.all_nodes,
        "allEdges": frame.all_edges,
    }
