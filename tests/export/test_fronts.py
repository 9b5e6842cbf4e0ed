"""Fronts face outward in what leaves for other programs, and only what was wound wrongly is turned."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from remqa_data.assets import TYPES, variant_count
from remqa_data.assets.core.model import Surface
from remqa_data.export.fronts import is_two_sided, outward
from remqa_data.generators.figures.asset_meshes import asset_scene
from remqa_data.sim.render.scene_arrays import solid_faces
from tests.helpers.meshes import box, from_trimesh, quad
from tests.helpers.typical_assets import typical


def changed(surface: Surface) -> int:
    """How many of its faces leave wound the other way."""
    return int((outward(surface).faces != surface.faces).any(axis=1).sum())


def test_only_the_closed_piece_that_is_inside_out_is_turned() -> None:
    inside_out = trimesh.creation.box().apply_translation((3, 0, 0))
    inside_out.invert()
    both = from_trimesh(trimesh.util.concatenate([trimesh.creation.box(), inside_out]))
    mended = outward(both)
    assert changed(both) == 12
    np.testing.assert_array_equal(mended.faces[:12], both.faces[:12])
    assert solid_faces(mended).all()
    assert np.array_equal(mended.normals, np.concatenate([both.normals[:36], -both.normals[36:]]))


def test_an_open_face_is_wound_as_its_normals_say_and_a_solid_stays_itself() -> None:
    sheet = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
    against = replace(sheet, faces=sheet.faces[:, ::-1])
    assert outward(against).faces.tolist() == sheet.faces.tolist()
    assert np.array_equal(outward(against).normals, sheet.normals)
    assert changed(sheet) == 0
    assert is_two_sided(sheet)
    cube = box()
    assert outward(cube) is cube
    assert not is_two_sided(cube)


def test_what_is_seen_of_a_curtain_from_outside_is_its_front() -> None:
    folds = [mesh for name, mesh in asset_scene(typical("ShowerCurtain")).geometry.items() if name.startswith("fold")]
    assert len(folds) == 8
    assert all(mesh.volume > 0 for mesh in folds)
    for mesh in folds:
        towards = np.random.default_rng(0).normal(size=(200, 3))
        met = mesh.ray.intersects_first(mesh.bounds.mean(axis=0) - 9 * towards, towards)
        assert (met >= 0).sum() > 20
        seen = met >= 0
        assert (np.einsum("rk,rk->r", mesh.face_normals[met[seen]], towards[seen]) < 0).all()
        assert (np.einsum("fk,fk->f", mesh.vertex_normals[mesh.faces].mean(axis=1), mesh.face_normals) > 0).all()


def test_open_sheets_are_two_sided_materials_in_gltf() -> None:
    sheets, solid = (asset_scene(typical(*of)).geometry.values() for of in (("HousePlant", 2, 2), ("Bowl", 1, 1)))
    assert {mesh.visual.material.doubleSided for mesh in sheets} == {True}
    assert solid
    assert not any(mesh.visual.material.doubleSided for mesh in solid)


@pytest.mark.slow
def test_curtains_and_ferns_are_all_that_is_turned_and_nothing_stays_inside_out() -> None:
    turned = {}
    for type_ in TYPES:
        for variant in range(variant_count(type_)):
            links = typical(type_, variant, seed=variant).links
            for surface in (surface for link in links for surface in link.surfaces):
                if count := changed(surface):
                    turned[type_, variant] = turned.get((type_, variant), 0) + count
                mended = outward(surface)
                assert not solid_faces(replace(mended, faces=mended.faces[:, ::-1])).any()
    cloth = dict.fromkeys((("ShowerCurtain", variant) for variant in range(4)), 1024)
    assert turned == cloth | {("ShowerCurtain", 2): 1424, ("HousePlant", 2): 792}
