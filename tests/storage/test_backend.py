"""Folders and buckets keep the same promises; the bucket is one of a real S3 server, spoken to over the network."""

import pickle
from collections.abc import Iterator
from pathlib import Path

import boto3
import pytest

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import BusyDatasetError, DamagedPartError, DamagedShardError, DatasetError, StorageError
from remqa_data.storage import locks
from remqa_data.storage.backend import storage_at
from remqa_data.storage.bucket import Bucket
from remqa_data.storage.folder import Folder
from remqa_data.storage.locks import LOCK, exclusive
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.parts import Parts, assemble
from remqa_data.storage.protocol import Storage
from remqa_data.storage.shards import check_files, read_rows, read_table
from remqa_data.tables.rows import QuestionRow
from tests.helpers.dataset_rows import frame_row, write_dataset
from tests.helpers.s3_server import BUCKET, s3_server

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def bucket() -> Iterator[str]:
    with pytest.MonkeyPatch.context() as monkeypatch, s3_server(monkeypatch) as uri:
        monkeypatch.setattr(locks, "SETTLE_S", 0.2)  # the server is near
        yield uri


@pytest.fixture(params=["folder", "bucket"])
def storage(request: pytest.FixtureRequest, tmp_path: Path) -> Storage:
    if request.param == "folder":
        return storage_at(tmp_path / "root")
    return storage_at(f"{request.getfixturevalue('bucket')}/{tmp_path.name}")


@pytest.fixture(scope="module")
def dataset(bucket: str, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """The same dataset in a bucket and in a folder."""
    root = tmp_path_factory.mktemp("dataset")
    assert write_dataset(f"{bucket}/dataset") == write_dataset(root)
    return f"{bucket}/dataset", root


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def names(storage: Storage, folder: str = "") -> list[str]:
    return [file.path for file in storage.files(folder)]


def put(storage: Storage, path: str, data: bytes) -> None:
    with storage.publish(path) as temporary:
        temporary.write_bytes(data)


# ---- what every storage promises


def test_a_file_appears_when_it_is_whole(storage: Storage) -> None:
    with storage.publish("a/b.txt") as temporary:
        temporary.write_bytes(b"1234")
        assert not storage.exists("a/b.txt")
    assert storage.exists("a/b.txt")
    assert storage.read("a/b.txt") == b"1234"
    assert [(file.path, file.bytes) for file in storage.files()] == [("a/b.txt", 4)]
    with storage.fetch("a/b.txt") as path:
        assert path.read_bytes() == b"1234"


def test_an_error_leaves_the_old_file(storage: Storage) -> None:
    put(storage, "a", b"old")
    with pytest.raises(RuntimeError, match="stop"), storage.publish("a") as temporary:  # noqa: PT012
        temporary.write_bytes(b"half")
        raise RuntimeError("stop")
    assert storage.read("a") == b"old"
    assert names(storage) == ["a"]


def test_files_are_listed_in_order_and_removed(storage: Storage) -> None:
    assert storage.files() == []
    for path in ("b/c/d", "a", "b/a", "bc"):
        put(storage, path, b"x")
    assert names(storage) == ["a", "b/a", "b/c/d", "bc"]
    assert names(storage, "b") == ["b/a", "b/c/d"]
    storage.delete(["a", "not there"])
    storage.delete_folder("b")
    storage.delete_folder("not there")
    assert names(storage) == ["bc"]


def test_a_file_that_is_not_there_is_an_error(storage: Storage) -> None:
    assert not storage.exists("a")
    with pytest.raises(FileNotFoundError):
        storage.read("a")
    with pytest.raises(FileNotFoundError), storage.fetch("a") as path:
        path.read_bytes()


def test_another_process_opens_the_same_storage(storage: Storage) -> None:
    put(storage, "a", b"x")
    for same in (storage_at(storage.root), pickle.loads(pickle.dumps(storage))):
        assert same.read("a") == b"x"


def test_one_run_at_a_time_writes(storage: Storage) -> None:
    with exclusive(storage) as lock:
        with pytest.raises(BusyDatasetError, match="another run is writing here"), exclusive(storage_at(storage.root)):
            pass
        lock.confirm()
    with exclusive(storage):
        pass
    assert names(storage) == []


# ---- what only buckets do


@pytest.mark.parametrize("root", ["s3://bucket/a/b", Path("s3://bucket/a/b"), "s3://bucket/a/b/"])
def test_a_uri_may_have_gone_through_a_path(root: str | Path) -> None:
    assert storage_at(root).where("c") == "s3://bucket/a/b/c"


@pytest.mark.parametrize("root", ["data", "C:/data", Path("/data/s3:/x")])
def test_what_is_no_uri_is_a_folder(root: str | Path) -> None:
    assert isinstance(storage_at(root), Folder)


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("s3://no-such-bucket/data", "s3://no-such-bucket/data: .*NO_SUCH_BUCKET"),
        ("s4://bucket", "there is no such storage"),
    ],
)
def test_a_bucket_that_cannot_be_used_says_why(bucket: str, uri: str, message: str) -> None:
    with pytest.raises(StorageError, match=message):
        put(storage_at(uri), "a", b"x")


def test_a_claim_of_a_dead_run_is_passed_on(bucket: str, monkeypatch: pytest.MonkeyPatch) -> None:
    storage = storage_at(f"{bucket}/claims")
    put(storage, f"{LOCK}/of-a-killed-run", b"")
    with pytest.raises(BusyDatasetError), exclusive(storage):
        pass
    monkeypatch.setattr("remqa_data.storage.locks.LIFE_S", 0.0)
    with exclusive(storage):
        assert f"{LOCK}/of-a-killed-run" not in names(storage)


def test_a_run_whose_claim_has_passed_to_another_does_not_finish(bucket: str) -> None:
    storage = storage_at(f"{bucket}/passed")
    with exclusive(storage) as lock:
        storage.delete_folder(LOCK)  # another run thought that this one was dead
        put(storage, f"{LOCK}/of-another-run", b"")
        with pytest.raises(BusyDatasetError):
            lock.confirm()


def test_a_dataset_in_a_bucket_is_the_same_files(dataset: tuple[str, Path]) -> None:
    uri, root = dataset
    stored = storage_at(uri)
    assert names(stored) == names(storage_at(root)) != []
    for path in names(stored):
        assert stored.read(path) == (root / path).read_bytes()


def test_a_dataset_in_a_bucket_is_read_like_any_other(dataset: tuple[str, Path], cache: Path) -> None:
    uri, root = dataset
    for place in (uri, Path(uri)):
        assert load_manifest(place) == load_manifest(root)
        check_files(place)
        assert list(read_rows(place, QuestionRow, "train")) == list(read_rows(root, QuestionRow, "train"))
    remote, local = (SplitReader(place, "frames", "test") for place in (Path(uri), root))
    assert len(remote) == len(local)
    assert bytes(remote.images(3, ["rgb"])[0]) == bytes(local.images(3, ["rgb"])[0])
    assert {path.stem for path in cache.iterdir()} == {file.sha256 for file in load_manifest(root).files}


def test_a_shard_is_fetched_once(dataset: tuple[str, Path], cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    uri = dataset[0]
    read_table(uri, "scenes", "test")
    fetched = {path: path.stat().st_mtime_ns for path in cache.iterdir()}
    monkeypatch.setattr(Bucket, "fetch", None)
    read_table(uri, "scenes", "test")
    assert fetched == {path: path.stat().st_mtime_ns for path in cache.iterdir()}


@pytest.mark.parametrize("change", ["flip", "cut", "remove"])
def test_a_damaged_shard_in_a_bucket_is_told(bucket: str, tmp_path: Path, change: str) -> None:
    uri = f"{bucket}/{change}"
    manifest = write_dataset(uri)
    storage, path = storage_at(uri), manifest.files_of("scenes", "test")[0].path
    data = bytearray(storage.read(path))
    data[len(data) // 2] ^= 0x10
    if change == "remove":
        storage.delete([path])
    else:
        put(storage, path, bytes(data if change == "flip" else data[:-100]))
    for reading in (lambda: check_files(uri), lambda: read_table(uri, "scenes", "test")):
        with pytest.raises(DamagedShardError, match=f"damaged shard: {uri}/{path}"):
            reading()


@pytest.mark.parametrize("change", ["flip", "remove"])
def test_what_is_damaged_in_a_bucket_is_told_though_a_copy_is_whole(bucket: str, change: str) -> None:
    uri = f"{bucket}/cached-{change}"
    path = write_dataset(uri).files_of("scenes", "test")[0].path
    check_files(uri)
    storage = storage_at(uri)
    if change == "remove":
        storage.delete([path])
    else:
        put(storage, path, storage.read(path)[::-1])
    with pytest.raises(DamagedShardError, match=f"damaged shard: {uri}/{path}"):
        check_files(uri)


def test_a_torn_part_in_a_bucket_is_made_again(bucket: str) -> None:
    parts = Parts(f"{bucket}/torn", {})
    made = [parts.write(scene, {"frames": [frame_row(scene, "train", 0)]}) for scene in "AB"]
    put(parts.storage, made[0].files[0].path, b"PAR1")
    with pytest.raises(DamagedPartError, match="A again"):
        assemble(parts, made, 1)
    assert list(parts.finished()) == ["B"]


def test_a_place_without_a_manifest_is_not_a_dataset(bucket: str) -> None:
    with pytest.raises(DatasetError, match=r"s3://.*/nothing is not a finished dataset"):
        load_manifest(f"{bucket}/nothing")


def test_objects_can_be_read_by_any_other_client(dataset: tuple[str, Path]) -> None:
    answer = boto3.client("s3").get_object(Bucket=BUCKET, Key="dataset/manifest.json")
    assert answer["Body"].read() == (dataset[1] / "manifest.json").read_bytes()
