"""What an exporter is, and which there are."""

import importlib.util
from pathlib import Path
from typing import Protocol

from common.registry import Registry, announced, load_announced
from common.text import install_words
from reports.errors import ReportError
from reports.export.geographic import GeographicFlight
from reports.run.run_data import RunData

STREAM = "stream"
"""Group of entry points, ``plume_flight_study.stream``."""


class Exporter(Protocol):
    """Writes a run in another format, made without arguments; one whose packages are missing says
    so when it is made.

    To add one, register its class in a module of this folder, announce it as an entry point in the
    group ``plume_flight_study.exporter``, or name it by its file: ``--export FILE.py:NAME``.

    Attributes
    ----------
    suffix : how the names of its files end, with the leading dot
    one_flight : whether a file holds one flight alone; false if there is no such attribute. Each
        flight then has a file
    """

    suffix: str

    def write(self, run: RunData, path: Path) -> None:
        """Write the run to ``path``.

        Raises
        ------
        ReportError : the run does not have what the format is about
        """
        ...


class Stream(Protocol):
    """Sends a recorded flight to another program in real time: ``--stream SCHEME://ADDRESS``.

    Its class is called with the whole address, and refuses with a ``ReportError`` what is none. An
    installed package announces it in the group ``plume_flight_study.stream`` by its scheme.
    """

    def send(self, flight: GeographicFlight) -> int:
        """Send a flight; return the number of messages.

        Raises
        ------
        ReportError : nothing can be sent to the address
        """
        ...


def stream_to(address: str) -> Stream:
    """Return what sends flights to an address.

    Raises
    ------
    ReportError : its scheme is unknown, or it is no address
    PluginError : what sends there does not load
    """
    scheme, separator, _ = address.partition("://")
    known = sorted(announced(STREAM))
    if not separator or scheme not in known:
        addresses = " or ".join(f"{name}://..." for name in known) or "none is installed"
        raise ReportError(f"--stream is '{address}'; known are {addresses}")
    made: Stream = load_announced(STREAM, scheme)(address)
    return made


def need_packages(exporter: str, *packages: str) -> None:
    """Refuse an exporter, before it writes anything, whose packages of the extra ``export`` are not
    installed.

    Raises
    ------
    ReportError : one of them is missing
    """
    if any(importlib.util.find_spec(package) is None for package in packages):
        needed = f"the package{'s' * (len(packages) > 1)} {' and '.join(packages)}"
        raise ReportError(
            f"{exporter} needs {needed}; install the extra: {install_words('export')}"
        )


EXPORTERS: Registry[type[Exporter]] = Registry(
    "exporter", folder="reports.export", methods=("write",)
)
