"""The environment `remqa_data/CachedRemqa-v0`: navigation over cached views, at tens of thousands of steps a second.

Importing this registers it.
"""

from remqa_data.env.cached.environment import ENV_ID, CachedRemqaEnv
from remqa_data.env.cached.vector import CachedRemqaVectorEnv

__all__ = ["ENV_ID", "CachedRemqaEnv", "CachedRemqaVectorEnv"]
