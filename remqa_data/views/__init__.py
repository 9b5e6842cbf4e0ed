"""Cached views: what the agent sees at every pose that it can reach, drawn once and read by millions of steps.

`build.cache_views` makes a cache of a dataset's rooms, `reader.Views` reads it, and `remqa_data.env.cached` plays it.
"""

from __future__ import annotations

from pathlib import Path

from remqa_data.files import beside

SIZE_PX = 84
"""Width and height of the frames: what agents that learn from pixels are given since DQN (Mnih et al., Nature 518, 2015)."""
LEAST_PX, MOST_PX = 16, 256
"""Of the same; `arrays` numbers the pixels of a frame with 16 bits."""


def views_beside(root: Path) -> Path:
    """The folder beside a dataset where its cache is by default."""
    return beside(root, "views")
