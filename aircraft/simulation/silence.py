"""What JSBSim prints by itself, kept off the terminal."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def silenced() -> Iterator[None]:
    """Keep the banner and the warnings that JSBSim prints in C++ off standard output and standard error."""
    saved = {stream: os.dup(stream) for stream in (1, 2)}
    try:
        with Path(os.devnull).open("w", encoding="utf-8") as sink:
            for stream in saved:
                os.dup2(sink.fileno(), stream)
            yield
    finally:
        for stream, copy in saved.items():
            os.dup2(copy, stream)
            os.close(copy)
