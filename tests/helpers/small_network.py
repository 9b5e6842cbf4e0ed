"""Backbones for tests of cached features: a small network of torch, and functions that give what cannot be kept."""

from functools import cache

import numpy as np


@cache
def network():
    import torch

    torch.manual_seed(0)
    return torch.nn.Sequential(
        torch.nn.Conv2d(3, 4, 5, stride=4), torch.nn.ReLU(), torch.nn.AdaptiveAvgPool2d(2), torch.nn.Flatten()
    ).eval()


def features(frames: np.ndarray) -> np.ndarray:
    """(n, 16) float32."""
    import torch

    with torch.inference_mode():
        pictures = torch.from_numpy(frames).permute(0, 3, 1, 2).float() / 255
        return network()(pictures).numpy()


def brightness(frames: np.ndarray) -> np.ndarray:
    return frames.mean(axis=(1, 2))


def too_large(frames: np.ndarray) -> np.ndarray:
    return np.full((len(frames), 2), 1e6)


def one_for_all(frames: np.ndarray) -> np.ndarray:
    return np.zeros((1, 2))


NO_FUNCTION = 3
