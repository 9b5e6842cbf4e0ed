"""On bad days of a bucket a dataset comes out with the same bytes, or with an error; nothing is deleted before it is safe."""

import hashlib
import os
from collections.abc import Iterator
from functools import cache, cached_property
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import boto3
import pytest
from pyarrow.fs import AwsDefaultS3RetryStrategy, S3FileSystem

from remqa_data.errors import BusyDatasetError, RemqaError, StorageError
from remqa_data.generators import pipeline
from remqa_data.generators.config import Config, load_config
from remqa_data.storage import backend, locks
from remqa_data.storage.backend import storage_at
from remqa_data.storage.bucket import Bucket
from remqa_data.storage.locks import exclusive
from remqa_data.storage.manifest import MANIFEST
from tests.helpers.crash_run import made_up_part
from tests.helpers.damaged_files import files_of
from tests.helpers.faulty_s3 import Fault, FaultyS3, faulty_s3
from tests.helpers.s3_server import BUCKET, s3_server

CONFIG = Path(__file__).parents[2] / "configs" / "tiny.yaml"
PATIENCE_S = 1.5
"""Of one request; less than a proxy that hangs takes."""

FAULTS = [
    Fault("complete", "lost", 1, MANIFEST),
    Fault("part", "cut body", 1, "frames"),
    Fault("complete", "500", key=MANIFEST),
    Fault("get", "short answer", 1, "part.json"),
    Fault("initiate", "500"),
    Fault("initiate", "reset", 1),
    Fault("part", "500", 1),
    Fault("part", "503"),
    Fault("part", "403", 1, "scenes"),
    Fault("part", "reset", 1),
    Fault("part", "hang", 1),
    Fault("part", "lost", 1, "frames"),
    Fault("part", "cut body", key=MANIFEST),
    Fault("complete", "500", 1),
    Fault("complete", "503", 2),
    Fault("complete", "error in 200", key="questions"),
    Fault("complete", "lost", key="questions"),
    Fault("complete", "reset afterwards", 1),
    Fault("complete", "404", 1, "scenes"),
    Fault("complete", "cut answer", 1),
    Fault("head", "404", 1, MANIFEST),
    Fault("head", "403"),
    Fault("head", "500", 1),
    Fault("get", "404", 1, "train-00000"),
    Fault("get", "500", 1),
    Fault("get", "503"),
    Fault("get", "reset", 1, "frames"),
    Fault("get", "hang", 1, "frames"),
    Fault("get", "cut answer", 1, "frames"),
    Fault("get", "cut answer", key=MANIFEST),
    Fault("get", "short answer", key="frames"),
    Fault("get", "flip", 1, "frames.train"),
    Fault("get", "flip", key=MANIFEST),
    Fault("list", "500", 1),
    Fault("list", "cut answer", 1),
    Fault("list", "403"),
    Fault("delete", "500", 1),
    Fault("delete", "403"),
    Fault("delete", "reset afterwards", 1),
]


def name_of(fault: Fault) -> str:
    often = "always" if fault.times > 9 else f"{fault.times}x"
    return f"{fault.request}: {fault.does} {often} {fault.key}".strip()


class Impatient(Bucket):
    """As it is, but with three attempts within a tenth of a second, where pyarrow's own go on for 6 s."""

    @cached_property
    def _opened(self) -> tuple[S3FileSystem, str]:
        system = S3FileSystem(
            endpoint_override=os.environ["AWS_ENDPOINT_URL"],
            retry_strategy=AwsDefaultS3RetryStrategy(max_attempts=3),
            request_timeout=PATIENCE_S,
        )
        return system, self.root.removeprefix("s3://")


@pytest.fixture(scope="module")
def servers() -> Iterator[tuple[FaultyS3, str]]:
    """The proxy, which everything speaks to, and the URL of the server behind it."""
    with pytest.MonkeyPatch.context() as monkeypatch, s3_server(monkeypatch):
        behind = os.environ["AWS_ENDPOINT_URL"]
        where = urlsplit(behind)
        with faulty_s3(str(where.hostname), int(where.port or 0)) as (url, proxy):
            monkeypatch.setenv("AWS_ENDPOINT_URL", url)
            monkeypatch.setattr(backend, "Bucket", Impatient)
            monkeypatch.setattr(pipeline, "make_part", made_up_part)
            monkeypatch.setattr(pipeline, "FEWEST_SHARDS", {})
            monkeypatch.setattr(locks, "SETTLE_S", 0.0)
            monkeypatch.setenv("CRASH_ROOM_S", "0")
            yield proxy, behind


@pytest.fixture(scope="module")
def config() -> Config:
    return load_config(CONFIG).with_scenes(2)


@pytest.fixture(scope="module")
def expected(servers: tuple[FaultyS3, str], config: Config, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Checksums of a dataset that nothing happened to."""
    root = tmp_path_factory.mktemp("whole") / "out"
    pipeline.generate(root, config)
    return files_of(root)


@cache
def client_of(endpoint: str) -> Any:
    return boto3.client("s3", endpoint_url=endpoint)


@cache
def sha256_of_object(endpoint: str, key: str, tag: str) -> str:
    """Asked for once for each body that an object has had: `tag` tells them apart."""
    return hashlib.sha256(client_of(endpoint).get_object(Bucket=BUCKET, Key=key)["Body"].read()).hexdigest()


def stored(behind: str, prefix: str) -> dict[str, str]:
    """Checksums of what really lies in the bucket."""
    found = client_of(behind).list_objects_v2(Bucket=BUCKET, Prefix=f"{prefix}/").get("Contents", [])
    return {
        entry["Key"].removeprefix(f"{prefix}/"): sha256_of_object(behind, entry["Key"], entry["ETag"])
        for entry in found
        if not entry["Key"].endswith("/")
    }


MISREAD = ("short answer", "flip")
"""Two such readings of a part say that it is damaged (docs/RELIABILITY.md): its note goes, and its room is made again."""


def check(
    fault: Fault, servers: tuple[FaultyS3, str], config: Config, expected: dict[str, str], prefix: str
) -> Exception | None:
    proxy, behind = servers
    unsafe: list[str] = []

    def on_delete(path: str) -> None:
        """Parts may go when the manifest and all that it lists are there."""
        if "/.parts" in unquote(path) or path.endswith("?delete"):
            there = stored(behind, prefix)
            is_note = path.endswith(
                "/part.json"
            )  # else it is an upload that was read back wrong, and that counts nowhere
            called_damaged = fault.does in MISREAD and (proxy.hits >= 2 or not is_note)
            if not expected.items() <= there.items() and not called_damaged:
                unsafe.append(path)

    proxy.faults, proxy.on_delete, proxy.hits = [Fault(**vars(fault))], on_delete, 0
    error = None
    try:
        pipeline.generate(f"s3://{BUCKET}/{prefix}", config)
    except (RemqaError, OSError) as caught:
        error = caught
    finally:
        proxy.faults = []
    assert proxy.hits > 0, "the fault did not come to pass"
    if error is None:
        assert stored(behind, prefix) == expected
    else:
        assert "\n" not in str(error).strip()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locks, "LIFE_S", 0.0)  # of a claim that could not be deleted
        pipeline.generate(f"s3://{BUCKET}/{prefix}", config)
    left = {path: sha for path, sha in stored(behind, prefix).items() if not path.startswith(locks.LOCK)}
    assert left == expected
    assert not unsafe, f"deleted too early: {unsafe}"
    return error


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS, ids=name_of)
def test_a_fault_ends_in_the_same_bytes_or_an_error(
    fault: Fault, servers: tuple[FaultyS3, str], config: Config, expected: dict[str, str], tmp_path: Path
) -> None:
    error = check(fault, servers, config, expected, tmp_path.name)
    print("same bytes" if error is None else f"{type(error).__name__}: {error}")


@pytest.mark.slow
def test_missing_credentials_are_called_so(
    servers: tuple[FaultyS3, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    proxy, _ = servers
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_PROFILE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    faults = [Fault(request, "403") for request in ("initiate", "part", "put", "get", "head", "list")]
    monkeypatch.setattr(proxy, "faults", faults)
    with pytest.raises(StorageError, match=r"no credentials were found; set AWS_ACCESS_KEY_ID"):
        storage_at(f"s3://{BUCKET}/x").files()
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "wrong")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "wrong")
    with pytest.raises(StorageError, match=r"check the bucket's name, and credentials"):
        storage_at(f"s3://{BUCKET}/x").files()


@pytest.mark.slow
def test_of_three_starts_at_the_same_moment_one_wins(
    servers: tuple[FaultyS3, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from concurrent.futures import ThreadPoolExecutor
    from threading import Barrier

    monkeypatch.setattr(locks, "SETTLE_S", 0.5)
    barrier, tried = Barrier(3), Barrier(3)

    def run(number: int) -> bool:
        barrier.wait()
        try:
            with exclusive(storage_at(f"s3://{BUCKET}/{tmp_path.name}")):
                tried.wait()
                return True
        except BusyDatasetError:
            tried.wait()
            return False

    with ThreadPoolExecutor(3) as pool:
        assert sorted(pool.map(run, range(3))) == [False, False, True]
