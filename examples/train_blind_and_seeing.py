"""Train two small networks for a few steps: one reads the question's words alone, one sees both views, too.

python examples/train_blind_and_seeing.py out/tiny [STEPS]      (extra: torch)

Answers are balanced so that words alone tell nothing: what the blind one learns by heart does not help it in other rooms.
A tiny dataset and a few steps teach the seeing one nothing either; docs/AGENTS.md has networks that learn.
"""

# %% The dataset
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.utils.data import DataLoader

from remqa_data import RemqaDataset, Vocabulary, collate
from remqa_data.storage.manifest import load_manifest

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
data = Path(arguments[0] if arguments else "out/tiny")
steps = int(arguments[1]) if arguments[1:] else 20
torch.manual_seed(0)

SIZE_PX = 64
needed = {"columns": ("question", "answer"), "images": ("start_rgb", "end_rgb")}
train = RemqaDataset(data, "train", **needed)
vocabulary = Vocabulary.from_dataset(data)
print(len(train), "train questions,", len(vocabulary.words), "words, answers:", ", ".join(vocabulary.answers))


# %% A batch as tensors: numbers of words, the views before and after, numbers of answers
def tensors(batch: Mapping[str, Any]) -> tuple[Tensor, Tensor, Tensor]:
    words = torch.from_numpy(vocabulary.encode_batch(batch["question"])[0])
    views = torch.cat([batch["start_rgb"], batch["end_rgb"]], dim=1).float() / 255  # (n, 6, H, W)
    views = functional.interpolate(views, size=(SIZE_PX, SIZE_PX), mode="area")
    unknown = len(vocabulary.answers)  # an answer that no train question has; nothing is ever right about it
    known = {answer: number for number, answer in enumerate(vocabulary.answers)}
    return words, views, torch.tensor([known.get(answer, unknown) for answer in batch["answer"]])


# %% Both networks are this one
class Answerer(nn.Module):
    """Answers from the mean of the words and, if it sees, from a small convolutional network's features."""

    def __init__(self, sees: bool, width: int = 64) -> None:
        super().__init__()
        self.words = nn.EmbeddingBag(len(vocabulary.words), width, padding_idx=0)
        layers: list[nn.Module] = []
        for before, after in ((6, 16), (16, 32), (32, width)):
            layers += [nn.Conv2d(before, after, 3, stride=2, padding=1), nn.ReLU()]
        self.eye = nn.Sequential(*layers, nn.AdaptiveAvgPool2d(1), nn.Flatten()) if sees else None
        self.answer = nn.Linear(2 * width if sees else width, len(vocabulary.answers))

    def forward(self, words: Tensor, views: Tensor) -> Tensor:
        features = self.words(words)
        if self.eye is not None:
            features = torch.cat([features, self.eye(views)], dim=1)
        scores: Tensor = self.answer(features)
        return scores


def accuracy(network: Answerer, questions: RemqaDataset) -> float:
    right = 0
    with torch.no_grad():
        for batch in DataLoader(questions, batch_size=16, collate_fn=collate):
            words, views, answers = tensors(batch)
            right += int((network(words, views).argmax(dim=1) == answers).sum())
    return right / len(questions)


# %% Train them
networks = {"blind": Answerer(sees=False), "seeing": Answerer(sees=True)}
for name, network in networks.items():
    optimizer = torch.optim.Adam(network.parameters(), lr=3e-3)
    done = 0
    while done < steps:
        for batch in DataLoader(train, batch_size=8, shuffle=True, collate_fn=collate):
            words, views, answers = tensors(batch)
            loss = functional.cross_entropy(network(words, views), answers)
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            done += 1
            if done in (1, steps):
                print(f"{name:8} step {done:3}  loss {loss.item():.3f}")
            if done == steps:
                break

# %% How often they are right, in rooms they have seen and in others
for split in load_manifest(data).splits("questions"):
    questions = RemqaDataset(data, split, **needed)
    shares = {name: f"{accuracy(network, questions):.2f}" for name, network in networks.items()}
    print(f"{split:6}", *(f"{name} {share}" for name, share in shares.items()))
