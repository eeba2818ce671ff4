"""Run the project's command lines: options by typer, an error in one line."""

import io
import itertools
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, NoReturn, TextIO

import typer

from common.text import one_line

PROGRAM = "plume-flight"
"""Name of the console command."""

BAD_INPUT, UNREAD = 2, 141
"""Exit statuses of bad input and of a closed output pipe, which is 128 plus SIGPIPE's number.

The exit statuses of runs are in ``common.verdict``.
"""

_USAGE_ERROR: type[Exception] = typer.BadParameter.__bases__[0]
"""Base class of typer's errors about options, which typer does not export."""


def run_command(
    command: Callable[..., None] | Mapping[str, Callable[..., None]], name: str, version: str = ""
) -> None:
    """Run a command line, and exit with its status; bad options give status 2.

    Parameters
    ----------
    command : the only command, or commands by name
    name : name of the command line
    version : text that ``--version`` prints, if there are several commands
    """
    sys.stdout = _Output.instead_of(sys.stdout)
    sys.stderr = _Output.instead_of(sys.stderr)
    # Only the installed command, which has several commands, has completion in a shell.
    several = isinstance(command, Mapping)
    app = typer.Typer(add_completion=several, pretty_exceptions_enable=False)
    if isinstance(command, Mapping):
        for word, one in command.items():
            app.command(word)(one)
    else:
        app.command()(command)
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
    # A closed pipe would raise an exception while the interpreter ends.
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    sys.exit(status or 0)


def _without_types(command: Any) -> Any:
    """Return a command whose help shows no types of arguments and flags."""
    for one in (command, *getattr(command, "commands", {}).values()):
        # get_params also creates --help, which the command lacks before.
        for parameter in one.get_params(typer.Context(one)):
            if parameter.param_type_name == "argument":
                hidden = parameter.metavar
            else:
                hidden = parameter.is_flag
            if hidden:
                parameter.display_type_rich = lambda **_: None
    return command


def _with_value(error: Exception, message: str, given: Sequence[str]) -> str:
    """Return an error message with the option's value, as in "--jobs is 0; it must be ..."."""
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
    """An output that ends the command silently when its pipe is closed, as by ``| head``."""

    @staticmethod
    def instead_of(stream: TextIO) -> TextIO:
        """Return an output that wraps a standard stream, or a replaced stream unchanged."""
        if not isinstance(stream, io.TextIOWrapper):
            return stream
        # Names may have characters that the terminal cannot show.
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
        # Otherwise the interpreter would try again to write the rest of the buffer.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        raise SystemExit(UNREAD)


def _with_version(text: str) -> Callable[..., None]:
    """Return a typer callback with the option ``--version``."""

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
    """Print an error about the input as one line on stderr; return the exit status."""
    print(f"error: {one_line(str(error))}", file=sys.stderr)
    return BAD_INPUT
