"""From the configuration of a network to its weights."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import torch

from remqa_data.agents.networks.actor_critic import ActorCritic
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.refiner import Refiner
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.adapting import AdaptingTask
from remqa_data.agents.training.answering import AnsweringTask
from remqa_data.agents.training.config import (
    SUFFIX,
    AdaptiveWalkerConfig,
    AnswererNetworkConfig,
    DetectorConfig,
    ImitatorNetworkConfig,
    MatcherConfig,
    Network,
    NetworkConfig,
    RefinerConfig,
    ViewEncoderConfig,
    WalkerConfig,
)
from remqa_data.agents.training.detection import DetectionTask, RefinementTask
from remqa_data.agents.training.grounding import GroundingTask
from remqa_data.agents.training.imitating import ImitationTask
from remqa_data.agents.training.matching import Looks, MatchingTask
from remqa_data.agents.training.pictures import detector_types
from remqa_data.agents.training.reinforcing import ReinforcingTask
from remqa_data.agents.training.trainer import CHECKPOINT, Schedule, Task, deterministic, train
from remqa_data.agents.training.viewing import ViewingTask
from remqa_data.agents.training.weights import (
    DETECTOR,
    About,
    halved,
    load_network,
    save_network,
    trained,
    trained_detector,
    weights_path,
)
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.files import check_is_new, sha256_of
from remqa_data.storage.manifest import load_manifest
from remqa_data.views import views_beside

OF_PICTURES = (DetectionTask, RefinementTask, ViewingTask, AnsweringTask)
"""Tasks whose batches are pictures, which any process can make."""


def check_places(names: Iterable[str], folder: Path, *, overwrite: bool, resume: bool) -> None:
    """Refuse to write over what networks of some names have learnt, be it finished or not.

    Raises
    ------
    ConfigError
        If there is any, and neither overwriting nor resuming was asked for.
    """
    for name in names:
        places = (folder / f"{name}{SUFFIX}", folder / name / CHECKPOINT)
        check_is_new(folder / name, places, "trained", overwrite=overwrite, resume=resume)


def learn(
    name: str,
    config: NetworkConfig,
    roots: Sequence[Path],
    folder: Path,
    *,
    views: Path | None = None,
    device: str = "cpu",
    workers: int = 0,
    resume: bool = False,
    looks: dict[str, Looks] | None = None,
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
    views : path, optional
        The cached views of the first dataset, for those who learn to walk; by default the folder beside it.
    device : str
        Where to compute: "cpu" or, say, "cuda".
    workers : int
        Processes that make batches of pictures ahead, for a GPU that would wait for them; other networks learn without.
    resume : bool
        Go on with an interrupted run, if there is one; what is finished is not done again.
    looks : dict, optional
        What the last matcher has looked at, by what it saw through; is not looked at again, and what is, is put there. Takes
        some 350 kB a picture.
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
    needs, began_with = (
        {other: sha256_of(weights_path(other, folder)) for other in others}
        for others in (network.needs, network.began_with)
    )
    path = folder / f"{name}{SUFFIX}"
    if resume and path.is_file():
        _, about = load_network(path)
        if (about.network, about.datasets, about.needs, about.began_with) == (config, datasets, needs, began_with):
            return about
    fingerprint = json.dumps([config.sha256, datasets, needs, began_with])
    schedule = Schedule(**config.schedule.model_dump())
    with deterministic(device):
        task = _task(
            network, config.schedule.seed, roots, folder, views, device, {} if looks is None else looks, on_look
        )
        progress = on_learn(schedule.samples(len(task))) if on_learn else None
        score = train(
            task,
            schedule,
            folder / name,
            fingerprint=fingerprint,
            resume=resume,
            device=device,
            workers=workers if isinstance(task, OF_PICTURES) else 0,
            progress=progress,
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
        began_with,
    )
    save_network(path, task.model, about)
    return about


def _task(
    network: Network,
    seed: int,
    roots: Sequence[Path],
    folder: Path,
    views: Path | None,
    device: str,
    looks: dict[str, Looks],
    on_look: Callable[[int], None] | None,
) -> Task:
    """What is learnt; the network begins with random weights."""
    if isinstance(network, DetectorConfig):
        torch.manual_seed(seed)
        return DetectionTask(roots, network.side_px, device)
    if isinstance(network, WalkerConfig | AdaptiveWalkerConfig | ImitatorNetworkConfig):
        views = views or views_beside(roots[0])
        encoder = trained("view_encoder", ViewEncoder, folder, roots[0])
        if isinstance(network, AdaptiveWalkerConfig):
            before = trained(network.begins_with, ActorCritic, folder, roots[0])
            torch.manual_seed(seed)
            return AdaptingTask(roots, views, before, encoder, network.walks, device)
        torch.manual_seed(seed)
        if isinstance(network, ImitatorNetworkConfig):
            return ImitationTask(roots, views, network.form, encoder, network.walks, device)
        return ReinforcingTask(roots, views, network.form, encoder, network.walks, device)
    if isinstance(network, MatcherConfig):
        through = json.dumps([device, *(sha256_of(weights_path(name, folder)) for name in network.needs)])
        if through not in looks:
            looks.clear()  # they are large
            looks[through] = Looks(trained_detector(network, folder, roots[0]), device)
        torch.manual_seed(seed)
        return MatchingTask(roots, network, looks[through], on_look)
    detector = trained(DETECTOR, Detector, folder, roots[0])
    torch.manual_seed(seed)
    if isinstance(network, RefinerConfig):
        return RefinementTask(roots, network.side_px, detector, device)
    if isinstance(network, ViewEncoderConfig):
        return ViewingTask(roots, detector, device)
    if isinstance(network, AnswererNetworkConfig):
        if network.refiner:
            refiner = trained(network.refiner, Refiner, folder, roots[0])
            detector.backbone.load_state_dict(refiner.backbone.state_dict())
        return AnsweringTask(
            roots,
            network.views,
            network.with_box,
            detector,
            device,
            side_px=network.side_px,
            questions=network.questions,
        )
    return GroundingTask(roots, network.form, detector, device, on_look)
