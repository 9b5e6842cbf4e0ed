"""The backbone that all networks share: a small residual network with a feature pyramid."""

from __future__ import annotations

from typing import cast

import torch
from torch import Tensor, nn
from torch.nn import functional

STRIDE = 4
"""Pixels of the picture for each cell of the features."""

WIDTHS = (16, 24, 48, 96, 128)
"""Channels of the stages, each half as wide and high as the one before."""

DEPTHS = (1, 2, 2, 1)
"""Residual blocks of the stages from the second on."""

NECK = 32
"""Channels of the pyramid."""

CHANNELS = 64
"""Channels of the features."""

MEAN = (0.48, 0.44, 0.39)
SPREAD = (0.25, 0.25, 0.25)
"""Of red, green and blue in our rooms, roughly."""


class Pyramid(nn.Module):
    """Features of pictures.

    A residual network (He et al. 2016) down to a 32nd of the size, and from there back up to a quarter, adding what was
    found at each size (feature pyramid, Lin et al. 2017): 0.5 G multiply-adds for a picture of 300 x 300, 0.9 M parameters.
    """

    def __init__(self) -> None:
        super().__init__()
        self.stem = conv_block(3, WIDTHS[0], stride=2)
        self.stages = nn.ModuleList(
            nn.Sequential(conv_block(before, after, stride=2), *(Residual(after) for _ in range(depth)))
            for before, after, depth in zip(WIDTHS[:-1], WIDTHS[1:], DEPTHS, strict=True)
        )
        self.laterals = nn.ModuleList(nn.Conv2d(width, NECK, 1) for width in WIDTHS[1:])
        self.out = conv_block(NECK, CHANNELS)

    def forward(self, rgb: Tensor) -> Tensor:
        """Features of pictures.

        Parameters
        ----------
        rgb : (n, 3, h, w) uint8
            Pictures.

        Returns
        -------
        (n, CHANNELS, h / STRIDE, w / STRIDE) float32, sizes rounded up.
        """
        x = self.stem(normalised(rgb).contiguous(memory_format=torch.channels_last))
        found = []
        for stage in self.stages:
            x = stage(x)
            found.append(x)
        neck = self.laterals[-1](found[-1])
        for lateral, features in zip(list(self.laterals)[-2::-1], found[-2::-1], strict=True):
            neck = lateral(features) + functional.interpolate(neck, size=features.shape[-2:])
        return cast("Tensor", self.out(neck))


class Residual(nn.Module):
    """Two convolutions beside a shortcut."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = conv_block(channels, channels)
        self.second = nn.Sequential(nn.Conv2d(channels, channels, 3, padding=1, bias=False), nn.BatchNorm2d(channels))

    def forward(self, x: Tensor) -> Tensor:
        """(n, channels, h, w) to the same."""
        return functional.relu(x + self.second(self.first(x)))


def zero_linear(inputs: int, outputs: int) -> nn.Linear:
    """A layer that says 0 of everything at first."""
    layer = nn.Linear(inputs, outputs)
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer


def conv_block(before: int, after: int, stride: int = 1) -> nn.Sequential:
    """A 3 x 3 convolution, normalised over the batch, with a ReLU."""
    return nn.Sequential(
        nn.Conv2d(before, after, 3, stride=stride, padding=1, bias=False),
        nn.BatchNorm2d(after),
        nn.ReLU(inplace=True),
    )


def normalised(rgb: Tensor) -> Tensor:
    """(n, 3, h, w) uint8 pictures as float32 around 0."""
    mean, spread = (rgb.new_tensor(figures, dtype=torch.float32).view(1, 3, 1, 1) for figures in (MEAN, SPREAD))
    return (rgb.to(torch.float32) / 255 - mean) / spread


def features_in(features: Tensor, boxes: Tensor, size: int, cell_px: float = STRIDE) -> Tensor:
    """Features at a grid of points in each of some boxes, by bilinear interpolation.

    Parameters
    ----------
    features : (n, c, h, w) float32
        Of `Pyramid`.
    boxes : (n, k, 4) float32
        x1, y1, x2, y2 in pixels of the pictures: k boxes in each.
    size : int
        Points across and down, at the middles of equal parts of the box.
    cell_px : float
        Pixels for each cell of the features.

    Returns
    -------
    (n, k, c, size, size) float32
    """
    count, each = boxes.shape[:2]
    height, width = features.shape[-2:]
    steps = (torch.arange(size, device=boxes.device, dtype=boxes.dtype) + 0.5) / size
    x1, y1, x2, y2 = boxes[..., None].unbind(2)
    x, y = (x1 + steps * (x2 - x1)) / (width * cell_px) * 2 - 1, (y1 + steps * (y2 - y1)) / (height * cell_px) * 2 - 1
    across, down = x[:, :, None].expand(-1, -1, size, -1), y[..., None].expand(-1, -1, -1, size)
    points = torch.stack([across, down], dim=-1).view(count, each * size, size, 2)
    found = functional.grid_sample(features, points, align_corners=False)
    return found.view(count, features.shape[1], each, size, size).transpose(1, 2)
