"""What holds for the package as a whole: cheap to import, complete wheels."""

import importlib
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from remqa_data import errors, extras
from remqa_data.errors import MissingExtraError

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "remqa_data"
FOLDERS = ("generators", "evaluation", "agents", "templates")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
IMPORT_NAMES = {"rerun-sdk": "rerun"}
"""Where a distribution's import name differs from its own."""


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
    assert (PACKAGE / folder).readlink() == Path("..") / folder


def own_files() -> list[Path]:
    return [path for path in sorted(PACKAGE.rglob("*.py")) if path.relative_to(PACKAGE).parts[0] not in FOLDERS]


def optional_packages() -> list[tuple[str, str]]:
    """Each optional package's import name, and the extra that brings it."""
    return [
        (IMPORT_NAMES.get(name, name), extra)
        for extra, requirements in PYPROJECT["project"]["optional-dependencies"].items()
        if extra != "dev"
        for name in (re.match(r"[A-Za-z0-9_.-]+", requirement).group() for requirement in requirements)  # type: ignore[union-attr]
    ]


def test_the_extras_are_the_promised_ones():
    assert {extra for _, extra in optional_packages()} == {"torch", "thor", "ray", "rerun", "report"}


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
    own = [kind for kind in vars(errors).values() if isinstance(kind, type) and kind.__module__ == errors.__name__]
    assert own
    assert all(issubclass(kind, errors.RemqaError) for kind in own)


@pytest.mark.slow
def test_a_wheel_has_every_module_and_every_fact(tmp_path):
    tree = tmp_path / "tree"
    ignored = shutil.ignore_patterns(".*", "__pycache__", "out", "build", "dist", "*.egg-info", "tests")
    shutil.copytree(ROOT, tree, symlinks=True, ignore=ignored)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*command, "--wheel-dir", str(tmp_path), str(tree)], check=True, cwd=tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    archive = zipfile.ZipFile(wheel)
    inside = set(archive.namelist())

    modules = {path.relative_to(ROOT).as_posix() for path in own_files()} | {"remqa_data/py.typed"}
    for folder in FOLDERS:
        modules |= {
            f"remqa_data/{path.relative_to(ROOT).as_posix()}"
            for path in (ROOT / folder).rglob("*")
            if path.suffix in {".py", ".yaml", ".csv", ".parquet"}
        }
    assert modules <= inside
    assert {"remqa_data/templates/objects.yaml", "remqa_data/templates/ithor_floorplans.parquet"} <= inside
    assert {name.partition("/")[0] for name in inside if ".dist-info" not in name} == {"remqa_data"}
    assert {Path(name).name for name in inside if "/licenses/" in name} == {"LICENSE", "NOTICE"}
    assert "remqa_data.cli:main" in archive.read(next(n for n in inside if n.endswith("entry_points.txt"))).decode()
