"""Rooms and assets as glTF: a tree of named nodes, so that what opens can be opened in a viewer."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh

from remqa_data.assets.core.model import Asset
from remqa_data.export.links import joint_range, link_origins, relative_poses
from remqa_data.export.looks import gltf_mesh
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.scene_arrays import structure_groups

Y_UP = trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0))
"""glTF has y up and looks at the front from +z; assets have z up and their front at -y."""


def room_scene(world: World) -> trimesh.Scene:
    """A room as it stands, as a trimesh scene in metres, y up.

    Under a node with the room's name lie `structure/KIND/NUMBER` and a node for each object, named by its id; under that one
    for each link, `ID/LINK`, and its surfaces, `ID/LINK/NUMBER`. The frame of a link lies on its joint, which the node's
    extras tell: `joint` (revolute or prismatic), `axis`, `range` and `position`, in radians or metres, in the frame of the
    node above it.
    """
    scene, room = trimesh.Scene(), world.scene.name
    scene.graph.update(room, matrix=Y_UP)
    for number, (kind, surface) in enumerate(structure_groups(world.scene)):
        name = f"structure/{kind}/{number}"
        scene.add_geometry(gltf_mesh(surface), geom_name=name, node_name=name, parent_node_name=room)
    for object_id in world.ids:
        state = world.state(object_id)
        extras = {"type": world.type_of(object_id)}
        scene.graph.update(object_id, room, matrix=state.matrix(), metadata=extras)
        add_asset(scene, world.assets[object_id], state.openness, object_id, world.most_open(object_id))
    return scene


def add_asset(
    scene: trimesh.Scene, asset: Asset, openness: float, parent: str, most_open: float = 1.0, prefix: str | None = None
) -> None:
    """Hang the links of an asset under a node of a scene; their names begin with that of the node, or with a prefix."""
    start = f"{parent}/" if prefix is None else prefix
    poses = relative_poses(asset, openness)
    for link, pose, origin in zip(asset.links, poses, link_origins(asset), strict=True):
        above = parent if link.joint is None else start + asset.links[link.parent].name
        extras: dict[str, Any] = {}
        if link.joint is not None:
            extras = {
                "joint": link.joint.kind,
                "axis": list(link.joint.axis),
                "range": list(joint_range(link.joint, most_open)),
                "position": link.joint.upper * openness,
            }
        scene.graph.update(start + link.name, above, matrix=pose, metadata=extras)
        for number, surface in enumerate(link.surfaces):
            name = f"{start}{link.name}/{number}"
            mesh = gltf_mesh(surface, origin)
            scene.add_geometry(mesh, geom_name=name, node_name=name, parent_node_name=start + link.name)


def glb_bytes(scene: trimesh.Scene) -> bytes:
    """The scene as a binary glTF file."""
    return bytes(scene.export(file_type="glb"))
