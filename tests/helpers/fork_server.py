"""Where tests fork processes from: one without threads, which has imported what most of them need.

A fork of a process that has threads waits for locks that nobody holds.
"""

import multiprocessing

FORK_SERVER = multiprocessing.get_context("forkserver")
FORK_SERVER.set_forkserver_preload(
    [
        "remqa_data.datasets.torch_datasets",
        "remqa_data.evaluation.scoring.results",
        "remqa_data.agents.cli",
        "tests.helpers.hostile_reading",
        "tests.helpers.forked_runs",
    ]
)
