"""Command lines of the project: typer for the options, one line for an error."""

import io
import itertools
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, NoReturn, TextIO

import typer

from common.spelling import one_line

PROGRAM = "plume-flight"
"""Name of the console command."""

BAD_INPUT, INTERRUPTED, UNREAD = 2, 130, 141
"""Exit statuses: of input that is refused, and of a command that Ctrl-C ended or that lost the
reader of its output: 128 and the number of the signal, as in a shell."""

_USAGE_ERROR: type[Exception] = typer.BadParameter.__bases__[0]
"""Base class of the errors that typer raises for bad options, which it does not export."""


def run_command(
    command: Callable[..., None] | Mapping[str, Callable[..., None]], name: str, version: str = ""
) -> None:
    """Run a command as a command line called ``name`` and exit with its status, 2 for bad options.

    Parameters
    ----------
    command : the only one, or commands by the words that choose them
    name : of the command line
    version : what ``--version`` prints, of a command line with several commands
    """
    sys.stdout, sys.stderr = map(_Output.instead_of, (sys.stdout, sys.stderr))
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    for word, one in command.items() if isinstance(command, Mapping) else [(None, command)]:
        app.command(word)(one)
    if version:
        app.callback()(_with_version(f"{name} {version}"))
    try:
        status = _without_types(typer.main.get_command(app))(prog_name=name, standalone_mode=False)
    except _USAGE_ERROR as error:
        message = _with_value(
            error, str(getattr(error, "format_message", error.__str__)()).rstrip("."), sys.argv[1:]
        )
        called = getattr(getattr(error, "ctx", None), "command_path", name)
        status = refuse(f"{message}; see {called} --help")
    # Here, and not while the interpreter ends, where a reader that is gone would be an exception.
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    sys.exit(status or 0)


def _without_types(command: Any) -> Any:
    """Return a command, or all that it has, whose help names no types beside arguments and flags.

    Typer writes <list[Path]> beside RUN_DIR, which says what it is, and <bool> beside flags, which
    take no value.
    """
    for one in (command, *getattr(command, "commands", {}).values()):
        # With --help, which a command makes once it is asked for.
        for parameter in one.get_params(typer.Context(one)):
            if parameter.metavar if parameter.param_type_name == "argument" else parameter.is_flag:
                parameter.display_type_rich = _no_type
    return command


def _no_type(**_: object) -> None:
    """Return no name of a type, as typer asks for."""


def _with_value(error: Exception, message: str, given: Sequence[str]) -> str:
    """Return what is wrong with an option, with its value: "--jobs is 0; it must be ..."; any other
    message as it is.
    """
    names = getattr(getattr(error, "param", None), "opts", [])
    _, said, demanded = message.partition("Input should be ")
    values = [
        word.partition("=")[2] for word in given if word.partition("=")[0] in names and "=" in word
    ]
    values += [value for word, value in itertools.pairwise(given) if word in names]
    if not said or not values:
        return message
    return f"{names[0]} is {values[-1]}; it must be {demanded.partition(',')[0]}"


class _Output(io.TextIOWrapper):
    """An output whose reader may be gone before its end, as ``head`` is: the command then ends
    without a word.

    Not with an OSError, which commands take for a file that cannot be written.
    """

    @staticmethod
    def instead_of(stream: TextIO) -> TextIO:
        """Return what to write to instead of a standard stream; the stream itself where a program
        or a test has replaced it.
        """
        if not isinstance(stream, io.TextIOWrapper):
            return stream
        # Names may have letters that a terminal does not.
        stream.reconfigure(errors="backslashreplace")
        if stream not in (sys.__stdout__, sys.__stderr__):
            return stream
        return _Output(
            stream.buffer, stream.encoding, stream.errors, line_buffering=stream.line_buffering
        )

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except BrokenPipeError:
            self._end()

    def flush(self) -> None:
        try:
            super().flush()
        except BrokenPipeError:
            self._end()

    def _end(self) -> NoReturn:
        # What is left to write has a place to go to, or the interpreter would try once more.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        raise SystemExit(UNREAD)


def _with_version(text: str) -> Callable[..., None]:
    """Return what reads the options that stand before any command."""

    def printed(given: bool) -> None:
        if given:
            print(text)
            raise typer.Exit

    option = typer.Option(
        "--version", help="Print the version and exit.", callback=printed, is_eager=True
    )

    def options(_version: Annotated[bool, option] = False) -> None:
        """Fly a fixed-wing UAV through a ship's exhaust plume."""

    return options


def refuse(error: Exception | str) -> int:
    """Print what is wrong with the input as one line, whatever names it quotes; return the exit
    status.
    """
    print(f"error: {one_line(str(error))}", file=sys.stderr)
    return BAD_INPUT
