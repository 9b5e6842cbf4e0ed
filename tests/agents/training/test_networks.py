"""From a dataset to the tables: networks learn from it for a moment, look, and play."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml
from typer.testing import CliRunner

from remqa_data.agents import view_features
from remqa_data.agents.cli import app
from remqa_data.agents.figures.attention import write_attention_picture
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.training import rooms as rooms_module
from remqa_data.agents.training.config import committees, load_network_config, networks
from remqa_data.agents.training.grounding import GroundingTask
from remqa_data.agents.training.learn import learn
from remqa_data.agents.training.matching import Looks
from remqa_data.agents.training.pictures import Pictures, detector_types, varied
from remqa_data.agents.training.rooms import learning_rooms, rooms_of
from remqa_data.agents.training.weights import About, halved, load_network, save_network, weights_path
from remqa_data.agents.view_features import WEIGHTS
from remqa_data.errors import ConfigError, DatasetError, UnknownNameError
from remqa_data.opencv import cv2
from remqa_data.storage.manifest import MANIFEST
from remqa_data.storage.shards import read_table
from remqa_data.views.build import Wanted, cache_views

pytestmark = pytest.mark.slow

WITH_MAPS = ("framework", "framework_two_stage", "framework_committee", "framework_memory")
WALKERS = ("a3c", "scene_priors", "savn", "eqa", "iqa", "bc_transformer")


def asked(*arguments: object) -> str:
    found = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert found.exit_code == 0, found.output
    return found.output


def short(name: str, folder: Path) -> Path:
    """A network that comes with the package, which learns for one epoch from small pictures."""
    config = load_network_config(name).model_dump(mode="json")
    config["schedule"]["epochs"] = 1
    if "side_px" in config["network"]:
        config["network"]["side_px"] = 64
    if "walks" in config["network"]:
        config["network"]["walks"] = 4
        config["schedule"]["batch_size"] = 4
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


@pytest.fixture(scope="module")
def trained(two_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Weights of all networks."""
    folder = tmp_path_factory.mktemp("trained")
    first = ["detector", "view_encoder", "refiner"]
    then = sorted(  # who sees through the same comes next, and looks at nothing again
        (name for name in networks() if name not in first), key=lambda name: load_network_config(name).network.needs
    )
    options = ("--data", two_rooms, "--out", folder / "weights", "--threads", 1)
    asked("train", *(short(name, folder) for name in first), *options)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(WEIGHTS, str(folder / "weights"))
        view_features._encoder.cache_clear()
        wanted = Wanted(split="train", configurations=(0,), features="remqa_data.agents.view_features:features")
        cache_views(two_rooms, folder / "views", wanted)
    view_features._encoder.cache_clear()
    asked("train", *(short(name, folder) for name in then), *options, "--views", folder / "views")
    return folder / "weights"


def test_everything_from_a_dataset_to_the_tables(two_rooms: Path, trained: Path, tmp_path: Path) -> None:
    options = ("--data", two_rooms, "--out", tmp_path, "--weights", trained)
    asked("predict", *networks(), *committees(), *options)
    asked("predict", "language_attention", "plain_matcher", *options, "--split", "train")
    asked("run", *WITH_MAPS, *WALKERS, *options, "--workers", 1)
    asked("table", "--data", two_rooms, "--out", tmp_path, "--workers", 1)
    text = (tmp_path / "table.md").read_text()
    for wanted in (
        "| framework (semantic map, LAN, answerer) |",
        "| LAN, detected boxes |",
        "| LAN, two stages, detected boxes |",
        "| BiLSTM, no modules, two stages, true boxes |",
        "| LAN with anchors, LAN and no modules together, two stages, true boxes |",
        "| framework (semantic map, three matchers, looks inside, answerer) |",
        "| LAN + detectron2 (Ours) (paper) |",
        "| answerer: the words alone |",
        "| A3C, LAN, answerer |",
        "| EQA (PACMAN), LAN | COUNTING |",
        "| MCN |",
        "| CGAN |",
        "| VSN | success@50 | 4 |",
        "prec@0.5 seen rooms |",
    ):
        assert wanted in text
    board = json.loads((tmp_path / "leaderboard.json").read_text())
    assert len(board["entries"]) == len(WITH_MAPS) + len(WALKERS)
    for stage in ("detector", "refiner"):
        scores = json.loads((tmp_path / f"{stage}-test.json").read_text())
        assert scores["frames"] > 0
    rows = [json.loads(line) for line in (tmp_path / "framework.jsonl").read_text().splitlines()[1:]]
    assert len(rows) == 12
    assert {row["answer"] for row in rows} <= {"0", "1", "2", "3", "yes", "no"}


def test_matchers_that_see_through_the_same_look_at_pictures_once(
    two_rooms: Path, trained: Path, tmp_path: Path
) -> None:
    for name in ("detector", "refiner"):
        shutil.copy(trained / f"{name}.safetensors", tmp_path)
    torch.set_num_threads(1)
    looks: dict[str, Looks] = {}
    looked = {}
    for name in ("plain_matcher", "language_attention_two_stage", "anchored_matcher", "language_attention"):
        seen: list[int] = []
        config = load_network_config(short(name, tmp_path))
        learn(name, config, [two_rooms], tmp_path, looks=looks, on_look=seen.append)
        looked[name] = sum(seen)
        alone, together = (
            load_network(folder / f"{name}.safetensors")[0].state_dict() for folder in (trained, tmp_path)
        )
        assert alone.keys() == together.keys()
        assert all(torch.equal(alone[key], together[key]) for key in alone), name
    assert looked["plain_matcher"] == looked["language_attention"] > 0
    assert looked["anchored_matcher"] == 0
    assert 0 < looked["language_attention_two_stage"] < looked["plain_matcher"]  # views of questions alone
    assert len(looks) == 1


def test_attention_is_drawn_below_the_words(two_rooms: Path, trained: Path, tmp_path: Path) -> None:
    ids = read_table(two_rooms, "expressions", "test", ["expression_id"])["expression_id"].to_pylist()[:2]
    options = ("--data", two_rooms, "--out", tmp_path / "attention.png", "--weights", trained)
    asked("attend", *ids, *options)
    picture = cv2.imread(str(tmp_path / "attention.png"))
    assert picture.shape[0] == 2 * 306
    table = picture[60:250, 300:]
    assert len(np.unique(table.reshape(-1, 3), axis=0)) > 20  # shades, by how much words count
    write_attention_picture(two_rooms, ids[:1], tmp_path / "anchored.png", "anchored_matcher", trained)
    assert cv2.imread(str(tmp_path / "anchored.png")).shape == (306, *picture.shape[1:])
    with pytest.raises(UnknownNameError, match="unknown expression 'nothing'"):
        write_attention_picture(two_rooms, ["nothing"], tmp_path / "no.png", weights=trained)
    with pytest.raises(ConfigError, match="plain_matcher has no attention over words"):
        write_attention_picture(two_rooms, ids, tmp_path / "no.png", "plain_matcher", trained)


def test_weights_say_what_made_them_and_do_the_same_when_read_again(trained: Path, two_rooms: Path) -> None:
    detector, about = load_network(weights_path("detector", trained), two_rooms)
    assert about.network.network.kind == "detector"
    assert about.types == detector_types()
    assert about.score == {}  # two rooms, none of them for val
    path = trained.parent / "again.safetensors"
    halved(detector)
    save_network(path, detector, about)
    again, _ = load_network(path)
    assert all(
        torch.equal(a, b) for a, b in zip(detector.state_dict().values(), again.state_dict().values(), strict=True)
    )


def test_weights_are_refused_only_where_they_may_have_learnt_from_what_is_held_out(
    trained: Path, two_rooms: Path, small_rooms: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = weights_path("language_attention", trained)
    load_network(path, small_rooms)  # another dataset, whose test rooms are test rooms everywhere
    held_out = {
        "train": frozenset({"FloorPlan1"}),
        "val": frozenset({"FloorPlan2"}),
        "test": frozenset({"FloorPlan30"}),
    }
    monkeypatch.setattr(rooms_module, "rooms_of", lambda root, split: held_out[split])
    load_network(path, two_rooms)
    with pytest.raises(ConfigError, match=r"may have learnt from FloorPlan2, which .* holds out: use --force"):
        load_network(path, small_rooms)
    load_network(path, small_rooms, force=True)


def test_rooms_that_are_held_out_by_their_names_are_not_learnt_from(monkeypatch: pytest.MonkeyPatch) -> None:
    rooms = frozenset(
        {"FloorPlan20", "FloorPlan21", "FloorPlan26", "Sampled-kitchen-000000", "Sampled-living_room-000001"}
    )
    monkeypatch.setattr(rooms_module, "rooms_of", lambda root, split: rooms if split == "train" else frozenset())
    assert learning_rooms([Path("unusual")]) == {"FloorPlan20", "Sampled-kitchen-000000"}


def test_what_is_no_network_is_refused_in_one_line(tmp_path: Path) -> None:
    junk = tmp_path / "junk.safetensors"
    junk.write_bytes(b"junk" * 100)
    with pytest.raises(ConfigError, match=r"junk\.safetensors is no network"):
        load_network(junk)
    with pytest.raises(ConfigError, match="no weights of 'nobody'; remqa-agent train makes them"):
        weights_path("nobody", tmp_path)
    other = tmp_path / "other.safetensors"
    config = load_network_config("detector").model_dump(mode="json")
    good = About(config, ("",), ("a", "b", "c"))
    save_network(other, Detector(3), good)
    load_network(other)
    for bad in (replace(good, types=("a", "b")), replace(good, datasets=()), replace(good, format=99)):
        save_network(other, Detector(3), bad)
        with pytest.raises(ConfigError, match=r"other\.safetensors is no network"):
            load_network(other)


def test_no_val_or_test_room_of_any_dataset_is_learnt_from(two_rooms: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    train, test = rooms_of(two_rooms, "train"), rooms_of(two_rooms, "test")
    assert train
    assert test
    assert learning_rooms([two_rooms]) == train
    other = {"train": train | test, "val": frozenset(), "test": frozenset()}
    monkeypatch.setattr(
        rooms_module, "rooms_of", lambda root, split: other[split] if root == Path("other") else rooms_of(root, split)
    )
    assert learning_rooms([Path("other"), two_rooms]) == train  # a test room of one is a train room of the other
    other["val"] = train
    with pytest.raises(DatasetError, match="no room to learn from"):
        learning_rooms([Path("other"), two_rooms])


def test_what_would_be_written_twice_or_nowhere_is_refused(two_rooms: Path, trained: Path, tmp_path: Path) -> None:
    two = tmp_path / "two.yaml"
    two.write_text("title: LAN\nmembers: {language_attention: 1.0, plain_matcher: 1.0}\n")
    options = ["--data", str(two_rooms), "--out", str(tmp_path / "out")]
    weights = ["--weights", str(trained)]
    for arguments, said in (
        (["predict", str(two), str(two), *options, *weights], "several networks are called 'LAN'"),
        (["predict", "language_attention", str(two), *options, *weights], "several networks are called 'LAN'"),
        (["predict", "a3c", "savn", *options, *weights], "a3c, savn: says nothing of stored pictures"),
        (["predict", "detector", *options, "--weights", str(tmp_path / "none")], "does not exist"),
        (["train", "detector", "detector", *options], "2 networks would write"),
        (["train", "detector", *options, "--more", f"{two_rooms}/../{two_rooms.name}"], "is named 2 times"),
        (["train", "detector", *options, "--more", "x", "--more", "./x"], "x is named 2 times"),
        (["run", "random", *options, "--resume", "--overwrite"], "give one of them"),
        (["run", "random", *options, "--split", "test", "--seen", "3"], "leave --split out"),
        (["run", "random", *options, "--seed", "9" * 30], "--seed"),
        (["train", "a3c", *options, "--device", "meta"], "--device meta"),
    ):
        found = CliRunner().invoke(app, arguments)
        assert found.exit_code == 2, arguments
        assert said in found.output
    assert not (tmp_path / "out").exists()


def test_a_varied_picture_shows_the_same_objects_elsewhere(two_rooms: Path) -> None:
    picture = Pictures(two_rooms, "train", "rgb", detector_types())[0]
    seen = [varied(picture, 96, np.random.default_rng(seed)) for seed in range(8)]
    assert all(one.rgb.shape == (96, 96, 3) and one.instances.shape == (96, 96) for one in seen)
    assert all(set(np.unique(one.instances)) <= set(np.unique(picture.instances)) for one in seen)
    assert len({one.rgb.tobytes() for one in seen}) == 8
    again = varied(picture, 96, np.random.default_rng(3))
    assert (again.rgb == seen[3].rgb).all()


def test_a_training_that_was_done_is_done_again_only_to_replace_it(
    two_rooms: Path, trained: Path, tmp_path: Path
) -> None:
    shutil.copytree(trained, tmp_path / "weights")
    path = tmp_path / "weights" / "detector.safetensors"
    before = path.read_bytes()
    config, options = short("detector", tmp_path), ("--data", two_rooms, "--out", path.parent, "--threads", 1)
    path.unlink()
    asked("train", config, *options, "--resume")
    assert path.read_bytes() == before
    path.write_bytes(before[:1000])
    asked("train", config, *options, "--overwrite")
    assert path.read_bytes() == before


def test_grounders_learn_from_pictures_of_one_size(two_rooms: Path, tmp_path: Path) -> None:
    manifest = json.loads((two_rooms / MANIFEST).read_text())
    manifest["config"]["image"]["size_px"] = 84
    (tmp_path / MANIFEST).write_text(json.dumps(manifest))
    with pytest.raises(DatasetError, match=rf"^{tmp_path} has pictures of 84 pixels, {two_rooms} of \d+; "):
        GroundingTask([two_rooms, tmp_path], "mcn", Detector(len(detector_types())))
