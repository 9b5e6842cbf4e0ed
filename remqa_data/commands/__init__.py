"""Where the commands begin: Ctrl-C is answered while the command line is imported and read, too, and when it has run."""

from __future__ import annotations

from importlib import import_module

from remqa_data.processes.interrupts import PromptInterrupts, ends_the_process


def remqa_data() -> None:
    """The command `remqa-data`."""
    _run("remqa-data", "remqa_data.cli")


def remqa_gen() -> None:
    """The command `remqa-gen`."""
    _run("remqa-gen", "remqa_data.generators.cli")


def remqa_eval() -> None:
    """The command `remqa-eval`."""
    _run("remqa-eval", "remqa_data.evaluation.cli")


def remqa_agent() -> None:
    """The command `remqa-agent`."""
    _run("remqa-agent", "remqa_data.agents.cli")


def _run(name: str, module: str) -> None:
    with ends_the_process(), PromptInterrupts(f"{name}: stopped"):
        import_module(module).main()
