"""A room found by its name, opened as asked, and written as a file for other programs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import ElementTree, indent

from remqa_data.errors import ConfigError, DatasetError, OutputError, UnknownNameError
from remqa_data.export import Format
from remqa_data.export.glb import glb_bytes, room_scene
from remqa_data.export.mjcf import mjcf
from remqa_data.export.model import RoomModel, room_model
from remqa_data.export.urdf import urdf
from remqa_data.extras import require
from remqa_data.files import atomic_folder, atomic_path, walk
from remqa_data.floorplans.load import load_scene
from remqa_data.scene import Scene
from remqa_data.sim.physics.world import World
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows, read_table
from remqa_data.tables.rows import SceneRow, configuration_name

FORMATS: dict[str, Format] = {
    ".glb": "glb",
    ".xml": "mjcf",
    ".urdf": "urdf",
    ".usd": "usd",
    ".usda": "usd",
    ".usdc": "usd",
}
"""By the suffix of a file, in small letters."""
BINARY_USD = ".usdc"
MESH_SUFFIXES = (".obj", ".mtl", ".png")
ALL = "all"


def find_scene(name: str, data: Path | None = None, configuration: int = 0, seed: int = 0) -> Scene:
    """A room as it stands: of a dataset if one is given, else of a file of `Scene.save`, or a floor plan or sampled room.

    The seed is that of a sampled room.

    Raises
    ------
    UnknownNameError
        If there is no such room; names the nearest.
    ConfigError
        If a configuration is asked for, but no dataset is given; or a seed, but of what is no sampled room.
    DatasetError
        If the dataset's room has no such configuration, or it several times, or it is no finished dataset.
    SceneFormatError
        If the file is not a scene.
    """
    if data is None:
        if configuration:
            raise ConfigError(
                f"--configuration {configuration}: only rooms of a dataset have several; name it with --data DIR"
            )
        if name.endswith(".json") and not seed:
            return Scene.load(name)
        return _at_rest(load_scene(name, seed=seed))
    if seed:
        raise ConfigError(f"--seed {seed}: {data} says itself of which seed it is")
    known: dict[str, list[int]] = {}
    for split in load_manifest(data).splits("scenes"):
        for row in read_table(data, "scenes", split, ["scene", "configuration"]).to_pylist():
            known.setdefault(row["scene"], []).append(row["configuration"])
        if configuration in known.get(name, []):
            room, *others = read_rows(data, SceneRow, split, scene=name, configuration=configuration)
            if others:
                place = configuration_name(name, configuration)
                raise DatasetError(f"{data}: {place}, is there {1 + len(others)} times")
            return Scene.from_json(room.scene_json, f"{data}: {name}")
    if name not in known:
        raise UnknownNameError("room", name, known)
    there = ", ".join(map(str, sorted(known[name])))
    raise DatasetError(f"{data}: {name} has no configuration {configuration}; it has: {there}")


def write_room(scene: Scene, path: Path, form: Format | None = None, opened: Iterable[str] = ()) -> list[Path]:
    """Write a room; returns the files, the meshes and textures first, which lie beside it in the folder FILE-meshes.

    Parameters
    ----------
    scene : Scene
        The room.
    path : Path
        The file; its suffix, in large or small letters, tells the format.
    form : {"glb", "mjcf", "urdf", "usd"}, optional
        The format, whatever the suffix; USD is binary under one that is not its own.
    opened : iterable of str
        Ids of objects to open as far as they go, with what lies in them; "all" for all that open.

    Raises
    ------
    OutputError
        If the suffix is not known, the file cannot be written there, or FILE-meshes holds what is no mesh or texture.
    ConfigError
        If something is to be open in URDF, which cannot say so.
    MissingExtraError
        If it is to be USD, and the extra `usd` is not installed.
    UnknownNameError, ActionError
        If an object is not there, or does not open.
    """
    form = form or FORMATS.get(path.suffix.lower())
    if form is None or form not in FORMATS.values():
        raise OutputError(f"{path}: give a name that ends with {', '.join(FORMATS)}, or --format")
    if form == "usd":
        require("pxr", "usd")  # before a room is made
    opened = list(opened)
    if opened and form == "urdf":
        raise ConfigError(
            "--open: URDF holds no joint positions; set the joints where it is loaded, or write .xml or .glb"
        )
    folder = path.with_name(f"{path.name}-meshes")
    if form != "glb":
        _check_meshes(folder)
    with World(scene) as world:
        named = [object_id for object_id in opened if object_id != ALL]
        for object_id in dict.fromkeys(named + (_openable(world) if ALL in opened else [])):
            world.open(object_id)
        if form == "glb":
            with atomic_path(path) as temporary:
                temporary.write_bytes(glb_bytes(room_scene(world)))
            return [path]
        room = room_model(world, folder.name)
    with atomic_path(path) as temporary, atomic_folder(folder) as meshes:
        for name, data in room.files.items():
            (meshes / name).write_bytes(data)
        _write(room, form, temporary)
    return [*(folder / name for name in room.files), path]


def _openable(world: World) -> list[str]:
    return [object_id for object_id in world.ids if world.assets[object_id].is_openable]


def _at_rest(scene: Scene) -> Scene:
    """A floor plan's things as they come to rest, as pictures of it show them."""
    with World(scene) as world:
        world.settle()
        return world.to_scene()


def _check_meshes(folder: Path) -> None:
    """Refuse to replace a folder that is another's."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise OutputError(f"{folder} is no folder; the meshes are to lie there: remove it, or give another name")
    for path, kind in walk(folder):
        if kind != "file" or path.parent != folder or path.suffix not in MESH_SUFFIXES:
            raise OutputError(
                f"{path} is no mesh or texture, and {folder} is replaced as a whole: move it, or give another name"
            )


def _write(room: RoomModel, form: Format, path: Path) -> None:
    if form == "usd":
        from remqa_data.export.usd import write_usd

        suffix = path.suffix.lower()
        write_usd(room, path, suffix if FORMATS.get(suffix) == form else BINARY_USD)
        return
    root = mjcf(room) if form == "mjcf" else urdf(room)
    indent(root)
    ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
