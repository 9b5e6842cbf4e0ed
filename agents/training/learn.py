"""From the configuration of a network to its weights."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import torch

from remqa_data.agents.networks.detector import Detector
from remqa_data.agents.training.answering import AnsweringTask
from remqa_data.agents.training.config import (
    AnswererConfig,
    DetectorConfig,
    MatcherConfig,
    NetworkConfig,
    ViewEncoderConfig,
)
from remqa_data.agents.training.detection import DetectionTask
from remqa_data.agents.training.matching import MatchingTask
from remqa_data.agents.training.pictures import detector_types
from remqa_data.agents.training.trainer import Schedule, train
from remqa_data.agents.training.viewing import ViewingTask
from remqa_data.agents.training.weights import (
    SUFFIX,
    About,
    halved,
    load_network,
    save_network,
    weights_path,
)
from remqa_data.errors import ConfigError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.files import sha256_of
from remqa_data.storage.manifest import load_manifest

DETECTOR = "detector"
"""The network that all others are built upon."""


def learn(
    name: str,
    config: NetworkConfig,
    roots: Sequence[Path],
    folder: Path,
    *,
    device: str = "cpu",
    resume: bool = False,
    on_look: Callable[[int], None] | None = None,
    on_learn: Callable[[int], Callable[[int], None]] | None = None,
) -> About:
    """Train a network and write its weights to `<folder>/<name>.safetensors`.

    Parameters
    ----------
    name : str
        Of the weights.
    config : NetworkConfig
        What to train.
    roots : sequence of path
        Datasets to learn from; the val rooms of the first give the score, and no val or test room of any is learnt from.
    folder : path
        For the weights; its folder `<name>` has the checkpoint and the curves.
    device : str
        Where to compute: "cpu" or, say, "cuda".
    resume : bool
        Go on with an interrupted run, if there is one; what is finished is not done again.
    on_look : callable, optional
        Called with the number of pictures that a detector has looked at, before a matcher learns.
    on_learn : callable, optional
        Gets the number of samples of the whole training when it begins, and gives what is called with those learnt from.

    Returns
    -------
    What the weights say of themselves.
    """
    network = config.network
    datasets = tuple(dataset_sha256(load_manifest(root)) for root in roots)
    needs = {} if isinstance(network, DetectorConfig) else {DETECTOR: sha256_of(weights_path(DETECTOR, folder))}
    path = folder / f"{name}{SUFFIX}"
    if resume and path.is_file():
        _, about = load_network(path)
        if (about.network, about.datasets, about.needs) == (config, datasets, needs):
            return about
    task = _task(network, config.schedule.seed, roots, folder, device, on_look)
    fingerprint = json.dumps([config.sha256, datasets, needs])
    schedule = Schedule(**config.schedule.model_dump())
    progress = on_learn(schedule.samples(len(task))) if on_learn else None
    score = train(
        task, schedule, folder / name, fingerprint=fingerprint, resume=resume, device=device, progress=progress
    )
    halved(task.model)
    with torch.no_grad():
        score |= task.score()
    vocabulary = getattr(task, "vocabulary", None)
    about = About(
        config.model_dump(mode="json"),
        datasets,
        detector_types(),
        vocabulary.words if vocabulary else (),
        vocabulary.answers if vocabulary else (),
        {key: round(value, 4) for key, value in score.items()},
        needs,
    )
    save_network(path, task.model, about)
    return about


def _task(
    network: DetectorConfig | MatcherConfig | AnswererConfig | ViewEncoderConfig,
    seed: int,
    roots: Sequence[Path],
    folder: Path,
    device: str,
    on_look: Callable[[int], None] | None,
) -> DetectionTask | MatchingTask | AnsweringTask | ViewingTask:
    """What is learnt; the network begins with random weights."""
    if isinstance(network, DetectorConfig):
        torch.manual_seed(seed)
        return DetectionTask(roots, network.side_px, device)
    detector = _detector(folder, roots[0])
    torch.manual_seed(seed)
    if isinstance(network, ViewEncoderConfig):
        return ViewingTask(roots, detector, device)
    if isinstance(network, AnswererConfig):
        return AnsweringTask(roots, network.views, network.with_box, detector, device)
    return MatchingTask(roots, network.form, detector, device, on_look)


def _detector(folder: Path, root: Path) -> Detector:
    """The detector that the other networks are built upon."""
    path = weights_path(DETECTOR, folder)
    detector, _ = load_network(path, root)
    if not isinstance(detector, Detector):
        raise ConfigError(f"{path} is no detector")
    return detector
