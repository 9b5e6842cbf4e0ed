import json
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
import torch
from torch.utils.data import DataLoader

from remqa_data.datasets.random_access import SplitReader
from remqa_data.datasets.sample_types import ExpressionSample, FrameSample, QuestionSample
from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset, collate
from remqa_data.errors import ConfigError, DamagedShardError, DatasetError, UnknownNameError
from remqa_data.storage.manifest import MANIFEST, load_manifest
from remqa_data.storage.shards import file_info
from remqa_data.tables.images import decode_rgb, encode_rgb
from tests.helpers.dataset_rows import HEIGHT, MUG_BOX_2D, WIDTH, depth_array, objects_array, rgb_array, write_dataset

IMAGES = ("start_rgb", "start_depth", "start_instances", "end_rgb", "end_depth", "end_instances")


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("dataset")
    write_dataset(path)
    return path


def only_answer(sample: QuestionSample) -> str:
    """A transform that spawned workers can import."""
    return sample["answer"]


# ---- samples


@pytest.mark.parametrize(
    ("kind", "sample_type"),
    [(RemqaDataset, QuestionSample), (FrameDataset, FrameSample), (ExpressionDataset, ExpressionSample)],
)
def test_a_sample_has_the_documented_keys(root, kind, sample_type) -> None:
    sample = kind(root, "train", images=None)[0]
    assert set(sample) == set(sample_type.__annotations__)


def test_a_question_is_what_was_stored(root) -> None:
    sample = RemqaDataset(root, "train")[13]  # question 3 of the second scene
    assert sample["question_id"] == "Kitchen2-q3"
    assert (sample["kind"], sample["answer"], sample["configuration"]) == ("EXISTENCE", "yes", 3)
    assert json.loads(sample["program"]) == [["exists", "Mug"]]
    assert sample["actions"] == ["MoveAhead", "RotateLeft", "OpenObject"]
    assert sample["path_length_m"] == 1.75
    assert sample["initial_pose"].tolist() == [0.0, -0.5, 0.0, 0.0, 30.0]
    assert sample["goal_poses"].tolist() == [[0.25, -0.5, 0.0, 90.0, 30.0], [0.5, -0.5, 0.0, 180.0, 30.0]]
    assert sample["start_target_box_2d"].tolist() == list(MUG_BOX_2D)


def test_a_box_that_is_not_there_is_minus_one(root) -> None:
    dataset = RemqaDataset(root, "train", images=())
    assert dataset[0]["start_target_box_2d"].tolist() == [-1] * 4
    assert dataset[1]["start_target_box_2d"].tolist() == list(MUG_BOX_2D)


def test_images_have_the_documented_shapes_dtypes_and_values(root) -> None:
    sample = RemqaDataset(root, "train")[2]
    for name in IMAGES:
        assert sample[name].shape[-2:] == (HEIGHT, WIDTH)
    assert sample["start_rgb"].shape == (3, HEIGHT, WIDTH)
    assert [sample[f"start_{name}"].dtype for name in ("rgb", "depth", "instances")] == [
        torch.uint8,
        torch.float32,
        torch.int32,
    ]
    # The arrays that the rows were made from: question 2 starts with image 2 and ends with image 3.
    for name, seed in (("start", 2), ("end", 3)):
        picture = sample[f"{name}_rgb"].permute(1, 2, 0).numpy().astype(int)
        assert np.abs(picture - rgb_array(seed)).mean() < 3
        assert np.abs(sample[f"{name}_depth"].numpy() - depth_array(seed)).max() < 0.0006
        assert np.array_equal(sample[f"{name}_instances"].numpy(), objects_array() + 1)


def test_a_frame_lists_its_objects_in_parallel(root) -> None:
    dataset = FrameDataset(root, "train")
    sample = dataset[22]  # frame 1 of the second scene
    assert sample["frame_id"] == "Kitchen2-0-1"
    assert sample["object_ids"] == ["Mug|1", "Table|1"]
    assert sample["object_types"] == ["Mug", "Table"]
    assert sample["boxes_2d"].tolist() == [list(MUG_BOX_2D)] * 2
    assert sample["boxes_3d"].shape == (2, 6)
    assert sample["boxes_3d"][0, 2].item() == pytest.approx(0.7)
    assert sample["pixels"].tolist() == [144, 144]
    assert sample["distances_m"].tolist() == [1.25, 1.25]
    assert sample["added_edges"] == [
        {"source": "Mug|1", "target": "Table|1", "relation": "on", "distance_m": 0.5, "iou": 0.125}
    ]
    ys, xs = np.nonzero(sample["instances"].numpy() == 1)
    assert (xs.min(), ys.min(), xs.max() + 1, ys.max() + 1) == MUG_BOX_2D
    empty = dataset[3]  # a frame that shows no object
    assert empty["object_ids"] == []
    assert empty["boxes_2d"].shape == (0, 4)
    assert empty["boxes_3d"].shape == (0, 6)


def test_an_expression_comes_with_its_frame_whatever_the_frames_split(root) -> None:
    dataset = ExpressionDataset(root, "val")
    sample = dataset[1]
    assert (sample["scene"], sample["text"], sample["anchor_id"]) == ("Kitchen2", "the mug on the table", "Table|1")
    assert dataset[0]["anchor_id"] is None
    frames = FrameDataset(root, "train", images=("rgb",))
    same = next(frame for frame in frames if frame["frame_id"] == sample["frame_id"])
    assert torch.equal(sample["rgb"], same["rgb"])
    assert "depth" not in sample


def test_every_row_of_every_row_group_is_reached_in_any_order(root) -> None:
    dataset = FrameDataset(root, "train", columns=["frame_id", "index"], images=["rgb"])
    assert len(dataset) == 42
    for place in np.random.default_rng(0).permutation(42):
        sample = dataset[int(place)]
        assert sample["frame_id"] == f"Kitchen{place // 21 + 1}-0-{place % 21}"
        expected = decode_rgb(encode_rgb(rgb_array(sample["index"])).bytes)
        assert np.array_equal(sample["rgb"].permute(1, 2, 0).numpy(), expected)


def test_an_image_is_the_same_when_it_is_read_again(root) -> None:
    dataset = RemqaDataset(root, "train", columns=())
    first = [dataset[i] for i in range(len(dataset))]
    assert len(first) > 1
    for i in reversed(range(len(dataset))):
        again = dataset[i]
        assert all(torch.equal(first[i][name], again[name]) for name in IMAGES)


def test_images_that_another_writer_has_compressed_are_read_too(root, tmp_path) -> None:
    import shutil

    import pyarrow.parquet as pq

    shutil.copytree(root, tmp_path / "again")
    for path in (tmp_path / "again" / "frames").iterdir():
        pq.write_table(pq.read_table(path), path, compression="zstd", row_group_size=4)
    manifest = load_manifest(tmp_path / "again")
    files = [file_info(tmp_path / "again" / file.path, file.path, file.table, file.split) for file in manifest.files]
    (tmp_path / "again" / MANIFEST).write_text(replace(manifest, files=tuple(files)).to_json())
    ours, theirs = (FrameDataset(folder, "train") for folder in (root, tmp_path / "again"))
    for i in (0, 5, 5, 30):
        assert torch.equal(ours[i]["rgb"], theirs[i]["rgb"])
        assert torch.equal(ours[i]["depth"], theirs[i]["depth"])


@pytest.mark.parametrize("kind", [RemqaDataset, FrameDataset, ExpressionDataset])
def test_columns_in_several_pieces_lose_no_row(root, kind, monkeypatch) -> None:
    """As those of more than 2 GB of text come."""
    whole = [str(sample) for sample in kind(root, "train", images=())]
    read = SplitReader.columns

    def in_pieces(reader: SplitReader, names: list[str]) -> pa.Table:
        table = read(reader, names).combine_chunks()
        return pa.concat_tables([table.slice(first, 3) for first in range(0, table.num_rows, 3)])

    monkeypatch.setattr(SplitReader, "columns", in_pieces)
    assert [str(sample) for sample in kind(root, "train", images=())] == whole


def test_an_index_error_inside_is_not_the_end_of_the_data(root) -> None:
    def transform(sample: QuestionSample) -> str:
        return sample["actions"][99]

    with pytest.raises(IndexError, match="out of range"):
        list(RemqaDataset(root, "train", transform=transform, images=()))


def test_indices_are_those_of_a_sequence(root) -> None:
    dataset = RemqaDataset(root, "test", images=())
    assert dataset[-1]["question_id"] == "Kitchen3-q9"
    assert dataset[np.int64(9)]["question_id"] == dataset[torch.tensor(9)]["question_id"] == "Kitchen3-q9"
    with pytest.raises(IndexError, match="sample 10 of 10"):
        dataset[10]
    assert len(list(dataset)) == 10


@pytest.mark.parametrize("index", [slice(2), [0, 1], "Kitchen3-q9", 1.0, None])
def test_what_is_no_index_is_told_with_what_takes_several(root, index) -> None:
    with pytest.raises(TypeError, match=r"give one whole number; torch\.utils\.data\.Subset takes several"):
        RemqaDataset(root, "test", images=())[index]


# ---- choosing


@pytest.mark.parametrize(("kind", "count"), [("EXISTENCE", 8), ("COUNTING", 6), ("SPATIAL", 6), (None, 20)])
def test_questions_of_one_kind(root, kind, count) -> None:
    dataset = RemqaDataset(root, "train", kind, images=("end_rgb",))
    assert len(dataset) == count
    assert {sample["kind"] for sample in dataset} == ({kind} if kind else {"EXISTENCE", "COUNTING", "SPATIAL"})
    third = dataset[2]
    row = int(third["question_id"].split("-q")[1])
    assert np.abs(third["end_rgb"].permute(1, 2, 0).numpy().astype(int) - rgb_array(row + 1)).mean() < 3


def test_only_the_columns_and_images_asked_for_are_yielded(root) -> None:
    dataset = RemqaDataset(root, "train", columns=["question", "answer"], images=["end_rgb"])
    assert set(dataset[0]) == {"question", "answer", "end_rgb"}
    assert set(FrameDataset(root, "train", columns=(), images=("depth",))[5]) == {"depth"}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda root: RemqaDataset(root, "train", "COUNTNG"), "unknown kind 'COUNTNG'; did you mean 'COUNTING'"),
        (lambda root: RemqaDataset(root, "train", columns=["anwser"]), "did you mean 'answer'"),
        (lambda root: RemqaDataset(root, "train", images=["rgb"]), "unknown name in images 'rgb'"),
        (lambda root: RemqaDataset(root, "train", columns=[3]), "unknown name in columns 3"),
        (lambda root: RemqaDataset(root, "train", ["COUNTING"]), r"unknown kind \['COUNTING'\]"),
    ],
)
def test_a_wrong_name_is_answered_with_the_right_one(root, make, message) -> None:
    with pytest.raises(UnknownNameError, match=message):
        make(root)


def test_images_and_columns_are_not_mixed_up(root) -> None:
    with pytest.raises(ConfigError, match=r"columns: 'start_rgb' is one of images: .* images=\['start_rgb'\]"):
        RemqaDataset(root, "train", columns=["question", "start_rgb"])
    with pytest.raises(ConfigError, match=r"images: 'agent' is one of columns: .* columns=\['agent'\]"):
        FrameDataset(root, "train", images=["agent"])
    with pytest.raises(TypeError, match=r"^columns='question': give a list, \['question'\]$"):
        RemqaDataset(root, "train", columns="question")


@pytest.mark.parametrize("names", [{"images": ("rgb", "rgb")}, {"columns": ["index", "agent", "index"]}])
def test_what_is_named_twice_is_refused(root, names) -> None:
    with pytest.raises(ConfigError, match="is named 2 times"):
        FrameDataset(root, "train", **names)


@pytest.mark.parametrize("names", [{"images": "end_rgb"}, {"columns": "answer"}])
def test_a_text_is_no_list_of_names(root, names) -> None:
    with pytest.raises(TypeError, match="give a list, "):
        RemqaDataset(root, "train", **names)


def test_a_split_or_folder_that_is_not_there_is_told(root, tmp_path) -> None:
    with pytest.raises(DatasetError, match="it has: train, test"):
        RemqaDataset(root, "val")
    with pytest.raises(DatasetError, match="not a finished dataset"):
        RemqaDataset(tmp_path, "train")


def test_a_transform_sees_each_sample(root) -> None:
    assert RemqaDataset(root, "train", transform=only_answer, images=())[1] == "2"


@pytest.mark.slow
def test_a_damaged_image_is_told_when_it_is_read(tmp_path) -> None:
    write_dataset(tmp_path)
    path = tmp_path / "frames" / "train-00000-of-00002.parquet"
    data = path.read_bytes()
    jpeg = encode_rgb(rgb_array(9)).bytes  # frame 9 lies in the third row group
    path.write_bytes(data.replace(jpeg, jpeg[:-5] + b"\x00" + jpeg[-4:]))
    dataset = FrameDataset(tmp_path, "train", images=("rgb",))
    dataset[0]
    with pytest.raises(DamagedShardError, match=r"train-00000-of-00002\.parquet, row group 2, column rgb\.bytes"):
        dataset[9]


# ---- batches and workers


def test_a_batch_stacks_what_has_one_shape_and_lists_the_rest(root) -> None:
    questions = RemqaDataset(root, "train")
    batch = collate([questions[0], questions[1]])
    assert batch["start_rgb"].shape == (2, 3, HEIGHT, WIDTH)
    assert batch["end_depth"].shape == (2, HEIGHT, WIDTH)
    assert batch["start_target_box_2d"].shape == (2, 4)
    assert batch["path_length_m"].tolist() == [1.75, 1.75]
    assert batch["path_steps"].dtype == torch.int64
    assert batch["answer"] == ["yes", "2"]
    assert batch["actions"] == [["MoveAhead", "RotateLeft", "OpenObject"]] * 2
    assert [poses.shape for poses in batch["goal_poses"]] == [(2, 5), (2, 5)]  # a list even if lengths happen to agree
    frames = FrameDataset(root, "train")
    assert [boxes.shape for boxes in collate([frames[0], frames[1]])["boxes_2d"]] == [(0, 4), (2, 4)]


def test_what_a_transform_adds_is_joined_as_pytorch_does(root) -> None:
    more = {"array": np.ones((2, 3), np.float32), "scalar": np.float32(1), "dict": {"a": 1.0}, "tuple": (1, "x")}
    more |= {"flag": True, "number": 1.5}
    dataset = RemqaDataset(root, "train", transform=lambda sample: sample | more, images=())
    batch = next(iter(DataLoader(dataset, batch_size=2)))
    assert (batch["array"].shape, batch["array"].dtype) == ((2, 2, 3), torch.float32)
    assert (batch["scalar"].shape, batch["scalar"].dtype) == ((2,), torch.float32)
    assert batch["dict"]["a"].tolist() == [1.0, 1.0]
    assert (batch["flag"].tolist(), batch["flag"].dtype) == ([True, True], torch.bool)
    assert (batch["number"].dtype, batch["path_length_m"].dtype) == (torch.float64, torch.float64)
    assert (batch["tuple"][0].tolist(), batch["tuple"][1]) == ([1, 1], ("x", "x"))
    with pytest.raises(DatasetError, match="array: samples of several shapes"):
        collate([{"array": np.zeros(2)}, {"array": np.zeros(3)}])
    with pytest.raises(ValueError, match="one sample at least"):
        collate([])
    assert collate([{"either": None}, {"either": 1}, {"either": "x"}]) == {"either": [None, 1, "x"]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "start"),
    [
        (RemqaDataset, "fork"),
        (FrameDataset, "fork"),
        (ExpressionDataset, "fork"),
        (ExpressionDataset, "spawn"),  # reads two tables; a spawned worker takes seconds to import torch
    ],
)
def test_workers_yield_what_one_process_yields(root, kind, start) -> None:
    dataset = kind(root, "train")
    dataset[0]  # the parent has its files open before it forks
    alone = list(DataLoader(dataset, batch_size=4, collate_fn=collate))
    loader = DataLoader(dataset, batch_size=4, num_workers=2, collate_fn=collate, multiprocessing_context=start)
    together = list(loader)
    assert len(together) == len(alone) > 1
    for a, b in zip(alone, together, strict=True):
        assert a.keys() == b.keys()
        for key in a:
            same = torch.equal(a[key], b[key]) if isinstance(a[key], torch.Tensor) else str(a[key]) == str(b[key])
            assert same, key


@pytest.mark.slow
@pytest.mark.parametrize("kind", [RemqaDataset, FrameDataset, ExpressionDataset])
def test_a_shuffled_loader_needs_no_collate(root, kind) -> None:
    dataset = kind(root, "train", transform=lambda sample: sample)
    for workers in (0, 1):
        loader = DataLoader(dataset, batch_size=3, shuffle=True, num_workers=workers)
        batches = list(loader)
        assert len(batches) > 1
        name = next(key for key in dataset.columns if key.endswith("_id"))
        assert sorted(text for batch in batches for text in batch[name]) == sorted(sample[name] for sample in dataset)
        assert all(batch["rgb" if "rgb" in batch else "start_rgb"].dtype == torch.uint8 for batch in batches)


@pytest.mark.parametrize(
    "transform",
    [lambda sample: sample | {"more": 1}, lambda sample: {"more": 1} | sample, lambda sample: sample.copy()],
    ids=["joined", "joined the other way round", "copied"],
)
def test_what_a_transform_makes_of_a_sample_needs_no_collate_either(root, transform) -> None:
    plain = list(DataLoader(RemqaDataset(root, "train", images=()), batch_size=3))
    changed = list(DataLoader(RemqaDataset(root, "train", images=(), transform=transform), batch_size=3))
    assert len(plain) == len(changed) > 0
    for before, after in zip(plain, changed, strict=True):
        assert len(before["goal_poses"]) > 0
        assert all(torch.equal(a, b) for a, b in zip(before["goal_poses"], after["goal_poses"], strict=True))
        assert set(after) - {"more"} == set(before)


def test_columns_may_be_given_one_by_one(root) -> None:
    names = ("question", "answer")
    assert set(RemqaDataset(root, "train", columns=(name for name in names), images=())[0]) == set(names)
    with pytest.raises(UnknownNameError):
        RemqaDataset(root, "train", columns=(name for name in ("question", "anser")), images=())


def test_a_dataset_is_small_when_it_is_pickled(root) -> None:
    dataset = RemqaDataset(root, "train", transform=only_answer)
    first = dataset[0]
    stored = pickle.dumps(dataset)
    assert len(stored) < 5000  # no rows, no files
    assert pickle.loads(stored)[0] == first


@pytest.mark.slow
def test_the_package_needs_torch_only_for_the_datasets() -> None:
    import subprocess
    import sys

    modules = "remqa_data.storage.shards, remqa_data.datasets.vocabulary, remqa_data.datasets.sample_types"
    code = f"import sys, {modules}; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
