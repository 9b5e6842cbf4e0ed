"""The frames of a walk, drawn anew in a freshly loaded room, and the graph and the map that grow with them."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import fields

from remqa_data.errors import NoPathError
from remqa_data.generators.audit.failures import Broken, Failure
from remqa_data.generators.audit.truths import CheckedRoom
from remqa_data.generators.config import Config
from remqa_data.mapping.semantic_map import VoxelMap
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import AgentState, FrameMetadata, frame_metadata
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import Observation, WorldView
from remqa_data.tables.images import StoredImage, encode_depth, encode_instances, encode_rgb
from remqa_data.tables.map_columns import map_columns
from remqa_data.tables.rows import FrameRow

PNG_HEADER = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"


def size_failures(frames: Sequence[FrameRow], size_px: int) -> Iterator[Failure]:
    """Frames whose images are not of the size that the configuration says, told from their headers."""
    for frame in frames:
        for name in ("depth", "instances"):
            size = _png_size(getattr(frame, name))
            if size != (size_px, size_px):
                yield Failure(frame.frame_id, "replayable", f"{name} is no PNG of {size_px} x {size_px} pixels")


def frame_failures(room: CheckedRoom, frames: Sequence[FrameRow], config: Config) -> Iterator[Failure]:
    """What does not hold of the frames of one configuration, and of the graph and map in its scene row.

    Parameters
    ----------
    room : CheckedRoom
        The configuration.
    frames : sequence of FrameRow
        All its frames, in order.
    config : Config
        What size and format frames have, and which poses walks may take.
    """
    graph, voxels = SceneGraph(), VoxelMap.of_scene(room.scene)
    with World(room.scene) as world:
        view, types = WorldView(world), [world.type_of(object_id) for object_id in world.ids]
        for frame in frames:
            try:
                camera = _camera(room, frame, config)
            except NoPathError as error:
                yield Failure(frame.frame_id, "reachable", str(error))
                continue
            seen = view.render(camera)
            shown = frame_metadata(world, seen, frame.agent, camera, known=room.records)
            voxels.add(seen.depth, seen.objects, types, camera)
            update = graph.add_frame(shown)
            for truth, reason in (*_pictures(frame, seen, world.ids, config), *_objects(frame, shown)):
                yield Failure(frame.frame_id, truth, reason)
            if frame.added_nodes != tuple(node.id for node in update.nodes):
                yield Failure(frame.frame_id, "consistent", "added_nodes are not what it adds to the scene graph")
            if frame.added_edges != update.edges:
                yield Failure(frame.frame_id, "consistent", "added_edges are not what it adds to the scene graph")
    semantic_map, map_2d = map_columns(voxels.to_sparse(), voxels.plan())
    now = {
        "graph_nodes": tuple(graph.objects),
        "graph_edges": graph.edges,
        "semantic_map": semantic_map,
        "map_2d": map_2d,
    }
    for name, value in now.items():
        if getattr(room.row, name) != value:
            yield Failure(room.name, "consistent", f"{name} is not what its frames show")


def _camera(room: CheckedRoom, frame: FrameRow, config: Config) -> Camera:
    """The camera that the frame must have been drawn with; NoPathError if the agent cannot be or look there."""
    pose = frame.agent.pose()
    if pose.cell not in room.grid.graph or AgentState.of(room.grid, pose) != frame.agent:
        raise NoPathError(f"the agent cannot stand at {frame.agent.position}")
    if pose.yaw_deg not in config.walk.headings_deg or pose.horizon_deg not in config.walk.horizons_deg:
        raise NoPathError(f"the configuration's walks do not look {pose.yaw_deg} and {pose.horizon_deg} degrees")
    return pose.camera(room.grid, config.image.size_px)


def _pictures(frame: FrameRow, seen: Observation, ids: tuple[str, ...], config: Config) -> Iterator[Broken]:
    listed = [item.id for item in frame.objects]
    name = frame.frame_id
    now = {
        "rgb": encode_rgb(seen.rgb, name, form=config.image.rgb_format),
        "depth": encode_depth(seen.depth, f"{name}-depth"),
        "instances": encode_instances(seen.objects, ids, listed, f"{name}-instances"),
    }
    for column, image in now.items():
        if getattr(frame, column) != image:
            yield "replayable", f"{column} is not what is seen"


def _objects(frame: FrameRow, shown: FrameMetadata) -> Iterator[Broken]:
    """The visible objects, their boxes and what is said of them."""
    if [item.id for item in frame.objects] != [item.id for item in shown.objects]:
        there = {item.id for item in frame.objects} ^ {item.id for item in shown.objects}
        yield (
            "visible",
            f"objects are not those that are seen, in their order: {', '.join(sorted(there)) or 'reordered'}",
        )
        return
    for stored, now in zip(frame.objects, shown.objects, strict=True):
        wrong = [field.name for field in fields(now) if getattr(stored, field.name) != getattr(now, field.name)]
        if wrong:
            yield "visible", f"{stored.id}: {', '.join(wrong)} is not what is seen"


def _png_size(image: StoredImage) -> tuple[int, int] | None:
    """Width and height in pixels that a PNG says it has; None if it is no PNG."""
    if not image.bytes.startswith(PNG_HEADER) or len(image.bytes) < len(PNG_HEADER) + 8:
        return None
    width, height = struct.unpack_from(">II", image.bytes, len(PNG_HEADER))
    return width, height
