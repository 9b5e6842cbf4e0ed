"""The rooms behind AI2-THOR's own Controller: code that was written for AI2-THOR runs here unchanged.

Importing this package needs the extra `thor`.
"""

from remqa_data.extras import require

require("ai2thor", "thor")

from remqa_data.thor.controller import Controller  # noqa: E402

__all__ = ["Controller"]
