"""remqa-data: remote embodied manipulation question answering on PyBullet.

Importing this package is cheap: the simulator, the renderer and the data libraries load when they are used.
"""

from remqa_data.version import __version__

__all__ = ["__version__"]
