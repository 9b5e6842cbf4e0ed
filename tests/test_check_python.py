import importlib.util
import platform
import shutil
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

import pytest

TOOL = Path(__file__).parents[1] / "tools" / "check_python.py"


@pytest.fixture
def check() -> ModuleType:
    spec = importlib.util.spec_from_file_location("check_python", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def debian_313(monkeypatch, tmp_path) -> None:
    """A Debian 13 with its own Python 3.13 and nothing that it takes to compile."""
    version = type("version", (tuple,), {"major": 3, "minor": 13})((3, 13, 5))
    monkeypatch.setattr(sys, "version_info", version)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(sys, "base_prefix", "/usr")
    monkeypatch.setattr(sysconfig, "get_path", lambda name: str(tmp_path))
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/apt-get" if name == "apt-get" else None)


@pytest.mark.usefixtures("debian_313")
def test_what_it_takes_to_compile_is_named_with_its_packages(check, capsys) -> None:
    assert check.main() == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "lacks compiler and headers" in line
    assert line.endswith("Run: apt-get install g++ python3.13-dev")


@pytest.mark.usefixtures("debian_313")
def test_with_compiler_and_headers_nothing_is_missing(check, capsys, monkeypatch, tmp_path) -> None:
    (tmp_path / "Python.h").touch()
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    assert check.main() == 0
    assert capsys.readouterr().err == ""


def test_where_there_is_a_wheel_only_venv_can_be_missing(check, capsys, monkeypatch) -> None:
    monkeypatch.setattr(check, "has_pybullet_wheel", lambda: True)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/apt-get" if name == "apt-get" else None)
    monkeypatch.setattr(sys, "base_prefix", "/usr")
    assert check.main() == 1
    assert f"apt-get install python3.{sys.version_info.minor}-venv" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("version", "machine", "expected"),
    [((3, 11), "x86_64", True), ((3, 12), "x86_64", False), ((3, 11), "aarch64", False)],
)
def test_pybullet_has_wheels_for_few(check, monkeypatch, version, machine, expected) -> None:
    monkeypatch.setattr(sys, "version_info", (*version, 0))
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(platform, "libc_ver", lambda: ("glibc", "2.36"))
    assert check.has_pybullet_wheel() is expected
