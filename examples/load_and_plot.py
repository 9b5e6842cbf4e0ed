"""Read a dataset's questions, count their answers, and draw some of them with their views before and after acting.

python examples/load_and_plot.py out/tiny [OUT]      (extra: torch)
"""

# %% Where the dataset is, and where the picture goes
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from remqa_data import RemqaDataset
from remqa_data.opencv import cv2
from remqa_data.storage.manifest import load_manifest

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
data = Path(arguments[0] if arguments else "out/tiny")
out = Path(arguments[1] if arguments[1:] else "out/examples")
out.mkdir(parents=True, exist_ok=True)

# %% What is in it
manifest = load_manifest(data)
for table in ("scenes", "frames", "expressions", "questions"):
    print(f"{table:12}", {split: manifest.rows(table, split) for split in manifest.splits(table)})

# %% Answers by kind: balanced, so that who does not look is right by chance only
split = manifest.splits("questions")[-1]
texts = RemqaDataset(data, split, images=())  # decodes no picture
answers = Counter((sample["kind"], sample["answer"]) for sample in texts)
for (kind, answer), count in sorted(answers.items()):
    print(f"{kind:10} {answer:4} {'#' * round(40 * count / max(answers.values()))} {count}")

# %% One sample
questions = RemqaDataset(data, split, images=("start_rgb", "end_rgb"))
first = questions[0]
print(first["question"], "->", first["answer"])
print("target:", first["target_id"], "| act:", first["manipulation"], "| path:", first["path_length_m"], "m")

# %% Some samples as a picture: I_start with the target framed in red, I_end, question and answer
LINE_PX = 26
INK, RED = (30, 30, 30), (220, 40, 40)
rows = []
for index in np.linspace(0, len(questions) - 1, min(4, len(questions))).astype(int).tolist():
    sample = questions[index]
    before, after = (sample[name].permute(1, 2, 0).numpy().copy() for name in ("start_rgb", "end_rgb"))
    x1, y1, x2, y2 = sample["start_target_box_2d"].tolist()
    if x1 >= 0:
        cv2.rectangle(before, (x1, y1), (x2 - 1, y2 - 1), RED, 2)
    views = np.hstack([before, after])
    line = np.full((LINE_PX, views.shape[1], 3), 255, np.uint8)
    text = f"{sample['question']} {sample['answer']}"
    cv2.putText(line, text, (4, LINE_PX - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.4, INK, 1, cv2.LINE_AA)
    rows += [line, views]
cv2.imwrite(str(out / "questions.png"), np.vstack(rows)[..., ::-1])
print("wrote", out / "questions.png")
