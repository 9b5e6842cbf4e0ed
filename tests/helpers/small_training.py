"""A training of a second: `python -m tests.helpers.small_training FOLDER [PAUSE_S]` prints a checksum of its weights."""

import hashlib
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from remqa_data.agents.training.trainer import Schedule, train

SCHEDULE = Schedule(epochs=4, batch_size=8, learning_rate=0.01, weight_decay=0.0, seed=3)


class Sums:
    """Learns to add two numbers, each drawn; a pause after each batch makes it slow enough to be killed."""

    def __init__(self, pause_s: float = 0.0) -> None:
        torch.manual_seed(SCHEDULE.seed)
        self.model = nn.Sequential(nn.Linear(2, 8), nn.Dropout(0.1), nn.ReLU(), nn.Linear(8, 1))
        self.pause_s, self.drawn = pause_s, 0

    def __len__(self) -> int:
        return 80

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Tensor:
        self.drawn += len(samples)
        time.sleep(self.pause_s)
        return torch.from_numpy(np.array([rng.uniform(-1, 1, 2) for rng in rngs], dtype=np.float32))

    def losses(self, batch: Tensor) -> Mapping[str, Tensor]:
        return {"loss": (self.model(batch)[:, 0] - batch.sum(1)).square().mean()}

    def score(self) -> Mapping[str, float]:
        pairs = torch.tensor([[0.5, 0.2], [-0.4, 0.1]])
        return {"val_error": float((self.model(pairs)[:, 0] - pairs.sum(1)).abs().mean())}


def checksum(model: nn.Module) -> str:
    return hashlib.sha256(b"".join(t.numpy().tobytes() for t in model.state_dict().values())).hexdigest()


if __name__ == "__main__":
    task = Sums(float(sys.argv[2]) if len(sys.argv) > 2 else 0.0)
    train(task, SCHEDULE, Path(sys.argv[1]), resume=True, checkpoint_s=0.0)
    print(checksum(task.model))
