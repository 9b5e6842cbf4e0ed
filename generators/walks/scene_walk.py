"""One walk through one configuration of a room: its frames, graph, map and referring expressions, as rows."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from remqa_data.errors import ArrangementError
from remqa_data.generators.questions.expressions import Expression
from remqa_data.generators.walks.said import Said, said_of
from remqa_data.generators.walks.walk import WalkFrame, WalkSettings, walk
from remqa_data.mapping.semantic_map import VoxelMap
from remqa_data.scene_graph.graph import GraphUpdate, SceneGraph
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.render.view import WorldView
from remqa_data.tables.images import RgbFormat, encode_depth, encode_instances, encode_rgb
from remqa_data.tables.map_columns import map_columns
from remqa_data.tables.rows import EmbodimentRow, ExpressionRow, FrameRow, GridCell, SceneRow, Split

EMBODIMENT = EmbodimentRow(
    camera_height_m=AGENT.camera_height_m, fov_deg=AGENT.fov_deg, step_m=AGENT.step_m, reach_m=AGENT.reach_m
)


@dataclass(frozen=True)
class ConfigurationInfo:
    """Which configuration of which room, and what its rows say about it."""

    scene: str
    room_type: str
    configuration: int
    split: Split
    seed: int

    @property
    def prefix(self) -> str:
        """Begins the name of every row, such as "FloorPlan1-c0"."""
        return f"{self.scene}-c{self.configuration}"


@dataclass(frozen=True, eq=False)
class SceneWalk:
    """The rows of one walk."""

    scene: SceneRow
    frames: tuple[FrameRow, ...]
    expressions: tuple[ExpressionRow, ...]


def walk_through(
    place: ConfigurationInfo,
    view: WorldView,
    grid: ReachableGrid,
    start: Cell,
    expressions: Mapping[str, list[Expression]],
    settings: WalkSettings,
    rng: np.random.Generator,
    *,
    rgb_format: RgbFormat = "jpeg",
    expression_split: Split | None = None,
) -> SceneWalk:
    """Walk through a settled room and write down what is seen.

    Parameters
    ----------
    place : ConfigurationInfo
        Names and split of the rows.
    view : WorldView
        The room; it must not change meanwhile.
    grid : ReachableGrid
        Where the agent can stand.
    start : Cell
        Where the walk begins.
    expressions : mapping of str to list of Expression
        Referring expressions of this configuration by target id; `said.said_of` says which are kept, and for which frames.
    settings : WalkSettings
        Which frames to take.
    rng : numpy.random.Generator
        For the walk.
    rgb_format : {"jpeg", "png"}
        How colour images are stored.
    expression_split : {"train", "val", "test"}, optional
        Split of the expressions, where it differs from that of the frames.
    """
    world = view.world
    types = [world.type_of(object_id) for object_id in world.ids]
    graph, voxels = SceneGraph(), VoxelMap.of_scene(world.scene)
    frames: list[FrameRow] = []
    for index, taken in enumerate(walk(view, grid, start, settings, rng)):
        voxels.add(taken.observation.depth, taken.observation.objects, types, taken.camera)
        update = graph.add_frame(taken.metadata)
        frames.append(_frame_row(place, index, taken, world.ids, update, rgb_format))
    if not frames:
        raise ArrangementError(
            f"{place.scene}: no pose that the walk tries shows {settings.min_objects} objects; give more cells_per_frame, "
            "frames_per_configuration, headings_deg or horizons_deg"
        )
    said = [_expression_row(place, one, expression_split or place.split) for one in said_of(frames, expressions)]
    stored, map_2d = map_columns(voxels.to_sparse(), voxels.plan())
    scene = SceneRow(
        scene=place.scene,
        room_type=place.room_type,
        split=place.split,
        configuration=place.configuration,
        seed=place.seed,
        scene_json=world.to_scene().to_json().decode(),
        objects=tuple(object_metadata(world).values()),
        graph_nodes=tuple(graph.objects),
        graph_edges=graph.edges,
        semantic_map=stored,
        map_2d=map_2d,
        navigation_cells=tuple(GridCell(*cell) for cell in grid.cells),
        walk_start_cell=GridCell(*start),
        embodiment=EMBODIMENT,
    )
    return SceneWalk(scene, tuple(frames), tuple(said))


def _frame_row(
    place: ConfigurationInfo, index: int, taken: WalkFrame, ids: tuple[str, ...], update: GraphUpdate, form: RgbFormat
) -> FrameRow:
    name = f"{place.prefix}-f{index:02d}"
    listed = [seen.id for seen in taken.metadata.objects]
    shown = taken.observation
    return FrameRow(
        frame_id=name,
        scene=place.scene,
        configuration=place.configuration,
        split=place.split,
        index=index,
        rgb=encode_rgb(shown.rgb, name, form=form),
        depth=encode_depth(shown.depth, f"{name}-depth"),
        instances=encode_instances(shown.objects, ids, listed, f"{name}-instances"),
        agent=taken.metadata.agent,
        objects=taken.metadata.objects,
        added_nodes=tuple(node.id for node in update.nodes),
        added_edges=update.edges,
    )


def _expression_row(place: ConfigurationInfo, said: Said, split: Split) -> ExpressionRow:
    expression, frame = said.expression, said.frame
    seen = next(item for item in frame.objects if item.id == expression.target_id)
    return ExpressionRow(
        expression_id=f"{place.prefix}-{expression.target_id}-e{said.number}",
        scene=place.scene,
        configuration=place.configuration,
        split=split,
        frame_id=frame.frame_id,
        text=expression.text,
        kind=expression.kind,
        target_id=expression.target_id,
        target_type=expression.target_type,
        anchor_id=expression.anchor_id,
        relation=expression.relation,
        box_2d=seen.box_2d,
        program=json.dumps(expression.program),
    )
