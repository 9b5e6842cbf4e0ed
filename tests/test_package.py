"""What holds for the package as a whole: cheap to import, complete wheels."""

import importlib
import re
import subprocess
import sys
import tomllib
from importlib.metadata import distributions
from pathlib import Path

import pytest
from packaging.specifiers import SpecifierSet

from remqa_data import errors, extras
from remqa_data.errors import MissingExtraError

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("generators", "evaluation", "agents", "configs", "templates")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip()


def test_importing_the_package_takes_less_than_300_ms():
    code = "import time; t = time.perf_counter(); import remqa_data; print(time.perf_counter() - t)"
    assert min(float(run(code)) for _ in range(3)) < 0.3


def test_importing_the_package_pulls_in_nothing_heavy():
    code = "import sys, remqa_data; print(*{name.partition('.')[0] for name in sys.modules})"
    loaded = set(run(code).split())
    assert not loaded & {"torch", "trimesh", "pandas", "numba", "pybullet", "scipy", "cv2", "pyarrow"}


def test_help_needs_neither_the_simulator_nor_the_renderer():
    code = "import sys, remqa_data.cli; print(*{name.partition('.')[0] for name in sys.modules})"
    loaded = set(run(code).split())
    assert not loaded & {"torch", "trimesh", "pandas", "numba", "pybullet", "scipy", "cv2", "pyarrow"}


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_top_level_folder_is_imported_under_the_package(folder):
    module = importlib.import_module(f"remqa_data.{folder}")
    assert Path(str(module.__file__)).resolve().parent == ROOT / folder


def optional_packages() -> list[tuple[str, str]]:
    """Each optional package's import name, and the extra that brings it."""
    return [
        (name, extra)
        for extra, requirements in PYPROJECT["project"]["optional-dependencies"].items()
        if extra not in ("dev", "docs", "lint", "test")  # for people who work on the package itself
        for name in (re.match(r"[A-Za-z0-9_.-]+", requirement).group() for requirement in requirements)  # type: ignore[union-attr]
    ]


def test_the_extras_are_the_promised_ones():
    assert {extra for _, extra in optional_packages()} == {
        "torch",
        "agents",
        "browse",
        "thor",
        "ray",
        "report",
        "rerun",
        "usd",
    }


@pytest.mark.parametrize(("package", "extra"), optional_packages())
def test_a_missing_optional_package_names_its_extra(package, extra, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)  # the import system takes None for "not there"
    with pytest.raises(MissingExtraError, match=rf"{package} is not installed.*remqa-data\[{extra}\]"):
        extras.require(package, extra)


def test_a_module_inside_a_missing_package_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(MissingExtraError, match=r"torch is not installed"):
        extras.require("torch.utils.data", "torch")


def test_an_installed_package_is_returned():
    assert extras.require("xml.dom", "report") is importlib.import_module("xml.dom")


def test_an_error_inside_an_installed_package_is_passed_on(tmp_path, monkeypatch):
    (tmp_path / "half_installed.py").write_text("import a_module_that_is_not_there")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError, match="a_module_that_is_not_there") as caught:
        extras.require("half_installed", "ray")
    assert not isinstance(caught.value, MissingExtraError)


def test_every_error_belongs_to_the_family():
    own = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, BaseException)]
    own = [kind for kind in own if kind.__module__ == errors.__name__]
    assert own
    assert all(issubclass(kind, errors.RemqaError) for kind in own)


def test_an_error_is_raised_anew_from_itself():
    error = errors.StorageError("s3://bucket", "it is gone")
    assert type(error)(error) is error


def test_every_file_that_the_notice_names_is_there():
    named = re.findall(r"\b(?:\w+/)+[\w-]+\.(?:\w+)", (ROOT / "NOTICE").read_text(encoding="utf-8"))
    own = [name for name in named if name.split("/")[0] in {"remqa_data", "docs", *FOLDERS}]
    assert len(own) > 5
    assert [name for name in own if not (ROOT / name).is_file()] == []


def test_every_pinned_version_runs_on_the_python_of_debian_12() -> None:
    """Else pip looks for others for hours there, and finds none."""
    pins = dict(re.findall(r"^(\S+)==(\S+)$", (ROOT / "constraints.txt").read_text(encoding="utf-8"), re.MULTILINE))
    pinned = {name.lower().replace("_", "-"): version for name, version in pins.items()}
    needs = {
        name: found.metadata["Requires-Python"] or ""
        for found in distributions()
        if pinned.get(name := found.name.lower().replace("_", "-")) == found.version
    }
    assert len(needs) > 50
    assert [name for name, versions in needs.items() if "3.11.2" not in SpecifierSet(versions)] == []
