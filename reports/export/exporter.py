"""What an exporter is, and which there are."""

from pathlib import Path
from typing import Protocol

from common.registry import Registry
from reports.run.run_data import RunData


class Exporter(Protocol):
    """Writes a run in another format, made without arguments.

    To add one, register its class in a module of this folder, announce it as an entry point in the group
    ``plume_flight_study.exporter``, or name it by its file: ``--export FILE.py:NAME``.

    Attributes
    ----------
    suffix : how the names of its files end, with the leading dot
    one_flight : whether a file holds one flight alone; false if there is no such attribute. Each flight then has a file
    """

    suffix: str

    def write(self, run: RunData, path: Path) -> None:
        """Write the run to ``path``.

        Raises
        ------
        ReportError : the run does not have what the format is about
        """
        ...


EXPORTERS: Registry[type[Exporter]] = Registry("exporter", folder="reports.export", methods=("write",))
