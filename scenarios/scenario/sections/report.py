"""Title and sender of a study's reports, which have no effect on flights."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from common.picture import Picture, PictureError, read_picture
from common.run_layout import LOGO
from scenarios.errors import InputError
from scenarios.scenario.sections.section import Section

Words = Annotated[str, Field(max_length=200, coerce_numbers_to_str=True)]


class ReportConfig(Section):
    """Title and sender of the reports. A run keeps its seed, and can be resumed, with any text
    here.
    """

    title: Words = ""
    """Title of the reports; that of the scenario if not given."""
    author: Words = ""
    """Author of the study."""
    organisation: Words = ""
    """Organisation of the author."""
    logo: Annotated[str, Field(max_length=4096)] = ""
    """A picture for page 1: a PNG, JPEG or SVG file, whose path is relative to the scenario file.
    """


def read_logo(report: ReportConfig) -> Picture | None:
    """Return the logo of a report, or None if it has none.

    Raises
    ------
    InputError : the file is not a picture
    """
    try:
        return read_picture(Path(report.logo)) if report.logo else None
    except PictureError as error:
        raise InputError(f"report.logo: {error}") from None


def report_entry(report: ReportConfig) -> dict[str, Any]:
    """Return the manifest's entries on the reports: the logo's name in the run directory, and a
    hash of its content.

    Raises
    ------
    InputError : the logo is not a picture
    """
    logo = read_logo(report)
    kept = {"logo": f"{LOGO}{logo.suffix}", "logo_sha256": logo.sha256} if logo else {}
    return report.model_dump(mode="json") | kept
