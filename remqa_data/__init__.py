"""remqa-data: remote embodied manipulation question answering on PyBullet.

Importing this package is cheap: the simulator, the renderer and the data libraries load when they are used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from remqa_data.lazy import lazy_names
from remqa_data.version import __version__

if TYPE_CHECKING:
    from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset, collate
    from remqa_data.datasets.vocabulary import Vocabulary

__all__ = ["ExpressionDataset", "FrameDataset", "RemqaDataset", "Vocabulary", "__version__", "collate"]

__getattr__ = lazy_names(
    __name__,
    {
        "ExpressionDataset": "remqa_data.datasets.torch_datasets",
        "FrameDataset": "remqa_data.datasets.torch_datasets",
        "RemqaDataset": "remqa_data.datasets.torch_datasets",
        "collate": "remqa_data.datasets.torch_datasets",
        "Vocabulary": "remqa_data.datasets.vocabulary",
    },
)
"""torch loads with the first of these that is asked for."""
