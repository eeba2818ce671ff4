"""Commands as a user types them, in the process of the test: a tenth of a second instead of one or
two.
"""

import contextlib
import importlib
import io
import sys
from dataclasses import dataclass
from unittest import mock


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """How a command ended, and what it printed."""

    status: int
    out: str
    errors: str


def run_command(module, *arguments):
    """Run ``python -m MODULE ARGUMENTS``; an error that it lets through is raised, where a user
    would see a traceback.
    """
    out, errors = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2))
    main = importlib.import_module(module).main
    status = 0
    with (
        mock.patch.object(sys, "argv", [module, *map(str, arguments)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(errors),
    ):
        try:
            main()
        except SystemExit as ended:
            status = int(ended.code or 0)
    texts = []
    for stream in (out, errors):
        stream.flush()
        texts.append(stream.buffer.getvalue().decode())
    return Ended(status=status, out=texts[0], errors=texts[1])


def assert_refused(ended, *words):
    """Assert that bad input was refused: status 2, and one line on standard error."""
    assert ended.status == 2, ended
    *before, last = ended.errors.splitlines()
    assert last.startswith("error: "), ended.errors
    # Beside it there is what the command was doing.
    assert not [line for line in before if "error" in line.lower() or "Traceback" in line], (
        ended.errors
    )
    for word in words:
        assert word in last
