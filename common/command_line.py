"""Command lines of the project: typer for the options, one line for an error."""

import io
import sys
from collections.abc import Callable

import typer

BAD_INPUT, INTERRUPTED = 2, 130

_USAGE_ERROR: type[Exception] = typer.BadParameter.__bases__[0]
"""Base class of the errors that typer raises for bad options, which it does not export."""


def run_command(command: Callable[..., None], name: str) -> None:
    """Run ``command`` as a command line called ``name`` and exit with its status, 2 for bad options."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # Names may have letters that a terminal does not.
            stream.reconfigure(errors="backslashreplace")
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    app.command()(command)
    try:
        status = app(prog_name=name, standalone_mode=False)
    except _USAGE_ERROR as error:
        message = str(getattr(error, "format_message", error.__str__)()).rstrip(".")
        status = refuse(f"{message}; see {name} --help")
    except typer.Abort:
        print("interrupted", file=sys.stderr)
        status = INTERRUPTED
    sys.exit(status or 0)


def refuse(error: Exception | str) -> int:
    """Print what is wrong with the input as one line, whatever names it quotes; return the exit status."""
    line = "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in str(error))
    print(f"error: {line}", file=sys.stderr)
    return BAD_INPUT
