import numpy as np
import pytest
import trimesh

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.errors import UnknownNameError
from remqa_data.generators.figures.asset_meshes import asset_scene, write_meshes


def test_trimesh_reads_back_every_variant_with_its_size_and_links(tmp_path) -> None:
    written = write_meshes(tmp_path, ["Fridge"])
    assert len(written) == variant_count("Fridge")
    assert [path.name for path in written] == [f"Fridge-{variant}.glb" for variant in range(len(written))]
    width, depth, height = typical_size("Fridge")
    for variant, path in enumerate(written):
        scene = trimesh.load(path)
        assert scene.extents == pytest.approx((width, height, depth), abs=1e-4)  # y is up
        links = {link.name for link in build(AssetSpec("Fridge", typical_size("Fridge"), variant, seed=variant)).links}
        assert {name.partition("/")[0] for name in scene.graph.nodes_geometry} == links


def test_an_opened_door_reaches_out_to_the_front() -> None:
    fridge = build(AssetSpec("Fridge", typical_size("Fridge")))
    closed, opened = asset_scene(fridge).bounds, asset_scene(fridge, 1.0).bounds
    assert opened[1, 2] > closed[1, 2] + 0.3  # glTF: the front is at +z


def test_colours_come_through_as_gltf_wants_them() -> None:
    mug = build(AssetSpec("Mug", typical_size("Mug")))
    material = next(iter(asset_scene(mug).geometry.values())).visual.material
    srgb = np.array(mug.links[0].surfaces[0].material.rgb)
    assert mug.links[0].surfaces[0].material.texture is None
    by_the_standard = [((c + 0.055) / 1.055) ** 2.4 if c > 0.04045 else c / 12.92 for c in srgb]  # IEC 61966-2-1
    assert np.array(material.baseColorFactor)[:3] / 255 == pytest.approx(by_the_standard, abs=1 / 255)


def test_an_unknown_type_writes_nothing(tmp_path) -> None:
    with pytest.raises(UnknownNameError, match="Fridge"):
        write_meshes(tmp_path / "glb", ["Mug", "Fridg"])
    assert not (tmp_path / "glb").exists()
