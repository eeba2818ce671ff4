"""What a report is made of, the same for screen and print."""

from collections.abc import Sequence
from dataclasses import dataclass

from reports.document.chart import Chart
from reports.document.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table of text.

    Attributes
    ----------
    head : column titles with units; all empty for a table without a head
    rows : cells
    widths : relative widths of the columns, in print
    left_columns : so many of the first columns are left-aligned, the others right-aligned
    prose : cells hold sentences rather than figures: on the screen all are left-aligned
    breakable : may go on over the next page, in print
    print_size_pt : size of its letters in print
    bold : cells that stand out, each by its row and its column
    """

    head: list[str]
    rows: list[list[str]]
    widths: list[float]
    left_columns: int = 1
    prose: bool = False
    breakable: bool = False
    print_size_pt: float = 7.0
    bold: Sequence[tuple[int, int]] = ()


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading inside a section."""

    text: str


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightContent:
    """One flight of a picker.

    Attributes
    ----------
    flight_id : what ``report.html?flight=...`` calls it
    label : in the picker
    title : above its page in print
    charts : its figures, or none if it has no record
    printed : whether it has a page in print, unless all are asked for
    scene : for its replay on the screen, or none
    """

    flight_id: str
    label: str
    title: str
    charts: list[Chart]
    printed: bool = True
    scene: Scene | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPicker:
    """Flights, one at a time: picked on the screen, and a page each at the end of what is printed. A report has one at most."""

    flights: list[FlightContent]


Block = Chart | Table | Heading | Text | FlightPicker


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A section of a report.

    Attributes
    ----------
    anchor : for links to it; lower-case letters
    title : its heading
    blocks : what it shows, in reading order
    nav_title : what the navigation calls it, if not by its title
    """

    anchor: str
    title: str
    blocks: Sequence[Block]
    nav_title: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The answer, and the figures it rests on.

    Attributes
    ----------
    holds : nothing happened that must never happen
    complete : everything that was planned was done, and is as required
    headline, detail : in words
    failures : a line for each failure
    figures : name, value and limit of what is judged; no limit where there is none
    """

    holds: bool
    complete: bool
    headline: str
    detail: str
    failures: list[str]
    figures: list[tuple[str, str, str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """A whole report: what was run, what was changed for it, the answer, and what shows it."""

    title: str
    description: str
    changes: str
    verdict: Verdict
    sections: list[Section]
