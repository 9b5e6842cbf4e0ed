"""Where the commands begin: Ctrl-C is answered while the command line is imported and read, too, and when it has run."""

from __future__ import annotations

from remqa_data.processes.interrupts import PromptInterrupts, ends_the_process


def remqa_data() -> None:
    """The command `remqa-data`."""
    with ends_the_process(), PromptInterrupts("remqa-data: stopped"):
        from remqa_data.cli import main

        main()


def remqa_gen() -> None:
    """The command `remqa-gen`."""
    with ends_the_process(), PromptInterrupts("remqa-gen: stopped"):
        from remqa_data.generators.cli import main

        main()


def remqa_eval() -> None:
    """The command `remqa-eval`."""
    with ends_the_process(), PromptInterrupts("remqa-eval: stopped"):
        from remqa_data.evaluation.cli import main

        main()


def remqa_agent() -> None:
    """The command `remqa-agent`."""
    with ends_the_process(), PromptInterrupts("remqa-agent: stopped"):
        from remqa_data.agents.cli import main

        main()
