"""What trained networks say of stored pictures, as submissions: expressions (track `rec`) and questions (track `qa`)."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import torch
from torch import nn

from remqa_data.agents.detection_scores import score_detector
from remqa_data.agents.networks.answerer import ManipulationAnswerer, likeliest
from remqa_data.agents.networks.committee import Committee, alone
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.refiner import Refiner, TwoStageDetector
from remqa_data.agents.networks.detection.regions import AnyDetector
from remqa_data.agents.networks.grounding import Grounder, grounded
from remqa_data.agents.networks.matcher import Matcher
from remqa_data.agents.training.answering import AskedViews
from remqa_data.agents.training.config import AnswererNetworkConfig, is_committee, load_committee_config
from remqa_data.agents.training.grounding import asked_frames, seen_frames
from remqa_data.agents.training.matching import Progress, frames_with_expressions, referred_pictures
from remqa_data.agents.training.weights import (
    DETECTOR,
    About,
    load_committee,
    load_trained,
    trained,
    trained_detector,
)
from remqa_data.errors import ConfigError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.evaluation.submission.tracks import Track
from remqa_data.files import atomic_path
from remqa_data.storage.manifest import load_manifest

SAYS = (Matcher, Grounder, ManipulationAnswerer, Detector, Refiner)
"""Networks that say something of a picture; of others, which walk, nothing is written."""
AT_ONCE = 16
"""Questions that are answered together."""


class Speaker(NamedTuple):
    """Who says what expressions mean.

    Attributes
    ----------
    title : str
        Of what it submits.
    committee : Committee
        Of one matcher, or several.
    about : About
        Of the first one.
    """

    title: str
    committee: Committee
    about: About


def predict_expressions(
    detector: AnyDetector,
    speakers: Sequence[Speaker],
    root: Path,
    split: str,
    device: str = "cpu",
    progress: Progress | None = None,
) -> dict[str, list[dict[str, Any]]]:
    """What matchers and committees say that the expressions of a split mean.

    Returns
    -------
    Rows of the track `rec` by title: each one's with the boxes that the detector finds, and with the true ones.
    """
    pictures = referred_pictures(frames_with_expressions(root, split), detector.to(device), device, progress)
    rows: dict[str, list[dict[str, Any]]] = {}
    for speaker in speakers:
        committee = speaker.committee.to(device)
        for which in ("detected", "true"):
            found = rows.setdefault(f"{speaker.title}, {which} boxes", [])
            for picture in pictures:
                regions = picture.found if which == "detected" else picture.true
                boxes = committee.match(picture.texts, regions).meant_in(regions) if len(regions.boxes) else None
                for place, name in enumerate(picture.expression_ids):
                    box = None if boxes is None else [float(side) for side in boxes[place]]
                    found.append({"expression_id": name, "box": box})
    return rows


@torch.no_grad()
def predict_groundings(
    detector: Detector,
    network: Grounder,
    about: About,
    root: Path,
    split: str,
    device: str = "cpu",
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """What a network says in one stage that the expressions of a split mean: rows of the track `rec`."""
    network, rows = network.to(device), []
    for frame in seen_frames(root, split, detector.to(device).eval(), device, None, progress):
        made = asked_frames([frame], about.vocabulary, device)
        found = grounded(network(made.numbers, made.sight, made.which), made.size)
        for name, one in zip(frame.expression_ids, found, strict=True):
            rows.append({"expression_id": name, "box": [float(side) for side in one.box]})
    return rows


@torch.no_grad()
def predict_answers(
    network: ManipulationAnswerer,
    about: About,
    root: Path,
    split: str,
    device: str = "cpu",
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """What an answerer says to the questions of a split, from the stored views: rows of the track `qa`."""
    config = about.network.network
    assert isinstance(config, AnswererNetworkConfig)
    views = AskedViews(root, split, with_box=config.with_box, side_px=network.side_px)
    vocabulary, rows = about.vocabulary, []
    network = network.to(device)
    for first in range(0, len(views), AT_ONCE):
        places = range(first, min(first + AT_ONCE, len(views)))
        asked = [views.view(place) for place in places]
        numbers = torch.from_numpy(vocabulary.encode_batch([one.question for one in asked])[0]).to(device)
        said = network(numbers, torch.stack([one.views for one in asked]).to(device))
        answers = likeliest(said.answers, [one.kind for one in asked], vocabulary.answers)
        for place, answer in zip(places, answers, strict=True):
            rows.append({"question_id": views.rows[place]["question_id"], "answer": answer})
        if progress is not None:
            progress(len(asked))
    return rows


def predict_all(
    names: Sequence[str],
    root: Path,
    split: str,
    out: Path,
    weights: Path | None = None,
    *,
    device: str = "cpu",
    force: bool = False,
    progress: Progress | None = None,
) -> list[Path]:
    """Let networks and committees say what they see in the pictures of a split, and write it.

    Those who refer write submissions to `<out>/rec`, answerers to `<out>/qa`, a detector and its second stage their scores to
    `<out>/detector-<split>.json` and `refiner-<split>.json`.

    Raises
    ------
    ConfigError
        If there are no such weights, they have learnt from another dataset, or they are of networks that walk.
    DatasetError
        If the dataset has no such split.
    """
    networks, speakers = _loaded(names, weights, root, force)
    written: list[Path] = []
    for network, about in networks:
        if isinstance(network, Detector | Refiner):
            written.append(out / f"{about.network.network.kind}-{split}.json")
            detector = network if isinstance(network, Detector) else _two_stages(network, weights, root, force)
            scores = score_detector(detector, about.types, root, split, device, progress=progress)
            with atomic_path(written[-1]) as temporary:
                temporary.write_text(json.dumps(scores, indent=1) + "\n", encoding="utf-8")
    for track, title, rows in _said(networks, speakers, root, split, weights, device, force, progress):
        written.append(out / track / file_name(title, split))
        write_predictions(written[-1], track, root, split, title, rows)
    return written


def _loaded(
    names: Sequence[str], weights: Path | None, root: Path, force: bool
) -> tuple[list[tuple[nn.Module, About]], list[Speaker]]:
    """Networks by their names, and all who refer to boxes that a detector finds: matchers and committees."""
    networks = [load_trained(name, weights, root, force=force) for name in names if not is_committee(name)]
    committees = [(name, load_committee_config(name).title) for name in names if is_committee(name)]
    titles = Counter([*(about.network.title for _, about in networks), *(title for _, title in committees)])
    if (title := next((title for title, count in titles.items() if count > 1), None)) is not None:
        raise ConfigError(f"several networks are called {title!r}: let them predict to folders of their own (--out)")
    speakers = [
        Speaker(about.network.title, alone(network, about.vocabulary), about)
        for network, about in networks
        if isinstance(network, Matcher)
    ]
    speakers += [Speaker(title, *load_committee(name, weights, root, force=force)) for name, title in committees]
    if not speakers and not any(isinstance(network, SAYS) for network, _ in networks):
        raise ConfigError(f"{', '.join(names)}: says nothing of stored pictures; remqa-agent run lets it walk")
    return networks, speakers


def _two_stages(refiner: Refiner, weights: Path | None, root: Path, force: bool) -> TwoStageDetector:
    """A second stage after the detector that it has learnt from."""
    return TwoStageDetector(trained(DETECTOR, Detector, weights, root, force=force), refiner)


def _said(
    networks: Sequence[tuple[nn.Module, About]],
    speakers: Sequence[Speaker],
    root: Path,
    split: str,
    weights: Path | None,
    device: str,
    force: bool,
    progress: Progress | None,
) -> Iterator[tuple[Track, str, list[dict[str, Any]]]]:
    """Each submission: its track, its title and its rows."""
    for network, about in networks:
        if isinstance(network, ManipulationAnswerer):
            yield "qa", about.network.title, predict_answers(network, about, root, split, device, progress)
    for group in _alike(speakers):
        detector = trained_detector(group[0].about.network.network, weights, root, force=force)
        for title, rows in predict_expressions(detector, group, root, split, device, progress).items():
            yield "rec", title, rows
    for network, about in networks:
        if isinstance(network, Grounder):
            features = trained(DETECTOR, Detector, weights, root, force=force)
            yield (
                "rec",
                about.network.title,
                predict_groundings(features, network, about, root, split, device, progress),
            )


def _alike(speakers: Sequence[Speaker]) -> list[list[Speaker]]:
    """Speakers in groups that see through the same: what that sees is worked out once for all of them."""
    groups: dict[tuple[str, ...], list[Speaker]] = {}
    for one in speakers:
        groups.setdefault(one.about.network.network.needs, []).append(one)
    return list(groups.values())


def write_predictions(path: Path, track: Track, root: Path, split: str, title: str, rows: list[dict[str, Any]]) -> None:
    """Write a submission; rows are put in the order of their ids."""
    header = Header(track=track, split=split, dataset=dataset_sha256(load_manifest(root)), agent=title)
    write_submission(path, header, sorted(rows, key=lambda row: str(next(iter(row.values())))))


def file_name(title: str, split: str) -> str:
    """The name of a file for a title.

    >>> file_name("BiLSTM, no modules, true boxes", "val")
    'bilstm-no-modules-true-boxes-val.jsonl'
    """
    words = "".join(letter if letter.isalnum() else " " for letter in title.lower()).split()
    return f"{'-'.join([*words, split])}.jsonl"
