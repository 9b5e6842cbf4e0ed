"""The Gymnasium environment `remqa_data/Remqa-v0`: an agent in a room, with a question to answer.

Importing this registers it.
"""

from remqa_data.env.environment import ENV_ID, RemqaEnv

__all__ = ["ENV_ID", "RemqaEnv"]
