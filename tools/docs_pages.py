"""Pages of the documentation's site that are made when it is built: a hook of mkdocs, see mkdocs.yml.

README and the other texts at the top of the repository, every field of the tables from their schemas, and the reference of
public names from their docstrings.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from remqa_data.storage.card import field_table
from remqa_data.tables.schema import TABLES

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
TOP_PAGES = {
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "security.md": "SECURITY.md",
}
REFERENCE = {
    "Datasets": (
        "remqa_data.datasets.torch_datasets.RemqaDataset",
        "remqa_data.datasets.torch_datasets.FrameDataset",
        "remqa_data.datasets.torch_datasets.ExpressionDataset",
        "remqa_data.datasets.torch_datasets.collate",
        "remqa_data.datasets.vocabulary.Vocabulary",
    ),
    "Environment": ("remqa_data.env.environment.RemqaEnv", "remqa_data.thor.controller.Controller"),
    "Rooms": (
        "remqa_data.floorplans.load.load_scene",
        "remqa_data.sim.physics.world.World",
        "remqa_data.sim.render.view.WorldView",
        "remqa_data.sim.render.camera.Camera",
        "remqa_data.catalog.object_type",
        "remqa_data.catalog.question_types",
    ),
    "Metrics": ("remqa_data.metrics",),
}
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)#\s]+)((?:#[^)\s]*)?)\)")


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages."""
    from mkdocs.structure.files import File

    for page, source in TOP_PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text(encoding="utf-8")))
    files.append(File.generated(config, "fields.md", content=fields_page()))
    files.append(File.generated(config, "reference.md", content=reference_page()))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links between texts lead to their pages; what has no page is named without a link."""
    return LINK.sub(lambda match: _link(match, files), markdown)


def _link(match: re.Match[str], files: Files) -> str:
    text, target, anchor = match.groups()
    if "://" in target or target.startswith("mailto:"):
        return match.group()
    path = target.removeprefix("../").removeprefix("docs/")
    path = {source: name for name, source in TOP_PAGES.items()}.get(path, path)
    if files.get_file_from_path(path) is None:
        return text.removeprefix("[").removesuffix("]")
    return f"{text}({path}{anchor})"


def fields_page() -> str:
    """Every column of every table."""
    lines = [
        "# Every field",
        "",
        "The tables of a dataset, as Parquet. Made from the schemas that files are written and checked with.",
        "",
    ]
    for spec in TABLES.values():
        lines += [f"## {spec.name}", "", spec.description, "", *field_table(spec), ""]
    return "\n".join(lines)


def reference_page() -> str:
    """Public names with their docstrings."""
    lines = ["# Reference", ""]
    for title, names in REFERENCE.items():
        lines += [f"## {title}", "", *(f"::: {name}\n" for name in names)]
    return "\n".join(lines)
