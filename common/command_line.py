"""Command lines of the project: typer for the options, one line for an error."""

import io
import sys
from collections.abc import Callable, Mapping
from typing import Annotated

import typer

PROGRAM = "plume-flight"
"""Name of the console command."""

BAD_INPUT, INTERRUPTED = 2, 130

_USAGE_ERROR: type[Exception] = typer.BadParameter.__bases__[0]
"""Base class of the errors that typer raises for bad options, which it does not export."""


def run_command(command: Callable[..., None] | Mapping[str, Callable[..., None]], name: str, version: str = "") -> None:
    """Run a command as a command line called ``name`` and exit with its status, 2 for bad options.

    Parameters
    ----------
    command : the only one, or commands by the words that choose them
    name : of the command line
    version : what ``--version`` prints, of a command line with several commands
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # Names may have letters that a terminal does not.
            stream.reconfigure(errors="backslashreplace")
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    for word, one in command.items() if isinstance(command, Mapping) else [(None, command)]:
        app.command(word)(one)
    if version:
        app.callback()(_with_version(f"{name} {version}"))
    try:
        status = app(prog_name=name, standalone_mode=False)
    except _USAGE_ERROR as error:
        message = str(getattr(error, "format_message", error.__str__)()).rstrip(".")
        called = getattr(getattr(error, "ctx", None), "command_path", name)
        status = refuse(f"{message}; see {called} --help")
    except typer.Abort:
        print("interrupted", file=sys.stderr)
        status = INTERRUPTED
    sys.exit(status or 0)


def _with_version(text: str) -> Callable[..., None]:
    """Return what reads the options that stand before any command."""

    def printed(given: bool) -> None:
        if given:
            print(text)
            raise typer.Exit

    option = typer.Option("--version", help="Print the version and exit.", callback=printed, is_eager=True)

    def options(_version: Annotated[bool, option] = False) -> None:
        """Fly a fixed-wing UAV through a ship's exhaust plume."""

    return options


def refuse(error: Exception | str) -> int:
    """Print what is wrong with the input as one line, whatever names it quotes; return the exit status."""
    line = "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in str(error))
    print(f"error: {line}", file=sys.stderr)
    return BAD_INPUT
