"""Every command of the command line and its options, from typer."""

from collections.abc import Iterator
from typing import Any

import typer
import typer.main

from reference_pages.markdown import literal, plain, table
from scenarios.cli.main import commands

_INTRODUCTION = """\
# Command line

Made from the program. `plume-flight` is installed with the project; in the repository it is `.venv/bin/plume-flight`. Where
it is not installed `python -m scenarios.run`, `python -m innerloop.design`, `python -m measurement.estimate`,
`python -m reports.build` and `python -m reports.compare` are the same commands. `plume-flight --version` prints the version,
and `plume-flight --install-completion` lets bash, zsh, fish or PowerShell complete commands and options.

| exit status | |
|---|---|
| 0 | every flight is met (of faults flown on purpose and of a search: every flight kept out) |
| 1 | some did not, which the report names; or files of a run are missing |
| 2 | bad input: one line on standard error says what, and what to do |
| 130 | interrupted; results are kept, and `--resume` goes on |
"""


def commands_page() -> str:
    """Return the page."""
    lines = [_INTRODUCTION]
    for word, function in commands().items():
        app = typer.Typer(add_completion=False)
        app.command(word)(function)
        lines += _command(word, typer.main.get_command(app))
    return "\n".join(lines)


def _command(word: str, command: Any) -> Iterator[str]:
    arguments = [option for option in command.params if option.param_type_name == "argument"]
    usage = " ".join(["plume-flight", word, *(_argument(of) for of in arguments), "[OPTIONS]"])
    yield from (
        f"## {word}",
        "",
        plain(" ".join((command.help or "").split())),
        "",
        "```",
        usage,
        "```",
        "",
    )
    yield from table(
        ("argument or option", "default", "meaning"),
        (
            (_name(of), _default(of), plain(getattr(of, "help", None) or ""))
            for of in command.params
            if of.name != "help"
        ),
    )


def _argument(argument: Any) -> str:
    name = str(argument.metavar or argument.name.upper())
    return name if argument.required else f"[{name}]"


def _name(option: Any) -> str:
    if option.param_type_name == "argument":
        return literal(option.metavar or option.name.upper())
    value = "" if option.is_flag else f" {option.metavar or option.name.upper()}"
    return literal(", ".join(option.opts) + value)


def _default(option: Any) -> str:
    if option.required:
        return "required"
    return (
        ""
        if option.default in (None, (), [], False) or callable(option.default)
        else literal(option.default)
    )
