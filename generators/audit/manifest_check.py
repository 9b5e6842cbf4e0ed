"""The manifest against the configuration in it, the card and croissant.json against the manifest, the folder against all."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from itertools import pairwise

from remqa_data.errors import ConfigError, QuotaError
from remqa_data.floorplans.sampled.naming import is_sampled
from remqa_data.floorplans.splits import expression_split, split_of
from remqa_data.generators.audit.failures import Failure
from remqa_data.generators.audit.footers import footer_problems
from remqa_data.generators.config import Config, stored_config
from remqa_data.generators.pipeline import shards_per_split
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.storage.backend import storage_at
from remqa_data.storage.card import CARD, CROISSANT, croissant_text, dataset_card
from remqa_data.storage.locks import is_lock
from remqa_data.storage.manifest import MANIFEST, FileInfo, Manifest, config_hash, versions_here
from remqa_data.storage.ownership import SPLITS
from remqa_data.storage.parts import shard_bounds, shard_path
from remqa_data.storage.shard_cache import local_shard
from remqa_data.storage.shards import Shard
from remqa_data.tables.schema import TABLES, field_docs, table_spec

BESIDES = (".gitattributes", ".gitignore")
"""Files that may lie in a dataset's folder though the manifest does not list them; so may these folders:"""
OF_DESKTOPS = (".DS_Store", "Thumbs.db", "desktop.ini")
"""Files that a file manager leaves in every folder that somebody looks into."""
FOLDERS_BESIDES = (".git", ".cache")
MOST_ASKED = 100
"""Samples of one kind with one answer that a room may be asked for."""
_VERSION = re.compile(r"\d+(\.\w+)+([-+]\S+)?", re.ASCII)


def manifest_failures(root: str | os.PathLike[str], manifest: Manifest) -> Iterator[Failure]:
    """What the manifest says and is not so, as far as it can be told from the manifest itself."""
    if storage_at(root).read(MANIFEST) != manifest.to_json().encode():
        yield Failure(MANIFEST, "consistent", "is not written as remqa-gen writes it: other keys, order or spaces")
    yield from _version_failures(manifest)
    if manifest.config_sha256 != config_hash(manifest.config):
        yield Failure(MANIFEST, "consistent", "config_sha256 is not that of the stored configuration")
    try:
        config = stored_config(manifest.config)
    except ConfigError as error:
        yield Failure(MANIFEST, "consistent", str(error))
        return
    if manifest.config != config.model_dump(mode="json"):
        yield Failure(MANIFEST, "consistent", "the stored configuration is not written as remqa-gen writes it")
    if manifest.seed != config.seed:
        yield Failure(MANIFEST, "consistent", f"seed is {manifest.seed}; the stored configuration says {config.seed}")
    asked = {
        split: dict(sorted((kind, n) for kind, n in kinds.items() if n))
        for split, kinds in config.totals.items()
        if any(kinds.values())
    }
    told = {split: {kind: n for kind, n in kinds.items() if n} for split, kinds in manifest.questions.items()}
    if told != asked:
        yield Failure(MANIFEST, "complete", f"questions are {told}; the stored configuration asks for {asked}")
    if any(count <= 0 for count in manifest.refused.values()):
        yield Failure(MANIFEST, "consistent", "refused counts are not positive")
    rows = sum(manifest.rows("scenes", split) for split in SPLITS)
    makes = len(config.scene_names) * config.configurations
    if rows != makes:  # what follows takes long for a configuration of very many rooms
        yield Failure(MANIFEST, "complete", f"files have {rows} rows of scenes; the stored configuration makes {makes}")
        return
    yield from _anew_failures(manifest, config)
    yield from _file_list_failures(manifest, config)


def _anew_failures(manifest: Manifest, config: Config) -> Iterator[Failure]:
    """Quotas that no room could have been asked for."""
    try:
        first = {quota.scene: quota for quota in allot(capacities(config.scene_names), config.totals)}
    except QuotaError as error:
        yield Failure(MANIFEST, "consistent", f"the stored configuration cannot be had: {error}")
        return
    for scene, answers in manifest.asked_anew.items():
        if scene not in first or is_sampled(scene):
            yield Failure(
                MANIFEST, "consistent", f"asked_anew names {scene!r:.60}, which is no recorded room of the dataset"
            )
            continue
        names = {kind: set(of_kind) for kind, of_kind in first[scene].answers.items()}
        counts = [count for of_kind in answers.values() for count in of_kind.values()]
        if {kind: set(of_kind) for kind, of_kind in answers.items()} != names or not all(
            0 <= n <= MOST_ASKED for n in counts
        ):
            yield Failure(
                MANIFEST, "consistent", f"asked_anew of {scene} are not numbers of answers to the kinds of question"
            )
        elif answers == first[scene].answers:
            yield Failure(MANIFEST, "consistent", f"asked_anew of {scene} is what it was asked for in the first place")


def other_versions(manifest: Manifest) -> list[str]:
    """What the dataset was made with that is not what is installed here, such as "numpy 2.2.0 (here 2.3.5)"."""
    return [
        f"{name} {manifest.versions.get(name)} (here {here})"
        for name, here in versions_here().items()
        if manifest.versions.get(name) != here
    ]


def folder_failures(root: str | os.PathLike[str], manifest: Manifest) -> Iterator[Failure]:
    """What lies in the folder and should not, or is not what the manifest makes it; shards must be whole."""
    storage = storage_at(root)
    for name, text in {CARD: dataset_card(manifest), CROISSANT: croissant_text(manifest)}.items():
        if not storage.exists(name):
            yield Failure(name, "complete", "the file is missing; remqa-gen with --resume writes it again")
        elif (found := storage.read(name)) != text.encode():
            yield Failure(name, "consistent", f"{_first_difference(found, text)} is not what the manifest makes it")
    listed = {MANIFEST, CARD, CROISSANT, *BESIDES, *(file.path for file in manifest.files)}
    for file in storage.files():
        parts = file.path.split("/")
        if not (file.path in listed or parts[0] in FOLDERS_BESIDES or parts[-1] in OF_DESKTOPS or is_lock(file)):
            yield Failure(file.path, "complete", "the manifest does not list this file; take it away")
    for path in storage.oddities():  # a listed file may be a link, as Hugging Face's cache makes them
        if path not in listed and not path.endswith("/") and path.partition("/")[0] not in FOLDERS_BESIDES:
            yield Failure(path, "complete", "the manifest does not list this link; take it away")
    for info in manifest.files:
        shard = Shard(local_shard(root, info), info.table)
        yield from (Failure(info.path, "consistent", problem) for problem in _shard_problems(shard, info, manifest))


def _shard_problems(shard: Shard, info: FileInfo, manifest: Manifest) -> Iterator[str]:
    """What a shard says of itself and is not what `remqa-gen` writes."""
    spec, schema = table_spec(info.table), shard.file.schema_arrow
    if shard.file.metadata.num_rows != info.rows:
        yield f"{shard.file.metadata.num_rows} rows; the manifest says {info.rows}"
    if schema.metadata != spec.schema.metadata or field_docs(schema) != field_docs(spec.schema):
        yield "what the columns say of themselves is not their documentation"
    sizes = [shard.rows(group) for group in range(shard.row_groups)]
    if any(size != spec.row_group_rows for size in sizes[:-1]) or any(size > spec.row_group_rows for size in sizes):
        yield f"row groups do not have {spec.row_group_rows} rows each"
    else:
        yield from footer_problems(shard, spec)
    made_by = str(shard.file.metadata.created_by)
    if not made_by.endswith(f" {manifest.versions.get('pyarrow')}"):
        yield f"it was written by {made_by:.60}, not by the manifest's pyarrow"


def _version_failures(manifest: Manifest) -> Iterator[Failure]:
    """What they should be cannot be told from a dataset alone; which there are, and that they look like versions, can."""
    known = list(versions_here())
    if list(manifest.versions) != known:
        told = ", ".join(manifest.versions) or "nothing"
        yield Failure(MANIFEST, "consistent", f"versions are those of {told}, not of {', '.join(known)}")
    for name, version in manifest.versions.items():
        if not _VERSION.fullmatch(version):
            yield Failure(MANIFEST, "consistent", f"versions.{name}: {version!r:.60} is no version")


def _file_list_failures(manifest: Manifest, config: Config) -> Iterator[Failure]:
    """The files are all shards of all tables, in order, with their shares of the rows."""
    rooms: list[tuple[str, str]] = [("scenes", split_of(name)) for name in config.scene_names]
    rooms += [("expressions", expression_split(name)) for name in config.scene_names]
    wanted = shards_per_split(rooms)
    expected = []
    for table in TABLES:
        for split in SPLITS:
            bounds = shard_bounds(manifest.rows(table, split), wanted[split])
            for number, (first, end) in enumerate(pairwise(bounds)):
                expected.append((shard_path(table, split, number, len(bounds) - 1), table, split, end - first))
    told = [(file.path, file.table, file.split, file.rows) for file in manifest.files]
    if told != expected:
        at = next(
            (i for i, (a, b) in enumerate(zip(told, expected, strict=False)) if a != b), min(len(told), len(expected))
        )
        says, should = (
            "nothing" if at >= len(files) else "{0} ({3} rows)".format(*files[at]) for files in (told, expected)
        )
        yield Failure(MANIFEST, "complete", f"files: number {at} is {says}; the rows make it {should}")


def _first_difference(found: bytes, text: str) -> str:
    """The first line in which a file differs from a text."""
    lines, right = found.decode(errors="replace").splitlines(), text.splitlines()
    at = next((i for i, (a, b) in enumerate(zip(lines, right, strict=False)) if a != b), min(len(lines), len(right)))
    return f"line {at + 1}"
