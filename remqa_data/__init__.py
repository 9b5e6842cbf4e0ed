"""remqa-data: remote embodied manipulation question answering on PyBullet.

Importing this package is cheap: the simulator, the renderer and the data libraries load when they are used.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from remqa_data.lazy import lazy_names
from remqa_data.version import __version__

if TYPE_CHECKING:
    from remqa_data.datasets.torch_datasets import ExpressionDataset, FrameDataset, RemqaDataset, collate
    from remqa_data.datasets.vocabulary import Vocabulary

__all__ = ["ExpressionDataset", "FrameDataset", "RemqaDataset", "Vocabulary", "__version__", "collate"]

if find_spec("remqa_data.templates") is None:
    msg = (
        "remqa_data.templates is not there: this checkout has no symbolic links. Run `pip install .` (or `pip install "
        "--editable .`) in it, which needs none, or `git config core.symlinks true && git checkout -- remqa_data`"
    )
    raise ImportError(msg)

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
