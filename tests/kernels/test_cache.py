import logging
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from remqa_data.command_line import announce_compiling
from remqa_data.kernels.cache import kernel_cache

pytestmark = pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders of a user are those of POSIX")


@pytest.fixture
def closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A place in which nobody can make a folder, not even root; home is there, and temporary files are elsewhere."""
    file = tmp_path / "file"
    file.touch()
    monkeypatch.setenv("HOME", str(file / "home"))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.delenv("REMQA_CACHE", raising=False)
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    kernel_cache.cache_clear()
    return file


def test_it_is_where_the_user_wants_it_else_beside_the_code_else_at_home(closed, tmp_path, monkeypatch) -> None:
    wanted, beside = tmp_path / "wanted", tmp_path / "beside"
    assert kernel_cache(str(wanted), beside) == wanted
    assert kernel_cache("", beside) == beside
    assert kernel_cache(str(closed / "wanted"), beside) == beside
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert kernel_cache("", closed / "beside") == tmp_path / "home" / ".cache" / "remqa-data"


def test_where_nothing_can_be_written_it_is_a_private_temporary_folder_and_one_line_says_so(closed, caplog) -> None:
    with caplog.at_level(logging.WARNING, "remqa_data"):
        folder = kernel_cache(str(closed / "wanted"), closed / "beside")
    assert folder.stat().st_mode & 0o777 == 0o700
    assert [record.getMessage() for record in caplog.records] == [
        f"compiled kernels are kept in {folder} for now; set NUMBA_CACHE_DIR to a folder that stays"
    ]
    kernel_cache.cache_clear()
    assert kernel_cache("", closed / "beside") == folder  # the next process finds what this one has compiled


def test_a_temporary_folder_that_others_can_write_is_not_trusted(closed) -> None:
    folder = kernel_cache("", closed / "beside")
    folder.chmod(0o777)
    kernel_cache.cache_clear()
    other = kernel_cache("", closed / "beside")
    assert other != folder
    assert other.stat().st_mode & 0o777 == 0o700
    folder.rmdir()
    folder.symlink_to(other)
    kernel_cache.cache_clear()
    assert kernel_cache("", closed / "beside") not in (folder, other)


def test_a_command_says_that_its_workers_will_compile_only_while_nothing_is_compiled(capsys, monkeypatch) -> None:
    for empty, workers, said in ((True, 2, True), (True, 1, False), (False, 2, False)):
        monkeypatch.setattr("remqa_data.compiled.is_cache_empty", lambda empty=empty: empty)
        announce_compiling(workers)
        assert ("workers compile their kernels, once" in capsys.readouterr().err) == said


@pytest.mark.slow
def test_a_kernel_compiles_where_neither_package_nor_home_can_be_written(tmp_path) -> None:
    (tmp_path / "file").touch()
    code = (
        "import pathlib, remqa_data.kernels.cache as k; lasting = k._lasting\n"
        "k._lasting = lambda wanted, beside: lasting(wanted, pathlib.Path.home() / 'beside')\n"
        "from remqa_data.compiled import is_cache_empty\n"
        "from remqa_data.sim.render.mipmap import _floor\n"
        "import numpy; print(is_cache_empty(), _floor(numpy.float32(-1.5)), is_cache_empty())"
    )
    home = str(tmp_path / "file" / "home")
    environment = {**os.environ, "HOME": home, "NUMBA_CACHE_DIR": home, "TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "True -2 False\n"), done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.glob("remqa-data-*/compiled-*/**/*.nbi"))


@pytest.mark.parametrize("taken", ["file", "link that leads nowhere"])
def test_who_takes_the_name_of_the_temporary_folder_stops_nobody(closed, tmp_path, taken) -> None:
    name = tmp_path / "tmp" / f"remqa-data-{os.getuid()}"
    if taken == "file":
        name.touch()
    else:
        name.symlink_to(tmp_path / "nowhere")
    folder = kernel_cache("", closed / "beside")
    assert folder != name
    assert folder.stat().st_mode & 0o777 == 0o700
    assert not (tmp_path / "nowhere").exists()
