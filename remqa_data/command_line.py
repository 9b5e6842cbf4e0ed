"""What the commands share: --version, --quiet, --json and --out, errors in one line, and word of what takes long.

An error on purpose (`RemqaError`), an option that cannot be, or a file that cannot be read or written becomes one line on
stderr and exit code 2. Where nobody reads on, as after `| head -1`, a command ends without a word and with exit code 141.
The library logs and never prints; what a command has to say goes through `output()`.
"""

from __future__ import annotations

import errno
import json
import logging
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer
from typer.core import TyperCommand, TyperGroup

from remqa_data.errors import RemqaError, one_line
from remqa_data.kernels.progress import Compiling, listening
from remqa_data.processes.interrupts import PromptInterrupts
from remqa_data.processes.surroundings import open_standard_streams, surroundings_problem, turn_outputs_away
from remqa_data.version import __version__

if TYPE_CHECKING:
    from rich.console import Console


STDOUT = "standard output"


@contextmanager
def on_stdout() -> Iterator[None]:
    """Let an error of what is written say where: a stream knows no name."""
    try:
        yield
    except OSError as error:
        error.filename = STDOUT
        raise


@dataclass(frozen=True)
class Output:
    """What a command says, and to whom; its options decide.

    Attributes
    ----------
    is_quiet : bool
        Nothing but errors.
    is_json : bool
        One JSON object on stdout, and nothing else there.
    """

    is_quiet: bool = False
    is_json: bool = False

    def say(self, text: str) -> None:
        """Print a line for people on stdout."""
        if not (self.is_quiet or self.is_json):
            with on_stdout():
                typer.echo(text)

    def show(self, table: Any) -> None:
        """Print something of rich on stdout."""
        from rich.console import Console

        if not (self.is_quiet or self.is_json):
            with on_stdout():
                Console().print(table)

    def note(self, text: str) -> None:
        """Print a line about progress on stderr."""
        if not self.is_quiet:
            typer.echo(text, err=True)

    def result(self, **facts: Any) -> None:
        """Print what came of the command, for programs; a path is written as text."""
        if self.is_json:
            with on_stdout():
                typer.echo(json.dumps(facts, default=str, ensure_ascii=False))

    def console(self) -> Console:
        """Where progress bars are drawn; draw none unless it `is_terminal`."""
        from rich.console import Console

        return Console(stderr=True, quiet=self.is_quiet, force_terminal=False if self.is_quiet else None)


def output() -> Output:
    """How the command that runs now speaks."""
    return _OUTPUT.get()


def announce_compiling(workers: int) -> None:
    """Say that workers will compile kernels, if they will: what other processes compile is not told while it happens."""
    from remqa_data.compiled import is_cache_empty

    if workers > 1 and is_cache_empty():
        output().note("the workers compile their kernels, once; this takes one to four minutes")


class Counting:
    """Shows on a terminal how many of some things are done; a context that gives a function to be told of more.

    Parameters
    ----------
    total : int or None
        Of all things; None if that is not known before.
    doing : str
        What is being done.
    """

    def __init__(self, total: int | None, doing: str) -> None:
        from rich.progress import Progress

        console = output().console()
        self._bar = Progress(console=console, transient=True, disable=not console.is_terminal)
        self._task = self._bar.add_task(doing, total=total)

    def __enter__(self) -> Callable[[int], None]:
        self._bar.start()
        return lambda count: self._bar.update(self._task, advance=count)

    def __exit__(self, *error: object) -> None:
        self._bar.stop()


class _PlainOptions:
    """Of commands: in --help a flag takes no value, whatever typer makes of it; and nothing that is given is empty."""

    params: list[Any]

    def get_params(self, ctx: Any) -> list[Any]:
        """All options, with --help."""
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if getattr(param, "is_flag", False):
                param.metavar = ""
        return params

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Refuse an empty text, which would be the current folder, were it made a path."""
        if not ctx.resilient_parsing:
            given = self.make_parser(ctx).parse_args(args=list(args))[0]  # type: ignore[attr-defined]
            for param in self.params:
                value = given.get(param.name)
                if value == "" or (isinstance(value, list | tuple) and "" in value):
                    name = param.opts[0] if param.param_type_name == "option" else param.metavar or param.name
                    ctx.fail(f"{name} is empty; give a value")
        with on_stdout():  # help and versions
            return super().parse_args(ctx, args)  # type: ignore[misc]


class _Command(_PlainOptions, TyperCommand):
    """One of several commands."""


class OneLineErrors(_PlainOptions, TyperGroup):
    """Commands whose errors on purpose become one line on stderr and exit code 2; they stop at once when told to.

    The group has --version, and all its commands have --quiet and --json.
    """

    when_stopped = "stopped"
    """What to say to Ctrl-C and SIGTERM."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.params += _options(_version)
        for command in (self, *self.commands.values()):
            command.params += _options(_speech)

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """Read the command line, with no option given yet."""
        _OUTPUT.set(Output())
        with self._errors_in_one_line():
            return super().make_context(*arguments, **options)

    def main(self, args: Sequence[str] | None = None, *others: Any, **options: Any) -> Any:
        """Run the command line, unless nothing can come of it here."""
        open_standard_streams()
        problem = surroundings_problem(sys.argv[1:] if args is None else args)
        if problem is not None:
            typer.echo(f"{self.name}: {problem}", err=True)
            raise SystemExit(2)
        try:
            return super().main(args, *others, **options)
        except SystemExit as error:
            if not isinstance(error.__context__, BrokenPipeError):
                raise
            turn_outputs_away()
            raise SystemExit(PIPE_CLOSED) from None

    def invoke(self, ctx: Any) -> Any:
        """Run the command that was named."""
        logging.getLogger("remqa_data").addHandler(_LOGGED)
        with (
            self._errors_in_one_line(),
            PromptInterrupts(f"{self.name}: {self.when_stopped}"),
            listening(_tell_compiling),
        ):
            return super().invoke(ctx)

    @contextmanager
    def _errors_in_one_line(self) -> Iterator[None]:
        """Say in one line what went wrong, with an option, too; a command line without any words asks for help."""
        try:
            yield
        except BrokenPipeError:
            raise  # nobody reads on: typer makes a SystemExit of it, as rich does
        except (RemqaError, OSError, RuntimeError) as error:
            if isinstance(error, RuntimeError) and _NO_THREAD not in str(error):
                raise
            typer.echo(f"{self.name}: {one_line(_in_words(error))}", err=True)
            raise typer.Exit(2) from error
        except _UsageError as error:
            if type(error).__name__ == "NoArgsIsHelpError":
                raise
            command = error.ctx.command_path if error.ctx else self.name
            typer.echo(f"{command}: {one_line(error.format_message()).rstrip('.')}; see {command} --help", err=True)
            raise typer.Exit(2) from error


F = TypeVar("F", bound=Callable[..., Any])


class _Commands(typer.Typer):
    """Commands with plain options."""

    def command(self, name: str | None = None, **options: Any) -> Callable[[F], F]:
        """Add a function as a command."""
        return super().command(name, **{"cls": _Command, **options})


def command_group(name: str, cls: type[OneLineErrors] = OneLineErrors, *, no_args_is_help: bool = True) -> typer.Typer:
    """Commands of this package, to be filled."""
    return _Commands(
        name=name,
        cls=cls,
        no_args_is_help=no_args_is_help,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "token_normalize_func": _shown_name},
    )


def out_option(metavar: str, about: str) -> Any:
    """The option for what a command writes: in all of them --out and -o, and --output, which no help shows."""
    return typer.Option("--out", "-o", metavar=metavar, help=about)


def listed(text: str) -> tuple[str, ...]:
    """What an option lists with commas.

    >>> listed("FloorPlan4, FloorPlan212")
    ('FloorPlan4', 'FloorPlan212')
    """
    return tuple(item.strip() for item in text.split(","))


_UsageError: Any = typer.BadParameter.__base__
"""Of the Click that typer uses: its own one, or in older versions the installed one."""
_PLAIN = Output()
_OUTPUT: ContextVar[Output] = ContextVar("output", default=_PLAIN)


def _shown_name(option: str) -> str:
    """An option's name without its dashes, as help shows it."""
    return "out" if option == "output" else option


def _print_version(ctx: typer.Context, wanted: bool) -> None:
    if wanted:
        typer.echo(f"{ctx.command.name} {__version__}")
        raise typer.Exit


def _be_quiet(wanted: bool) -> None:
    _OUTPUT.set(replace(_OUTPUT.get(), is_quiet=_OUTPUT.get().is_quiet or wanted))


def _speak_json(wanted: bool) -> None:
    _OUTPUT.set(replace(_OUTPUT.get(), is_json=_OUTPUT.get().is_json or wanted))


def _options(function: Callable[..., None]) -> list[Any]:
    """The options of a function, to be added to commands that it knows nothing of."""
    app = typer.Typer(add_completion=False)
    app.command()(function)
    return list(typer.main.get_command(app).params)


def _version(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True, expose_value=False
        ),
    ] = False,
) -> None: ...


def _speech(
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print errors only.", callback=_be_quiet, expose_value=False)
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object.", callback=_speak_json, expose_value=False)
    ] = False,
) -> None: ...


class _Logged(logging.Handler):
    """Warnings of the library, a line each on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        output().note(record.getMessage())


_LOGGED = _Logged(logging.WARNING)


def _tell_compiling(kernel: Compiling) -> None:
    """How far the compiler is: a line that counts on a terminal, else one when it begins."""
    console = output().console()
    if console.is_terminal:
        end = "\n" if kernel.number == kernel.known else ""
        console.file.write(f"\rcompiling kernels, once: {kernel.number} of {kernel.known}{end}")
        console.file.flush()
    elif kernel.number == 1:
        output().note(
            f"compiling {kernel.known} kernels, once; this takes one to four minutes, and what is done is kept"
        )


PIPE_CLOSED = 141
"""Exit code of a command that nobody listens to any more: 128 and the number of SIGPIPE, as shells have it."""
_NOT_OF_THE_PATH = (errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.ENOMEM)
"""What another path would not mend: limits of the process or the machine."""
_NO_THREAD = "can't start new thread"
"""What Python says when the system refuses."""


def _in_words(error: Exception) -> str:
    """What is wrong, where first; without the number that the system gives it."""
    if isinstance(error, OSError) and error.errno is not None and error.strerror:
        what = os.strerror(error.errno)
        hint = "" if error.filename == STDOUT or error.errno in _NOT_OF_THE_PATH else "; choose another path"
        return what if error.filename is None else f"{error.filename}: {what}{hint}"
    if _NO_THREAD in str(error):
        return "the system starts no more threads (ulimit -u)"
    return str(error)
