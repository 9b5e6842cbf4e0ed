"""remqa-data: remote embodied manipulation question answering on PyBullet.

Importing this package is cheap: the simulator, the renderer and the data libraries load when they are used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from remqa_data.version import __version__

if TYPE_CHECKING:
    from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset, collate
    from remqa_data.datasets.vocabulary import Vocabulary

__all__ = ["ExpressionDataset", "FrameDataset", "RemqaDataset", "Vocabulary", "__version__", "collate"]

_HOMES = {
    "ExpressionDataset": "remqa_data.datasets.torch_datasets",
    "FrameDataset": "remqa_data.datasets.torch_datasets",
    "RemqaDataset": "remqa_data.datasets.torch_datasets",
    "collate": "remqa_data.datasets.torch_datasets",
    "Vocabulary": "remqa_data.datasets.vocabulary",
}


def __getattr__(name: str) -> Any:
    """Load what is asked for, and torch with it, only then."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
