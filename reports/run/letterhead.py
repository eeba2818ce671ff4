"""Who a report is by, and when its run was."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from common.picture import Picture, PictureError, read_picture
from common.run_layout import REPORT_SETTINGS, is_file_name
from common.text import did_you_mean
from reports.errors import ReportError
from reports.run.run_data import RunData

_SECTION = "report."


@dataclass(frozen=True, slots=True, kw_only=True)
class Letterhead:
    """What stands above and below every page.

    Attributes
    ----------
    run : name of the run
    when : date and time at which it began, in UTC, or that they were not recorded
    done : what was done then, where the date is not to be taken for that of the flight, or of a
        report on several; else empty
    author, organisation : as given, or empty
    logo : as given, or None
    """

    run: str
    when: str
    done: str = ""
    author: str = ""
    organisation: str = ""
    logo: Picture | None = None

    @property
    def dated(self) -> str:
        """Return the date, with what was done then."""
        return f"{self.done} {self.when}".strip()

    @property
    def signature(self) -> str:
        """Return author and organisation."""
        return ", ".join(part for part in (self.author, self.organisation) if part)


def parse_settings(overrides: Sequence[str]) -> dict[str, str]:
    """Return the values of ``report.KEY=VALUE``, by their keys without the section.

    Raises
    ------
    ReportError : an override is of another form, or of a key that reports do not have; or the logo
        is no picture
    """
    settings = {}
    for override in overrides:
        key, equals, text = (part.strip() for part in override.partition("="))
        name = key.removeprefix(_SECTION)
        if not equals or key == name or name not in REPORT_SETTINGS:
            keys = [f"{_SECTION}{known}" for known in REPORT_SETTINGS]
            guess = did_you_mean(key, keys) or f"; reports have {', '.join(keys)}"
            raise ReportError(f"--set '{override}' sets nothing of a report{guess}")
        settings[name] = _text(text)
    if settings.get("logo"):
        _logo(Path(settings["logo"]))
    return settings


def letterhead(run: RunData, settings: Mapping[str, str]) -> Letterhead:
    """Return the letterhead of a run; ``settings`` replace those of the run, the path of a logo
    among them.

    Raises
    ------
    ReportError : the logo of ``settings`` is no picture
    """
    texts = {
        key: str(run.manifest.get("report", {}).get(key) or "") for key in REPORT_SETTINGS
    } | dict(settings)
    logo = None
    if settings.get("logo"):
        logo = _logo(Path(settings["logo"]))
    elif name := texts["logo"]:
        logo = _own_logo(run, name)
    return Letterhead(
        run=str(run.manifest["name"]),
        when=_moment(run.manifest.get("begun_utc")),
        done="analysed" if run.manifest.get("study") == "measurement" else "",
        author=texts["author"],
        organisation=texts["organisation"],
        logo=logo,
    )


def title(run: RunData, settings: Mapping[str, str]) -> str:
    """Return the title of a run's report: that of ``settings``, the one that the run was given, or
    the scenario's.
    """
    return (
        settings.get("title")
        or run.manifest.get("report", {}).get("title")
        or str(run.manifest["title"])
    )


def _own_logo(run: RunData, name: str) -> Picture | None:
    """Return the logo that the run keeps, or None if it is gone or damaged, which the report then
    says.
    """
    try:
        return read_picture(run.path / name) if is_file_name(name) else None
    except PictureError:
        run.unread.add(name)
        return None


def _logo(path: Path) -> Picture:
    try:
        return read_picture(path)
    except PictureError as error:
        raise ReportError(f"report.logo: {error}") from None


def _text(value: str) -> str:
    """Return a text, which may be written as in TOML."""
    try:
        found = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return value
    return found if isinstance(found, str) else value


def _moment(recorded: Any) -> str:
    """Return a moment of the manifest as it is read: 2026-11-22 08:35 UTC."""
    try:
        return f"{datetime.fromisoformat(recorded):%Y-%m-%d %H:%M} UTC"
    except (TypeError, ValueError):
        return "date not recorded"
