"""What a dataset says about itself: the dataset card (README.md) for Hugging Face, and croissant.json for MLCommons.

Both are made from the manifest and from the documentation in the tables' schemas, so they cannot say anything else.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import cache
from typing import Any

import pyarrow as pa

from remqa_data.published import BIBTEX
from remqa_data.storage.backend import storage_at
from remqa_data.storage.manifest import Manifest
from remqa_data.tables.schema import IMAGE_TYPE, TABLES, TableSpec, field_docs
from remqa_data.version import RELEASED

CARD, CROISSANT = "README.md", "croissant.json"
LICENSE_URL = "https://www.apache.org/licenses/LICENSE-2.0"
DEFAULT_TABLE = "questions"
ABOUT = (
    "Remote embodied manipulation question answering: an agent walks to something in a simulated room, opens, moves or "
    "picks it up with its arm, looks, and answers a question. Every answer was verified in the simulator."
)
CITED = "The task and the benchmark are those of this paper; rooms, pictures and questions here are made anew."
PROVENANCE = (
    "Generated with remqa-data on PyBullet. The rooms follow the 120 iTHOR floor plans: names, boxes, poses, "
    "receptacles and flags of their objects are derived from the Apache-2.0 `procthor` 0.0.1.dev2 wheel (Copyright "
    "Allen Institute for AI). All shapes, textures and pictures are made by this package; no mesh, texture or program "
    "of AI2-THOR or ProcTHOR is included."
)
FRAMES = (
    "World frame: right-handed, z up, metres; yaw in degrees counter-clockwise from +x, horizon positive downwards. "
    "Image frame: pixels, x right, y down; boxes are `[x1, y1, x2, y2)`, half open. JSON columns hold text."
)


def write_card(root: str | os.PathLike[str], manifest: Manifest, names: Sequence[str] = (CARD, CROISSANT)) -> None:
    """Write README.md and croissant.json into a dataset's folder; do so before the manifest, which comes last."""
    texts = {CARD: dataset_card, CROISSANT: croissant_text}
    for name in names:
        with storage_at(root).publish(name) as temporary:
            temporary.write_text(texts[name](manifest), encoding="utf-8")


def dataset_card(manifest: Manifest) -> str:
    """The text of README.md: Hugging Face's front matter, counts, how to read, and every field of every table."""
    tables = [spec for spec in TABLES.values() if manifest.files_of(spec.name)]
    lines = [
        *_front_matter(manifest, tables),
        *("# REMQA dataset", "", ABOUT, ""),
        *("## Contents", "", *_counts(manifest, tables), "", *_questions(manifest), ""),
        *("## Reading it", "", "```python", *_snippet(manifest, tables), "```", "", FRAMES, ""),
        *("## Fields", ""),
    ]
    for spec in tables:
        lines += [f"### {spec.name}", "", spec.description, "", *field_table(spec), ""]
    lines += ["## Made by", "", *_versions(manifest), "", "## Citation", "", CITED, "", "```bibtex", BIBTEX, "```", ""]
    lines += ["## Licence and provenance", "", f"Apache-2.0. {PROVENANCE}"]
    return "\n".join(lines) + "\n"


def croissant_text(manifest: Manifest) -> str:
    """The text of croissant.json."""
    return json.dumps(croissant(manifest), indent=1, ensure_ascii=False) + "\n"


def croissant(manifest: Manifest) -> dict[str, Any]:
    """The dataset as MLCommons Croissant 1.0 JSON-LD (http://mlcommons.org/croissant/1.0).

    Every shard is a FileObject with its checksum, the shards of a table are a FileSet, read from the folder of this
    file, and every table is a RecordSet with one field for each column.
    """
    names = [name for name in TABLES if manifest.files_of(name)]
    return {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "name": "remqa",
        "description": ABOUT,
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "license": LICENSE_URL,
        "version": "1.0.0",
        "datePublished": RELEASED,
        "citeAs": BIBTEX,
        "creator": {"@type": "sc:Organization", "name": "The remqa-data authors"},
        "distribution": [
            *(
                {
                    "@type": "cr:FileObject",
                    "@id": file.path,
                    "name": file.path,
                    "contentUrl": file.path,
                    "contentSize": f"{file.bytes} B",
                    "encodingFormat": "application/x-parquet",
                    "sha256": file.sha256,
                }
                for file in manifest.files
            ),
            *(_file_set(name) for name in names),
        ],
        "recordSet": [_record_set(TABLES[name]) for name in names],
    }


def _front_matter(manifest: Manifest, tables: list[TableSpec]) -> list[str]:
    lines = ["---", "license: apache-2.0", "pretty_name: REMQA", "language:", "- en", "task_categories:"]
    lines += ["- visual-question-answering", "- robotics", "size_categories:", f"- {_size_category(manifest)}"]
    lines += ["tags:", "- embodied-ai", "- simulation", "configs:"]
    for spec in tables:
        lines.append(f"- config_name: {spec.name}")
        lines += ["  default: true"] if spec.name == DEFAULT_TABLE else []
        lines.append("  data_files:")
        for split in manifest.splits(spec.name):
            # Hugging Face calls it "validation" too, but takes any name.
            lines += [f"  - split: {split}", f"    path: {spec.name}/{split}-*.parquet"]
    return [*lines, "---", ""]


def _size_category(manifest: Manifest) -> str:
    """What Hugging Face calls a dataset with so many questions."""
    rows = sum(manifest.rows(DEFAULT_TABLE, split) for split in manifest.splits(DEFAULT_TABLE))
    limits = {1_000: "n<1K", 10_000: "1K<n<10K", 100_000: "10K<n<100K", 1_000_000: "100K<n<1M"}
    return next((name for limit, name in limits.items() if rows < limit), "n>1M")


def _counts(manifest: Manifest, tables: list[TableSpec]) -> list[str]:
    splits = list(dict.fromkeys(split for spec in tables for split in manifest.splits(spec.name)))
    cells = [
        [f"`{spec.name}`", spec.description, *(f"{manifest.rows(spec.name, split):,}" for split in splits)]
        for spec in tables
    ]
    return _table(["Table", "Holds", *splits], cells)


def _questions(manifest: Manifest) -> list[str]:
    kinds = sorted({kind for counts in manifest.questions.values() for kind in counts})
    cells = [[split, *(f"{n.get(kind, 0):,}" for kind in kinds)] for split, n in manifest.questions.items()]
    return _table(["Questions", *kinds], cells) if kinds else []


def _snippet(manifest: Manifest, tables: list[TableSpec]) -> list[str]:
    names = [spec.name for spec in tables]
    table = names[0] if names and DEFAULT_TABLE not in names else DEFAULT_TABLE
    split = next(iter(manifest.splits(table)), "train")
    columns = '"question", "answer"' if table == DEFAULT_TABLE else '"scene", "configuration"'
    return [
        "import pandas, datasets",
        "from remqa_data.dataset import RemqaDataset",
        "",
        f'pandas.read_parquet("{table}", columns=[{columns}])',
        f'datasets.load_dataset(".", "{table}", split="{split}")  # images are decoded',
        f'RemqaDataset(".", "{split}")  # PyTorch',
    ]


@cache
def field_table(spec: TableSpec) -> tuple[str, ...]:
    """The lines of every field of a table, as a table in Markdown."""
    cells = []
    for doc in field_docs(spec.schema):
        notes = ", ".join(text for text in (doc.unit, f"{doc.frame} frame" if doc.frame else "") if text)
        cells.append([f"`{doc.path}`", doc.type, doc.description + (f" ({notes})" if notes else "")])
    return tuple(_table(["Field", "Type", "Meaning"], cells))


def _versions(manifest: Manifest) -> list[str]:
    made = ", ".join(f"{name} {version}" for name, version in manifest.versions.items())
    return [f"Seed {manifest.seed}; {made}. Configuration {manifest.config_sha256[:12]}, in `manifest.json`."]


def _table(head: list[str], cells: list[list[str]]) -> list[str]:
    rows = [head, ["---"] * len(head), *cells]
    return ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]


def _file_set(table: str) -> dict[str, Any]:
    return {
        "@type": "cr:FileSet",
        "@id": f"{table}-files",
        "name": f"{table}-files",
        "description": f"Shards of the table {table}.",
        "encodingFormat": "application/x-parquet",
        "includes": f"{table}/*.parquet",
    }


def _record_set(spec: TableSpec) -> dict[str, Any]:
    return {
        "@type": "cr:RecordSet",
        "@id": spec.name,
        "name": spec.name,
        "description": spec.description,
        "field": [entry for field in spec.schema for entry in _croissant_fields(spec.name, field, field.name)],
    }


def _croissant_fields(
    table: str, field: pa.Field, column: str, lists: tuple[str, ...] = (), path: tuple[str, ...] = ()
) -> list[dict[str, Any]]:
    """One Croissant field, or those nested in a struct; a list of structs is a repeated field with sub-fields.

    `lists` are the paths to the lists around the field, `path` is the way to it from the innermost one.
    """
    is_image = field.type == IMAGE_TYPE
    if pa.types.is_struct(field.type) and not is_image:
        return [e for child in field.type for e in _croissant_fields(table, child, column, lists, (*path, child.name))]
    is_list = pa.types.is_list(field.type)
    item = field.type.value_type if is_list else field.type
    name = "/".join((table, column, *(part for step in (*lists, *path) for part in step.split(".") if part)))
    entry = {
        "@type": "cr:Field",
        "@id": name,
        "name": name,
        "description": (field.metadata or {}).get(b"description", b"").decode(),
        **({"repeated": True} if is_list or lists else {}),
    }
    if is_list and pa.types.is_struct(item):
        around = (*lists, ".".join(path))
        inner = [e for child in item for e in _croissant_fields(table, child, column, around, (child.name,))]
        return [{**entry, "subField": inner}]
    source: dict[str, Any] = {"fileSet": {"@id": f"{table}-files"}, "extract": {"column": column}}
    # One after the other: what follows a list is taken of each of its items.
    steps = [{"jsonPath": step} for step in (*lists, ".".join((*path, "bytes") if is_image else path)) if step]
    if steps:
        source["transform"] = steps if len(steps) > 1 else steps[0]
    return [{**entry, "dataType": "sc:ImageObject" if is_image else _data_type(item), "source": source}]


def _data_type(kind: pa.DataType) -> str:
    if pa.types.is_integer(kind):
        return "sc:Integer"
    if pa.types.is_floating(kind):
        return "sc:Float"
    return "sc:Boolean" if pa.types.is_boolean(kind) else "sc:Text"


_TERMS = (
    *("citeAs", "column", "equivalentProperty", "extract", "field", "fileObject", "fileProperty", "fileSet", "format"),
    *("includes", "isLiveDataset", "jsonPath", "key", "md5", "parentField", "path", "recordSet", "references", "regex"),
    *("repeated", "replace", "samplingRate", "separator", "source", "subField", "transform"),
)
_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "dct": "http://purl.org/dc/terms/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "sc": "https://schema.org/",
    "conformsTo": "dct:conformsTo",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "examples": {"@id": "cr:examples", "@type": "@json"},
    **{term: f"cr:{term}" for term in _TERMS},
}
