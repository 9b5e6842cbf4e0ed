"""Where the three commands begin: Ctrl-C is answered in one line while the command line itself is imported, too."""

from __future__ import annotations

from remqa_data.processes.interrupts import PromptInterrupts


def remqa_data() -> None:
    """The command `remqa-data`."""
    with PromptInterrupts("remqa-data: stopped"):
        from remqa_data.cli import main
    main()


def remqa_gen() -> None:
    """The command `remqa-gen`."""
    with PromptInterrupts("remqa-gen: stopped"):
        from remqa_data.generators.cli import main
    main()


def remqa_eval() -> None:
    """The command `remqa-eval`."""
    with PromptInterrupts("remqa-eval: stopped"):
        from remqa_data.evaluation.cli import main
    main()
