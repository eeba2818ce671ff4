"""What a report is made of, the same for screen and print."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from common.verdict import MET, UNEXPLAINED
from reports.document.chart import Chart
from reports.document.scene import Scene
from reports.run.letterhead import Letterhead


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
    caption : what it shows; if not given, the heading before it or the title of its section says so
    number : "Table 3"; given when the report is put together
    """

    head: list[str]
    rows: list[list[str]]
    widths: list[float]
    left_columns: int = 1
    prose: bool = False
    breakable: bool = False
    print_size_pt: float = 7.0
    bold: Sequence[tuple[int, int]] = ()
    caption: str = ""
    number: str = ""


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
    printed : whether it has a page in print, unless all are to be printed
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
    """Flights, one at a time: picked on the screen, and one after the other in print. A report has
    one at most.
    """

    flights: list[FlightContent]


@dataclass(frozen=True, slots=True, kw_only=True)
class Fold:
    """What most readers pass over: behind a fold on the screen, and not in print.

    Attributes
    ----------
    title : of the fold
    blocks : in it, whose figures and tables have no number
    """

    title: str
    blocks: Sequence[Chart | Table | Heading | Text]


CARDS_MAX, FAILURES_MAX = 6, 4
"""Figures and failures on page 1, at most."""

Block = Chart | Table | Heading | Text | FlightPicker | Fold


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


def folded(section: Section) -> Section:
    """Return a section whose blocks are behind a fold on the screen, and not in print."""
    blocks = [block for block in section.blocks if not isinstance(block, Fold | FlightPicker)]
    kept = [block for block in section.blocks if isinstance(block, Fold | FlightPicker)]
    fold = [Fold(title="Tables and figures", blocks=blocks)] if blocks else []
    return replace(section, blocks=[*fold, *kept])


class Card(NamedTuple):
    """A figure that is judged or shown: its name, its value, what is required of it, whether that
    is met, and its small print, such as whose figure it is or how sure it is.

    No limit, and None for ``met``, where nothing is required.
    """

    name: str
    value: str
    limit: str = ""
    met: bool | None = None
    note: str = ""

    @property
    def required(self) -> str:
        """Return what is required of it, for a table."""
        return self.limit or "–"

    @property
    def result(self) -> str:
        """Return whether that is met, for a table."""
        return "–" if self.met is None else "met" if self.met else "not met"

    @property
    def judgement(self) -> str:
        """Return what its criterion says, in words and with a sign: colour alone says nothing in
        grey.
        """
        if self.met is None:
            return self.limit or "no criterion"
        return f"{'✓ met' if self.met else '✗ not met'}, required {self.limit}"

    @property
    def small_print(self) -> str:
        """Return what stands below its value: what its criterion says, and its note."""
        said = self.judgement if self.limit or not self.note else ""
        return "; ".join(words for words in (said, self.note) if words)

    @property
    def tone(self) -> str:
        """Return the colour of its tile, in a word; none where nothing is required."""
        return "" if self.met is None else "met" if self.met else "missed"


class UndecidedCard(Card):
    """A measured figure that is not shown to lie on either side of its limit."""

    @property
    def required(self) -> str:
        """Return that nothing is required of the flight."""
        return "–"

    @property
    def result(self) -> str:
        """Return that it is open."""
        return "open"

    @property
    def judgement(self) -> str:
        """Return that it is not decided, and for which limit."""
        return f"? not shown to be above or below the limit of {self.limit}"

    @property
    def tone(self) -> str:
        """Return the colour of its tile: neither that of a figure that meets its limit nor that of
        one that does not.
        """
        return "open"


class LossCard(Card):
    """A number of lost aircraft where that is allowed: nothing failed, and nothing is met."""

    @property
    def judgement(self) -> str:
        """Return that nothing else was required of these flights."""
        return f"! {self.limit}"

    @property
    def tone(self) -> str:
        """Return the colour of its tile: a loss is never green."""
        return "open"


class FuelCard(Card):
    """A verdict on a fuel's limit, which is no criterion of the flight that measured it."""

    @property
    def required(self) -> str:
        """Return that nothing is required of the flight."""
        return "–"

    @property
    def result(self) -> str:
        """Return on which side of the limit the fuel is."""
        return "below" if self.met else "above"

    @property
    def judgement(self) -> str:
        """Return on which side of the limit the fuel is."""
        return f"{'✓ below' if self.met else '✗ above'} the limit of {self.limit}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The answer, and the figures it rests on.

    Attributes
    ----------
    headline, detail : in words
    failures : a line for each failure, and for what else is to be known of the flights
    figures : what it rests on, the most important first: page 1 shows these
    judges : whether figures have criteria, unlike those of a comparison
    holds, complete : False where something that must never happen did, or where something is left
        to be done or shown, and no figure says so
    exit_status : of the run, as ``RunVerdict.exit_status``; whoever puts a report together gives it
    """

    headline: str
    detail: str
    failures: list[str]
    figures: list[Card]
    judges: bool = True
    holds: bool = True
    complete: bool = True
    exit_status: int = MET

    @property
    def tone(self) -> str:
        """Return the colour of the verdict, in a word: good, warn or bad.

        It is that of the worst figure, and never better than the exit status.
        """
        tones = {card.tone for card in self.figures}
        if "missed" in tones or not self.holds or self.exit_status == UNEXPLAINED:
            return "bad"
        if "open" in tones or not self.complete or self.exit_status != MET:
            return "warn"
        return "good"

    @property
    def sign(self) -> str:
        """Return the sign beside the verdict: colour alone says nothing in grey."""
        return {"good": "✓", "warn": "!", "bad": "✗"}[self.tone]

    @property
    def cards(self) -> list[Card]:
        """Return the figures of page 1, six at most, in their order: those that are not met before
        those that are open, and these before others.
        """
        ranks = {"missed": 0, "open": 1}
        places = range(len(self.figures))
        worst = sorted(places, key=lambda place: ranks.get(self.figures[place].tone, 2))
        return [self.figures[place] for place in sorted(worst[:CARDS_MAX])]

    @property
    def further(self) -> list[Card]:
        """Return the figures that page 1 does not show."""
        shown = self.cards
        return [card for card in self.figures if card not in shown]

    @property
    def first_failures(self) -> list[str]:
        """Return the failures that page 1 has room for, and how many there are more."""
        more = len(self.failures) - FAILURES_MAX
        return (
            self.failures
            if more <= 0
            else [*self.failures[:FAILURES_MAX], f"and {more:,} more, under “Further figures”"]
        )


class Fact(NamedTuple):
    """What a reader has to know of a flight before its figures: what it is, and what is known of
    it.
    """

    name: str
    value: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """What a study has to say.

    Attributes
    ----------
    flown : what was flown, in a sentence
    verdict : the answer
    picture : what page 1 shows large, or None where nothing can be drawn
    sections : what shows the answer
    facts : when, where and with what was measured, for page 1
    """

    flown: str
    verdict: Verdict
    picture: Chart | None
    sections: list[Section]
    facts: Sequence[Fact] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """A whole report.

    Attributes
    ----------
    title : of the report
    letterhead : who wrote it, when the run was, and what the run is called
    description : what the study is about, in its scenario's words
    changes : what was changed of the scenario
    flown, verdict, picture, facts : as in ``Findings``; with the lines above, they are page 1
    sections : what shows the answer, with figures and tables numbered
    """

    title: str
    letterhead: Letterhead
    description: str
    changes: str
    flown: str
    verdict: Verdict
    picture: Chart | None
    sections: list[Section]
    facts: Sequence[Fact] = ()
