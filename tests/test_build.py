"""What a build contains, with and without the symbolic links of a clone; and what an import says without them."""

import email
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "remqa_data"
FOLDERS = ("agents", "configs", "evaluation", "generators", "templates")
SAFELY: Any = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
"""Debian 12 has Python 3.11.2, whose tarfile knows no filters."""
IGNORED = shutil.ignore_patterns(".*", "__pycache__", "out", "build", "dist", "*.egg-info")


@pytest.fixture
def tree(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A copy of the sources; where links cannot be made, git leaves small text files and some zip tools nothing."""
    root = tmp_path / "tree"
    shutil.copytree(ROOT, root, symlinks=True, ignore=IGNORED)
    for folder in FOLDERS if request.param != "links" else ():
        link = root / "remqa_data" / folder
        link.unlink(missing_ok=True)
        if request.param == "text files":
            link.write_text(f"../{folder}")
    return root


def importing(root: Path) -> subprocess.CompletedProcess[str]:
    """Import the package from a folder, and from nowhere else."""
    code = f"import sys; sys.path.insert(0, {str(root)!r}); import remqa_data; print(remqa_data.__version__)"
    return subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True)


def build(root: Path, kind: str, *, into: Path) -> Path:
    hook = {"metadata": "prepare_metadata_for_build_wheel"}.get(kind, f"build_{kind}")
    code = f"import setuptools.build_meta as b; print(b.{hook}({str(into)!r}))"
    into.mkdir(exist_ok=True)
    done = subprocess.run([sys.executable, "-c", code], cwd=root, check=True, capture_output=True, text=True)
    return into / done.stdout.splitlines()[-1]


def files_of(folder: str) -> set[str]:
    """The files in one of the folders of a clone, relative to it; links are not followed."""
    paths = [path for path in (ROOT / folder).rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    return {path.relative_to(ROOT).as_posix() for path in paths}


def modules_and_facts() -> set[str]:
    """What a wheel has to hold, by the names under which it is imported."""
    own = {name for name in files_of("remqa_data") if name.split("/")[1] not in FOLDERS}
    return own | {f"remqa_data/{name}" for folder in FOLDERS for name in files_of(folder)}


def test_the_package_is_imported_from_a_clone() -> None:
    done = importing(ROOT)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("tree", ["text files", "nothing"], indirect=True)
def test_the_first_import_without_links_says_what_to_do(tree: Path) -> None:
    last = importing(tree).stderr.splitlines()[-1]
    assert last.startswith("ImportError: ")
    assert "symbolic links" in last
    assert "pip install" in last
    assert "core.symlinks" in last


def test_the_citation_names_this_version_and_the_paper() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert (citation["version"], citation["license"]) == (project["version"], project["license"])
    (paper,) = citation["references"]
    assert paper["url"] == project["urls"]["Paper"]


def test_every_relative_link_of_the_readme_leads_to_a_file() -> None:
    links = re.findall(r"\]\(([^)]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    relative = [link for link in links if "://" not in link]
    assert len(relative) > 5
    assert [link for link in relative if not (ROOT / link).exists()] == []


def described(tree: Path, into: Path) -> str:
    """The description of the package that PyPI shows."""
    metadata = build(tree, "metadata", into=into) / "METADATA"
    return str(email.message_from_string(metadata.read_text(encoding="utf-8")).get_payload())


@pytest.mark.slow
@pytest.mark.parametrize("tree", ["text files"], indirect=True)
def test_on_pypi_no_link_of_the_readme_is_dead(tree: Path, tmp_path: Path) -> None:
    text = described(tree, tmp_path / "without")
    assert "docs/METRICS.md" in text
    assert [link for link in re.findall(r"\]\(([^)]+)\)", text) if "://" not in link] == []
    project = (tree / "pyproject.toml").read_text(encoding="utf-8")
    address = "https://git.example.org/remqa-data"
    named = project.replace("[project.urls]", f'[project.urls]\nRepository = "{address}"')
    (tree / "pyproject.toml").write_text(named, encoding="utf-8")
    text = described(tree, tmp_path / "with")
    version = tomllib.loads(project)["project"]["version"]
    assert f"[docs/METRICS.md]({address}/blob/v{version}/docs/METRICS.md)" in text
    assert f"]({address}/raw/v{version}/docs/images/samples.jpg)" in text


@pytest.mark.slow
@pytest.mark.parametrize("tree", ["links", "text files"], indirect=True)
def test_a_wheel_is_whole_with_links_and_without(tree: Path, tmp_path: Path) -> None:
    archive = zipfile.ZipFile(build(tree, "wheel", into=tmp_path / "dist"))
    inside = set(archive.namelist())
    expected = modules_and_facts()
    assert {"remqa_data/templates/ithor_floorplans.parquet", "remqa_data/generators/cli.py"} <= expected
    assert {name for name in inside if ".dist-info/" not in name} == expected
    assert {Path(name).name for name in inside if "/licenses/" in name} == {"LICENSE", "NOTICE"}
    assert (
        "remqa_data.commands:remqa_data"
        in archive.read(next(n for n in inside if n.endswith("entry_points.txt"))).decode()
    )


@pytest.mark.slow
@pytest.mark.parametrize("tree", ["text files"], indirect=True)
def test_an_editable_install_without_links_finds_every_folder(tree: Path, tmp_path: Path) -> None:
    wheel = build(tree, "editable", into=tmp_path / "dist")
    site = tmp_path / "site"
    zipfile.ZipFile(wheel).extractall(site)
    code = f"""
import site; site.addsitedir({str(site)!r})
import remqa_data.agents, remqa_data.evaluation, remqa_data.templates, remqa_data.generators as g; print(g.__file__)
"""
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tree / "generators" / "__init__.py").samefile(done.stdout.strip())


@pytest.mark.slow
@pytest.mark.parametrize("tree", ["links"], indirect=True)
def test_the_sdist_holds_what_the_work_needs_and_builds_the_same_wheel(tree: Path, tmp_path: Path) -> None:
    with tarfile.open(build(tree, "sdist", into=tmp_path / "dist")) as archive:
        archive.extractall(tmp_path / "unpacked", **SAFELY)
    (unpacked,) = (tmp_path / "unpacked").iterdir()
    expected = set().union(
        *(files_of(folder) for folder in (*FOLDERS, "benchmarks", "configs", "docs", "examples", "tests", "tools"))
    )
    expected |= {"CHANGELOG.md", "CITATION.cff", "LICENSE", "Makefile", "NOTICE", "README.md", "constraints.txt"}
    expected |= {"SECURITY.md", "environment.yml", "mkdocs.yml"}
    inside = {path.relative_to(unpacked).as_posix() for path in unpacked.rglob("*") if path.is_file()}
    assert sorted(expected - inside) == []
    assert [name for name in inside if name.endswith(".pyc")] == []
    links = [f"remqa_data/{folder}" for folder in FOLDERS]  # for ruff and mypy
    plan = subprocess.run(
        ["make", "--dry-run", "lint"], cwd=unpacked, check=True, capture_output=True, text=True
    ).stdout
    assert [f"ln -s ../{folder} {link}" in plan for link, folder in zip(links, FOLDERS, strict=True)] == [True] * 5
    subprocess.run(["make", *links], cwd=unpacked, check=True, capture_output=True)
    assert all((unpacked / link).samefile(unpacked / folder) for link, folder in zip(links, FOLDERS, strict=True))
    again = zipfile.ZipFile(build(unpacked, "wheel", into=tmp_path / "again"))
    assert {name for name in again.namelist() if ".dist-info/" not in name} == modules_and_facts()
