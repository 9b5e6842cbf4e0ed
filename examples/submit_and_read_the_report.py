"""Record what an agent does, have it scored by replay as anybody's submission, and read the results.

python examples/submit_and_read_the_report.py out/tiny [OUT]      (extra: report)
"""

# %% The dataset
import subprocess
import sys
from pathlib import Path

import gymnasium

import remqa_data.env  # registers remqa_data/Remqa-v0
from remqa_data.env.actions import Command
from remqa_data.env.oracle import oracle_commands
from remqa_data.env.recorder import Recorder
from remqa_data.evaluation.scoring.results import load_results
from remqa_data.storage.manifest import load_manifest

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
data = Path(arguments[0] if arguments else "out/tiny")
out = Path(arguments[1] if arguments[1:] else "out/examples")
out.mkdir(parents=True, exist_ok=True)
split = load_manifest(data).splits("questions")[-1]
MOST_QUESTIONS = 3

# %% Play some questions and record them: the oracle's walk and act, but always the answer "yes"
predictions = out / "predictions.jsonl"
env = gymnasium.make("remqa_data/Remqa-v0", root=data, split=split, max_steps=500)
recorder = Recorder(env, predictions, agent="oracle that says yes")
remqa = recorder.unwrapped
assert isinstance(remqa, remqa_data.env.RemqaEnv)
every = -(-len(remqa.episode_ids) // MOST_QUESTIONS)
for question_id in remqa.episode_ids[::every]:
    recorder.reset(options={"episode": question_id})
    task = remqa.episode.task
    assert task is not None, "episodes of a dataset have a question"
    for command in oracle_commands(task):
        *_, info = recorder.step(Command(answer="yes") if command.answer else command)
    print(f"{question_id}: S_N {info['S_N']}, manipulated {info['manipulated']}, right {info['answer_accuracy']}")
recorder.close()  # writes the file
print(predictions.read_text(encoding="utf-8").splitlines()[1])

# %% Score it; in a shell: remqa-eval OUT/predictions.jsonl --data DATA --split SPLIT -o OUT/eval
command_line = [sys.executable, "-m", "remqa_data.evaluation.cli", str(predictions), "--data", str(data)]
command_line += ["--split", split, "-o", str(out / "eval"), "--workers", "1", "--quiet"]
subprocess.run(command_line, check=True)

# %% Read results.json: questions that were not submitted count as failures
results = load_results(out / "eval" / "results.json")
counts = results.counts
print(f"{counts.answered} of {counts.asked} questions were submitted; replayed: {results.replayed}")
for name in results.measures:
    metric = results.metric(name)
    print(f"{name:16}", "not measured" if metric.value is None else f"{metric.value:.3f}")
print("open", out / "eval" / "report.html")
