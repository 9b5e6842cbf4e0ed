"""The weights that come with the package: what they say of themselves, and to a slice of the test split."""

import json
from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.torch import save_file

from remqa_data.agents.costs import cost_of
from remqa_data.agents.networks.detection.detector import iou
from remqa_data.agents.training.config import load_network_config, networks
from remqa_data.agents.training.weights import KEY, load_network, weights_path
from remqa_data.errors import ConfigError
from remqa_data.files import sha256_of
from tests.helpers.weights_slice import EXPRESSIONS, MATCHERS, QUESTIONS, rows_of, said_answer, said_boxes

pytestmark = pytest.mark.slow

MOST_MB = 25

BEGAN_BEFORE = ("answerer", "answerer_end", "answerer_start")
"""They began with the backbone of a second stage that had learnt for a shorter time than the one in the package."""


def test_shipped_weights_are_of_their_configurations_from_the_same_data_and_detector_and_not_too_large() -> None:
    paths = {path.stem: path for path in weights_path("detector").parent.glob("*.safetensors")}
    assert {"detector", "language_attention", "answerer"} <= set(paths) <= set(networks())
    abouts = {name: load_network(path)[1] for name, path in paths.items()}
    assert all(about.network == load_network_config(name) for name, about in abouts.items())
    # Who walks learns from the views of the first dataset alone.
    assert len({about.datasets[0] for about in abouts.values()}) == 1
    for name, about in abouts.items():
        network = about.network.network
        assert about.needs == {other: sha256_of(paths[other]) for other in network.needs}
        assert set(about.began_with) == set(network.began_with)
        changed = {other for other, sha256 in about.began_with.items() if sha256 != sha256_of(paths[other])}
        assert changed == ({"refiner"} if name in BEGAN_BEFORE else set())
    assert sum(path.stat().st_size for path in paths.values()) < MOST_MB * 1e6


def test_the_answerer_answers_a_slice_of_the_test_split_as_it_did() -> None:
    rows = rows_of(QUESTIONS)
    said = [said_answer(row) for row in rows]
    same = np.mean([answer == row["said"] for answer, row in zip(said, rows, strict=True)])
    right = np.mean([answer == row["answer"] for answer, row in zip(said, rows, strict=True)])
    assert len(rows) >= 40
    assert same >= 0.95  # the last digits of a convolution are another processor's
    assert right == pytest.approx(np.mean([row["said"] == row["answer"] for row in rows]), abs=0.05)


def test_matchers_find_what_a_slice_of_the_test_split_means_as_they_did() -> None:
    rows = rows_of(EXPRESSIONS)
    assert len(rows) >= 20
    said = [said_boxes(row) for row in rows]
    true = np.array([row["box_2d"] for row in rows], dtype=np.float32)
    assert len(MATCHERS) == 3
    for name in MATCHERS:
        boxes = np.array([found[name] or [0, 0, 0, 0] for found in said], dtype=np.float32)
        before = np.array([row[f"{name}_said"] for row in rows], dtype=np.float32)
        assert np.mean(np.diagonal(iou(boxes, before)) > 0.9) >= 0.95, name
        hits = [np.mean(np.diagonal(iou(found, true)) >= 0.5) for found in (boxes, before)]
        assert hits[0] == pytest.approx(hits[1], abs=0.05), name


@pytest.mark.parametrize(
    "change", [{"datasets": [1]}, {"datasets": []}, {"config": 3}, {"format": 9}, {"more": "words"}]
)
def test_weights_that_say_other_things_of_themselves_are_refused_in_one_line(
    tmp_path: Path, change: dict[str, object]
) -> None:
    with safe_open(weights_path("plain_matcher"), framework="pt") as file:
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - it is no mapping
        told = json.loads(file.metadata()[KEY]) | change
    path = tmp_path / "changed.safetensors"
    save_file(tensors, path, metadata={KEY: json.dumps(told)})
    with pytest.raises(
        ConfigError, match=r"changed\.safetensors is no network that .*: what it says of itself is missing"
    ):
        load_network(path, tmp_path)


@pytest.mark.parametrize("damage", ["empty", "junk", "half", "not there", "a folder"])
def test_a_damaged_file_is_told_in_plain_words_with_what_to_do(tmp_path: Path, damage: str) -> None:
    path, whole = tmp_path / "broken.safetensors", weights_path("plain_matcher").read_bytes()
    if damage == "a folder":
        path.mkdir()
    elif damage != "not there":
        path.write_bytes({"empty": b"", "junk": b"junk" * 100, "half": whole[: len(whole) // 2]}[damage])
    said = "cannot be read" if damage in ("not there", "a folder") else "is damaged, cut off or of another kind"
    for read in (load_network, cost_of):
        with pytest.raises(
            ConfigError, match=r"broken\.safetensors is no network that remqa-agent has trained"
        ) as error:
            read(path)
        assert f": the file {said}" in str(error.value)
        assert str(error.value).endswith("; train it again, with --overwrite, or copy it anew")
        assert "Error" not in str(error.value)


def test_weights_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "broken.safetensors"
    with safe_open(weights_path("plain_matcher"), framework="pt") as file:
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - it is no mapping
        about = file.metadata()
    name = next(name for name, tensor in tensors.items() if tensor.is_floating_point())
    tensors[name].view(-1)[0] = float("nan")
    save_file(tensors, path, metadata=about)
    with pytest.raises(ConfigError, match=rf"broken\.safetensors: {name} holds what is no number"):
        load_network(path)
