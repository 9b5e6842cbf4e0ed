"""Features of cached views by the view encoder: `remqa-data cache DIR --features remqa_data.agents.view_features:features`."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.weights import load_network, weights_path
from remqa_data.errors import ConfigError
from remqa_data.geometry.types import U8

VIEW_ENCODER = "view_encoder"
WEIGHTS = "REMQA_WEIGHTS"
"""Environment variable: the folder with weights that come before those of the package."""


def features(frames: U8) -> npt.NDArray[np.float16]:
    """(n, PARTS^2, CHANNELS) features of the parts of (n, h, w, 3) frames.

    Raises
    ------
    ConfigError
        If there are no weights of a view encoder.
    """
    with one_thread():
        found: npt.NDArray[np.float16] = _encoder().encode(frames).numpy().astype(np.float16)
    return found


@lru_cache(maxsize=1)
def _encoder() -> ViewEncoder:
    folder = Path(os.environ.get(WEIGHTS, "out/weights"))
    path = weights_path(VIEW_ENCODER, folder)
    encoder, _ = load_network(path)
    if not isinstance(encoder, ViewEncoder):
        raise ConfigError(f"{path} is no view encoder")
    return encoder
