import json
from dataclasses import replace

import cv2
import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from remqa_data.errors import ImageFormatError, SchemaError, UnknownNameError
from remqa_data.mapping.semantic_map import SemanticPlan, SparseVoxels
from remqa_data.tables.images import (
    decode_depth,
    decode_instances,
    decode_rgb,
    encode_depth,
    encode_instances,
    encode_rgb,
)
from remqa_data.tables.map_columns import map_columns, plan_labels, sparse_voxels
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, SceneRow, SemanticMap
from remqa_data.tables.schema import IMAGE_TYPE, TABLES, check_schema, field_docs, table_spec, to_rows, to_table
from tests.helpers.dataset_rows import (
    IDS,
    depth_array,
    expression_row,
    frame_row,
    objects_array,
    question_row,
    rgb_array,
    scene_row,
)

ROWS = {
    "scenes": (SceneRow, [scene_row("K", "train"), scene_row("L", "test", 1)]),
    "frames": (FrameRow, [frame_row("K", "train", i) for i in range(4)]),
    "expressions": (ExpressionRow, [expression_row("K", "val", i) for i in range(3)]),
    "questions": (QuestionRow, [question_row("K", "train", i) for i in range(4)]),
}


@pytest.mark.parametrize("name", ROWS)
def test_rows_survive_a_round_trip(name: str) -> None:
    row_type, rows = ROWS[name]
    assert to_rows(row_type, to_table(row_type, rows)) == rows


@pytest.mark.parametrize("name", ROWS)
def test_rows_of_a_slice_are_those_rows(name: str) -> None:
    row_type, rows = ROWS[name]
    assert to_rows(row_type, to_table(row_type, rows).slice(1)) == rows[1:]


@pytest.mark.parametrize("name", ROWS)
def test_no_rows_make_an_empty_table(name: str) -> None:
    row_type, _ = ROWS[name]
    table = to_table(row_type, [])
    assert table.num_rows == 0
    assert to_rows(row_type, table) == []


def test_the_columns_of_the_design_are_there() -> None:
    # docs/ARCHITECTURE.md and the list, written out here by hand.
    expected = {
        "scenes": "scene room_type split configuration seed scene_json objects graph_nodes graph_edges semantic_map map_2d "
        "navigation_cells walk_start_cell embodiment",
        "frames": "frame_id scene configuration split index rgb depth instances agent objects added_nodes added_edges",
        "expressions": "expression_id scene configuration split frame_id text kind target_id target_type anchor_id relation "
        "box_2d program",
        "questions": "question_id kind question expression answer program scene room_type configuration split group "
        "initial_pose goal_poses target_id target_type start_target_box_2d answer_type answer_ids manipulation "
        "manipulation_object_id path_length_m path_steps actions start_rgb start_depth start_instances "
        "end_rgb end_depth end_instances object_ids",
    }
    assert {name: spec.schema.names for name, spec in TABLES.items()} == {k: v.split() for k, v in expected.items()}


def test_start_and_end_in_a_name_mean_the_views_before_and_after_the_manipulation_and_nothing_else() -> None:
    told = {doc.path: doc.description for spec in TABLES.values() for doc in field_docs(spec.schema)}
    for when in ("start", "end"):
        named = {path for path in told if when in path.partition(".")[0].split("_") and not path.startswith("walk_")}
        assert f"{when}_rgb" in named
        assert named == {path for path, text in told.items() if f"I_{when}" in text and path.startswith(f"{when}_")}


def test_types_that_other_readers_rely_on() -> None:
    frames = TABLES["frames"].schema
    assert frames.field("rgb").type == pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    scenes = TABLES["scenes"].schema
    assert scenes.field("scene_json").type == pa.large_string()
    voxels = scenes.field("semantic_map").type.field("voxels").type.value_type
    assert {field.name: str(field.type) for field in voxels} == dict.fromkeys(("x", "y", "z", "label"), "int16")


@pytest.mark.parametrize("spec", TABLES.values(), ids=lambda spec: spec.name)
def test_every_field_is_documented(spec) -> None:
    docs = field_docs(spec.schema)
    assert {doc.path.split(".")[0].removesuffix("[]") for doc in docs} == set(spec.schema.names)
    assert [doc.path for doc in docs if not doc.description.endswith(".")] == []


def test_lengths_are_in_metres() -> None:
    lengths = [doc for spec in TABLES.values() for doc in field_docs(spec.schema) if doc.path.endswith("_m")]
    assert {doc.unit for doc in lengths} == {"m"}


@pytest.mark.parametrize("spec", TABLES.values(), ids=lambda spec: spec.name)
def test_hugging_face_features_describe_the_arrow_types(spec) -> None:
    """Rebuild Arrow types from the features as `datasets.Features` does, and compare; datasets 5.2 was tried by hand."""

    def arrow(feature):
        if isinstance(feature, list):
            return pa.list_(arrow(feature[0]))
        if feature.get("_type") == "Image":
            return IMAGE_TYPE
        if feature.get("_type") == "Value":
            return pa.type_for_alias(feature["dtype"])
        return pa.struct([(name, arrow(inner)) for name, inner in feature.items()])

    features = json.loads(spec.schema.metadata[b"huggingface"])["info"]["features"]
    assert {name: arrow(feature) for name, feature in features.items()} == {f.name: f.type for f in spec.schema}
    assert all(field.nullable for field in spec.schema)  # Hugging Face ignores features of others
    images = [name for name, feature in features.items() if feature == {"_type": "Image"}]
    assert images == list(spec.image_columns)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"question": None}, r"questions: row 1: question: None"),
        ({"kind": "EXIST"}, r"row 1: kind: 'EXIST' is none of EXISTENCE, COUNTING, SPATIAL"),
        ({"path_length_m": float("nan")}, r"row 1: path_length_m: .*not finite"),
        ({"path_steps": 2.5}, r"row 1: path_steps: expected a whole number, not 2\.5"),
        ({"start_target_box_2d": (1, 2, 3)}, r"row 1: start_target_box_2d: expected 4 values, not 3"),
        ({"actions": "MoveAhead"}, r"row 1: actions: expected a tuple"),
        ({"actions": ("MoveAhead", None)}, r"row 1: actions: None in a list"),
        ({"start_rgb": b"bytes"}, r"row 1: start_rgb: expected StoredImage, not bytes"),
        (
            {"initial_pose": replace(question_row("K", "train", 0).initial_pose, yaw_deg="east")},
            r"row 1: initial_pose\.yaw_deg: ",
        ),
    ],
)
def test_a_row_that_does_not_fit_is_named(change, message: str) -> None:
    rows = [question_row("K", "train", 0), replace(question_row("K", "train", 1), **change)]
    with pytest.raises(SchemaError, match=message):
        to_table(QuestionRow, rows)


@pytest.mark.parametrize("voxels", [np.zeros((2, 3), np.int16), np.zeros((2, 4), np.int32), [(1, 2, 3, 4)]])
def test_voxels_must_be_four_columns_of_int16(voxels) -> None:
    row = scene_row("K", "train")
    wrong = replace(row, semantic_map=replace(row.semantic_map, voxels=voxels))
    with pytest.raises(SchemaError, match=r"scenes: row 0: semantic_map\.voxels: expected"):
        to_table(SceneRow, [wrong])


def test_plain_pairs_count_as_cells() -> None:
    row = replace(scene_row("K", "train"), navigation_cells=((4, 5),), walk_start_cell=(4, 5))
    assert to_rows(SceneRow, to_table(SceneRow, [row]))[0].walk_start_cell.j == 5


def test_a_foreign_schema_is_refused() -> None:
    table = to_table(*ROWS["expressions"])
    with pytest.raises(SchemaError, match="column text is missing"):
        check_schema("expressions", table.drop_columns(["text"]).schema)
    with pytest.raises(SchemaError, match="column configuration is string"):
        check_schema("expressions", table.set_column(2, "configuration", [["a"] * 3]).schema)
    with pytest.raises(SchemaError, match="unknown column more"):
        check_schema("expressions", table.append_column("more", [[1] * 3]).schema)
    with pytest.raises(UnknownNameError, match="questions"):
        table_spec("question")


def test_pandas_reads_a_table_without_our_code() -> None:
    frame = to_table(*ROWS["questions"]).to_pandas()
    assert frame["answer"].tolist() == ["yes", "2", "no", "yes"]
    assert frame["initial_pose"][0]["yaw_deg"] == 90.0 * 0
    assert frame["start_target_box_2d"][0] is None
    assert frame["start_target_box_2d"][1].tolist() == [8, 4, 20, 16]


# ---- images


def test_png_keeps_every_bit_of_rgb_and_jpeg_comes_close() -> None:
    rgb = rgb_array(3)
    assert np.array_equal(decode_rgb(encode_rgb(rgb, form="png").bytes), rgb)
    assert np.abs(decode_rgb(encode_rgb(rgb).bytes).astype(int) - rgb).mean() < 3


def test_red_is_red_for_other_readers() -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 0] = 250
    for form in ("jpeg", "png"):
        stored = np.frombuffer(encode_rgb(red, form=form).bytes, np.uint8)
        blue_green_red = cv2.imdecode(stored, cv2.IMREAD_COLOR)[8, 8].astype(int)
        assert np.abs(blue_green_red - [0, 0, 250]).max() <= 3


def test_an_image_has_a_file_name_with_its_suffix() -> None:
    rgb = rgb_array(0)
    assert encode_rgb(rgb, "frame").path == "frame.jpg"
    assert encode_rgb(rgb, "frame", form="png").path == "frame.png"
    assert encode_rgb(rgb).path is None


@given(hnp.arrays(np.float32, (3, 5), elements=st.floats(0, 65.5, width=32)))
def test_depth_is_kept_to_half_a_millimetre(depth: np.ndarray) -> None:
    assert np.abs(decode_depth(encode_depth(depth).bytes) - depth).max() <= 0.0005 + 1e-5


def test_depth_is_millimetres_for_other_readers_and_nothing_is_zero() -> None:
    depth = np.array([[1.2344, 0.0, np.nan], [np.inf, 99.0, 65.535]], np.float32)
    stored = cv2.imdecode(np.frombuffer(encode_depth(depth).bytes, np.uint8), cv2.IMREAD_UNCHANGED)
    assert stored.dtype == np.uint16
    assert stored.tolist() == [[1234, 0, 0], [0, 65535, 65535]]


def test_instances_are_places_in_the_rows_list() -> None:
    objects = np.array([[-1, 0, 1], [2, 2, 0]])
    numbers = decode_instances(encode_instances(objects, IDS, ("Floor|1", "Mug|1")).bytes)
    # Mug is second in the row's list, the table is not in it, Floor is first; -1 is no object.
    assert numbers.tolist() == [[0, 2, 0], [1, 1, 2]]


def test_equal_arrays_give_equal_bytes() -> None:
    assert encode_rgb(rgb_array(1)) == encode_rgb(rgb_array(1))
    assert encode_depth(depth_array(1)) == encode_depth(depth_array(1))
    assert encode_instances(objects_array(), IDS, IDS) == encode_instances(objects_array(), IDS, IDS)


@pytest.mark.parametrize("data", [b"", b"no image", encode_depth(depth_array(0)).bytes[:40]])
def test_bytes_that_are_no_image_are_refused(data: bytes) -> None:
    with pytest.raises(ImageFormatError, match=f"^{len(data)} bytes"):
        decode_rgb(data)


def test_an_8_bit_image_is_no_depth() -> None:
    data = cv2.imencode(".png", np.zeros((4, 4), np.uint8))[1].tobytes()
    with pytest.raises(ImageFormatError, match="16-bit"):
        decode_depth(data)


@pytest.mark.parametrize(
    "encode",
    [
        lambda: encode_rgb(np.zeros((4, 4), np.uint8)),
        lambda: encode_rgb(np.zeros((4, 4, 3), np.float32)),
        lambda: encode_depth(np.zeros((4, 4), np.uint16)),
        lambda: encode_instances(np.zeros((4, 4, 1), np.int32), IDS, IDS),
    ],
)
def test_arrays_of_another_kind_are_refused(encode) -> None:
    with pytest.raises(ImageFormatError, match="image is"):
        encode()


def test_the_map_comes_back_from_a_scene_row() -> None:
    voxels = SparseVoxels(
        np.array([[-2, 5, 0], [-1, 6, 3]], np.int16), np.array([1, 0], np.int16), ("structure", "Mug")
    )
    labels = np.array([[1, -1, -1], [-1, 0, -1]], np.int16)  # (nx, ny) = (2, 3)
    flags = np.zeros((2, 3), bool)
    plan = SemanticPlan(labels, flags, flags, (-2, 5), 0.05, -0.1, ("structure", "Mug"))
    stored, map_2d = map_columns(voxels, plan)
    # Worked out by hand: image up is +y, so the mug, at the lowest x and y, is in the lower left corner.
    assert decode_instances(map_2d.bytes).tolist() == [[0, 0], [0, 1], [2, 0]]
    assert stored == SemanticMap(
        (0.0, 0.0, -0.1),
        0.05,
        (-2, 5),
        ("structure", "Mug"),
        np.array([[-2, 5, 0, 1], [-1, 6, 3, 0]], np.int16),
    )
    assert np.array_equal(plan_labels(map_2d), labels)
    assert np.array_equal(sparse_voxels(stored).coordinates, voxels.coordinates)
    assert np.array_equal(sparse_voxels(stored).labels, voxels.labels)
