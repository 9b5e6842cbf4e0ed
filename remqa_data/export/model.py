"""A room as a robot format sees it: bodies with frames, joints, masses and boxes, and meshes in files beside it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from remqa_data.assets.core.fitting import vec
from remqa_data.assets.core.model import AssetSpec, CollisionBox, Joint, Material, Surface
from remqa_data.export.fronts import is_two_sided, outward
from remqa_data.export.links import Inertia, holding_friction, inertias, joint_range, link_origins
from remqa_data.export.looks import texture_png, upward_uv
from remqa_data.geometry.types import F32, F64, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.scene_arrays import structure_groups


@dataclass(frozen=True)
class Visual:
    """A mesh that is seen: `mesh` is the name of a file without its suffix, `material` one of the room's materials."""

    mesh: str
    material: str


@dataclass(frozen=True)
class ModelJoint:
    """What lets a link move.

    Attributes
    ----------
    joint : Joint
        Its axis is one of the object's own frame.
    limits : (float, float)
        Least and greatest position, radians or metres.
    position : float
        Where it stands.
    friction : float
        With which it stays where it is left, N or N m.
    """

    joint: Joint
    limits: tuple[float, float]
    position: float
    friction: float


@dataclass(frozen=True)
class ModelLink:
    """A rigid part; its frame lies on its joint, turned as the object is while closed.

    Attributes
    ----------
    name : str
        Unique in the room: the object's id for its base, else ID/LINK.
    parent : int
        Which of the object's links it hangs on; -1 for the base.
    origin : Vec3
        Of its frame, metres, in that of its parent; of the base, in the object's.
    """

    name: str
    parent: int
    origin: Vec3
    joint: ModelJoint | None
    inertia: Inertia
    visuals: tuple[Visual, ...]
    boxes: tuple[CollisionBox, ...]


@dataclass(frozen=True)
class ModelObject:
    """One object: its pose in the room, whether physics moves it, and its links, the base first."""

    id: str
    position: Vec3
    quaternion: Quaternion
    is_free: bool
    links: tuple[ModelLink, ...]


@dataclass(frozen=True)
class RoomModel:
    """A room; its meshes, `surfaces` by name, and textures are `files` in the folder `meshes`, beside the room's own file.

    Surfaces whose names are `two_sided` are to be seen from behind, too.
    """

    name: str
    meshes: str
    files: dict[str, bytes]
    surfaces: dict[str, Surface]
    two_sided: frozenset[str]
    lights: tuple[Vec3, ...]
    materials: dict[str, Material]
    visuals: tuple[Visual, ...]
    boxes: tuple[CollisionBox, ...]
    objects: tuple[ModelObject, ...]

    def mesh_names(self) -> list[str]:
        """Every mesh once."""
        links = (link for thing in self.objects for link in thing.links)
        visuals = [*self.visuals, *(visual for link in links for visual in link.visuals)]
        return list(dict.fromkeys(visual.mesh for visual in visuals))


def room_model(world: World, meshes: str) -> RoomModel:
    """A room as it stands; its meshes (OBJ, with one MTL for all) and textures (PNG) are to lie in a folder of that name."""
    files = _MeshFiles()
    building = [
        files.visual(f"structure-{number}", surface)
        for number, (_, surface) in enumerate(structure_groups(world.scene))
    ]
    objects = tuple(_object(world, object_id, files) for object_id in world.ids)
    files.add_materials()
    return RoomModel(
        name=world.scene.name,
        meshes=meshes,
        files=files.made,
        surfaces=files.surfaces,
        two_sided=frozenset(files.two_sided),
        lights=world.scene.lights,
        materials=files.materials,
        visuals=tuple(building),
        boxes=tuple(_box(part.box) for part in world.scene.structure if part.kind != "outside"),
        objects=objects,
    )


def _object(world: World, object_id: str, files: _MeshFiles) -> ModelObject:
    asset, state, pose = world.assets[object_id], world.state(object_id), world.state(object_id).matrix()
    origins, stem = link_origins(asset), files.stem(asset.spec)
    links = []
    for number, (link, inertia) in enumerate(zip(asset.links, inertias(asset), strict=True)):
        joint = None
        if link.joint is not None:
            limits = joint_range(link.joint, world.most_open(object_id))
            friction = holding_friction(link.joint, inertia, pose[:3, :3])
            joint = ModelJoint(link.joint, limits, link.joint.upper * state.openness, friction)
        links.append(
            ModelLink(
                name=object_id if link.joint is None else f"{object_id}/{link.name}",
                parent=-1 if link.joint is None else link.parent,
                origin=vec(origins[number] - (0.0 if link.joint is None else origins[link.parent])),
                joint=joint,
                inertia=inertia,
                visuals=tuple(
                    files.visual(f"{stem}-{link.name}-{k}", surface, origins[number])
                    for k, surface in enumerate(link.surfaces)
                ),
                boxes=tuple(
                    CollisionBox(vec(box.centre - origins[number]), box.size, box.quaternion) for box in link.boxes
                ),
            )
        )
    return ModelObject(object_id, state.position, state.quaternion, not state.is_fixed, tuple(links))


class _MeshFiles:
    """Makes each mesh and texture once, and gives materials their names.

    Attributes
    ----------
    materials : dict
        By name.
    surfaces : dict
        Meshes by name, their points counted from where they are in the file.
    two_sided : set
        Names of meshes.
    made : dict
        What the files hold, by their names.
    """

    def __init__(self) -> None:
        self.materials: dict[str, Material] = {}
        self.surfaces: dict[str, Surface] = {}
        self.two_sided: set[str] = set()
        self.made: dict[str, bytes] = {}
        self._names: dict[Material, str] = {}
        self._stems: dict[AssetSpec, str] = {}

    def stem(self, spec: AssetSpec) -> str:
        """What the meshes of an asset begin with; equal assets share theirs."""
        same_type = sum(other.type == spec.type for other in self._stems)
        return self._stems.setdefault(spec, f"{spec.type}-{same_type}")

    def visual(self, mesh: str, surface: Surface, origin: F64 | None = None) -> Visual:
        """A surface, its points counted from a (3,) origin."""
        if surface.material not in self._names:
            self._name(surface.material)
        material = self._names[surface.material]
        if mesh not in self.surfaces:
            if is_two_sided(surface):
                self.two_sided.add(mesh)
            surface = outward(surface)
            points = surface.vertices if origin is None else surface.vertices - origin
            self.surfaces[mesh] = replace(surface, vertices=np.asarray(points, dtype=np.float32))
            self.made[f"{mesh}.obj"] = _text(_obj_lines(surface, points, material))
        return Visual(mesh, material)

    def add_materials(self) -> None:
        """Make what the meshes say of their materials."""
        self.made["materials.mtl"] = _text(line for item in self.materials.items() for line in _mtl_lines(*item))

    def _name(self, material: Material) -> None:
        name = f"{material.color}-{material.substance}-{len(self._names)}"
        self._names[material], self.materials[name] = name, material
        if material.texture is not None:
            self.made[f"{material.texture}.png"] = texture_png(material.texture)


def _text(lines: Iterable[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()


def _obj_lines(surface: Surface, points: F32 | F64, material: str) -> Iterator[str]:
    yield "mtllib materials.mtl"
    yield from _numbers("v", points)
    yield from _numbers("vt", upward_uv(surface))
    yield from _numbers("vn", surface.normals)
    yield f"usemtl {material}"
    for a, b, c in (surface.faces + 1).tolist():
        yield f"f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}"


def _numbers(word: str, rows: F32 | F64) -> Iterator[str]:
    for row in np.asarray(rows, dtype=np.float64).tolist():
        yield " ".join([word, *(f"{number:.7g}" for number in row)])


def _mtl_lines(name: str, material: Material) -> Iterator[str]:
    yield f"newmtl {name}"
    for word, share in (("Kd", 1.0), ("Ke", material.glow)):
        yield " ".join([word, *(f"{channel * share:.4g}" for channel in material.rgb)])
    yield f"Ks {material.gloss:.4g} {material.gloss:.4g} {material.gloss:.4g}"
    if material.texture is not None:
        yield f"map_Kd {material.texture}.png"


def _box(box: Sequence[float]) -> CollisionBox:
    low, high = np.asarray(box[:3]), np.asarray(box[3:])
    return CollisionBox(vec((low + high) / 2), vec(high - low))
