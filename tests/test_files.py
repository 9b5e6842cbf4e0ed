import errno
import os
import socket
import stat
from pathlib import Path

import pytest

from remqa_data.errors import OutputError
from remqa_data.files import atomic_folder, atomic_path, beside, cache_folder, check_empty


def test_a_file_gets_its_name_only_when_it_is_whole(tmp_path):
    target = tmp_path / "sub" / "data.npz"
    with atomic_path(target) as temporary:
        temporary.write_bytes(b"12")
        assert temporary.parent == target.parent
        assert temporary.suffix == ".npz"
        assert not target.exists()
    assert target.read_bytes() == b"12"
    assert list(target.parent.iterdir()) == [target]


def test_what_is_kept_lies_where_the_user_wants_it(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.delenv("REMQA_CACHE", raising=False)
    found = [cache_folder()]
    for name in ("XDG_CACHE_HOME", "REMQA_CACHE"):
        monkeypatch.setenv(name, str(tmp_path / name))
        found.append(cache_folder())
    assert found == [tmp_path / name for name in (".cache/remqa-data", "XDG_CACHE_HOME/remqa-data", "REMQA_CACHE")]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "data.bin"
    target.write_bytes(b"old")

    def write_half() -> None:
        with atomic_path(target) as temporary:
            temporary.write_bytes(b"half")
            raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="stop"):
        write_half()
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_an_error_before_anything_is_written_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt), atomic_path(tmp_path / "a"):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_a_block_that_writes_nothing_is_an_error_and_keeps_the_old_file(tmp_path):
    target = tmp_path / "data.bin"
    target.write_bytes(b"old")
    with pytest.raises(FileNotFoundError), atomic_path(target):
        pass
    assert target.read_bytes() == b"old"


def test_an_older_file_is_replaced(tmp_path):
    target = tmp_path / "data.bin"
    target.write_bytes(b"old")
    with atomic_path(str(target)) as temporary:
        temporary.write_bytes(b"new")
    assert target.read_bytes() == b"new"


def test_a_whole_folder_takes_the_place_of_the_old_one(tmp_path):
    target = tmp_path / "run.xml-meshes"
    for name in ("old", "new"):
        with atomic_folder(target) as temporary:
            (temporary / name).write_bytes(b"")
            assert not (target / name).exists()
        assert [path.name for path in target.iterdir()] == [name]
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("when", ["in the block", "between the renames"])
def test_an_error_leaves_the_old_folder_and_nothing_else(tmp_path, monkeypatch, when):
    target, rename = tmp_path / "meshes", Path.replace

    def interrupted(path: Path, to: Path) -> Path:
        if to == target and when == "between the renames":
            monkeypatch.undo()
            raise KeyboardInterrupt
        return rename(path, to)

    with atomic_folder(target) as temporary:
        (temporary / "old").write_bytes(b"")
    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt), atomic_folder(target) as temporary:  # noqa: PT012
        (temporary / "new").write_bytes(b"")
        if when == "in the block":
            raise KeyboardInterrupt
    assert list(tmp_path.rglob("*")) == [target, target / "old"]


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX files")
def test_the_file_has_ordinary_permissions(tmp_path):
    plain, target = tmp_path / "plain", tmp_path / "target"
    plain.write_bytes(b"")
    with atomic_path(target) as temporary:
        temporary.write_bytes(b"")
    assert stat.S_IMODE(target.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)


def bound_socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(str(path))


@pytest.mark.skipif(os.name != "posix", reason="kinds of files of POSIX")
@pytest.mark.parametrize(
    ("make", "kind"),
    [
        (Path.mkdir, "a folder"),
        (os.mkfifo, "a pipe"),
        (bound_socket, "a socket"),
        (lambda path: path.symlink_to(path.with_name("other")), "a symbolic link"),
    ],
)
def test_what_is_no_regular_file_is_refused_and_stays(tmp_path, make, kind):
    target, other = tmp_path / "target", tmp_path / "other"
    other.write_bytes(b"precious")
    make(target)
    before = target.lstat()
    with pytest.raises(OutputError, match=f"target is {kind}; give the path of a file"), atomic_path(target):
        pytest.fail("nothing is done before")
    assert (target.lstat().st_ino, target.lstat().st_mode) == (before.st_ino, before.st_mode)
    assert other.read_bytes() == b"precious"


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="needs /dev/full")
@pytest.mark.parametrize("name", ["full", "null", "stdout"])
def test_devices_are_refused(name):
    with pytest.raises(OutputError, match=f"/dev/{name} is a"), atomic_path(f"/dev/{name}"):
        pytest.fail("nothing is done before")


def test_what_comes_to_be_no_regular_file_meanwhile_is_refused_too(tmp_path):
    target = tmp_path / "target"
    with pytest.raises(OutputError, match="is a symbolic link"), atomic_path(target) as temporary:  # noqa: PT012
        temporary.write_bytes(b"new")
        target.symlink_to("elsewhere")
    assert [path.name for path in tmp_path.iterdir()] == ["target"]


def test_a_full_disk_is_told_with_the_file_that_was_written(tmp_path):
    for number, named in ((errno.ENOSPC, str(tmp_path / "data.bin")), (errno.EIO, None)):
        with pytest.raises(OSError, match="no room") as error, atomic_path(tmp_path / "data.bin"):
            raise OSError(number, "no room")
        assert error.value.filename == named


def test_what_is_made_of_a_dataset_lies_beside_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert beside(Path("out/tiny"), "coco") == Path("out/tiny-coco")
    assert beside(Path(), "coco") == tmp_path.with_name(f"{tmp_path.name}-coco")
    assert beside(Path(".."), "coco") == tmp_path.parent.with_name(f"{tmp_path.parent.name}-coco")
    for root in ("s3://bucket/tiny", Path("s3://bucket/tiny")):
        with pytest.raises(
            OutputError, match=r"^s3://bucket/tiny is not on this machine: say where to write with --out"
        ):
            beside(root, "coco")


def test_many_files_are_not_written_among_others(tmp_path):
    check_empty(tmp_path, "--out")
    check_empty(tmp_path / "new", "--out")
    (tmp_path / "file").touch()
    for out in (tmp_path, tmp_path / "file"):
        with pytest.raises(OutputError, match="is not an empty folder; name a new one with --out"):
            check_empty(out, "--out")
