"""What JSBSim prints by itself, kept off the terminal."""

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def silenced() -> Iterator[None]:
    """Keep the banner and the warnings that JSBSim prints off standard output and standard error,
    also where these are files.
    """
    _flush()
    saved = {stream: os.dup(stream) for stream in (1, 2)}
    try:
        with Path(os.devnull).open("w", encoding="utf-8") as sink:
            for stream in saved:
                os.dup2(sink.fileno(), stream)
            try:
                yield
            finally:
                # A file or a pipe is buffered: what is left in a buffer would be printed later.
                _flush()
    finally:
        for stream, copy in saved.items():
            os.dup2(copy, stream)
            os.close(copy)


def _flush() -> None:
    """Write what Python and C have buffered."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)
