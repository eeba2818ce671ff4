"""Flights that searched for their plume: the answer, the sections on all of them beside their
comparisons, and on a typical and the worst one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from common.intervals import CONFIDENCE, percent, shared_interval
from measurement.estimate.verdict import COVERAGE
from measurement.gases import MASS_PERCENT
from measurement.plume.fluctuating_plume import FOUND_WITHIN, HIT, passes
from reports.document.blocks import Block, Card, Heading, Section, Table, Text
from reports.document.chart import VARIANT_STYLES, Chart, Line, Panel, Style
from reports.document.palette import VARIANTS, Meaning
from reports.document.tables import Cell, number, rows_table
from reports.finding.search_view import SearchView, height_chart, search_view, section_chart
from reports.run.columns import Array, column, flights_flown, recorded_at, study_flight
from reports.run.run_data import RunData
from reports.run.trials import AS_IN_THE_STUDY, Name, Trial, read_trials

_SEVERAL = 2
"""Flights from which on there is a share that found the plume."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """Flights that differ in their cases alone.

    Attributes
    ----------
    name, colour, style : in tables and in figures
    rows : of the flights that reached their orbit
    """

    name: str
    colour: str
    rows: pd.DataFrame
    style: Style = "solid"

    @property
    def times(self) -> Array:
        """Time to find of each flight from reaching its orbit [s], infinite where it never found
        the plume.
        """
        return np.nan_to_num(column(self.rows, "time_to_find_s"), nan=math.inf)

    @property
    def found(self) -> int:
        """Number of flights that found the plume."""
        return int(np.isfinite(self.times).sum())

    @property
    def latest(self) -> float:
        """Time within which 95 % of the flights found the plume [s]: that of a flight, as there is
        nothing between a time and never.
        """
        return float(np.quantile(self.times, 0.95, method="inverted_cdf"))

    def share_found(self, within: float) -> float:
        """Return the share of flights that found the plume within a time [s]; at least one flight
        is needed.
        """
        return float(np.mean(self.times <= within))

    def beside(self, other: "Variant", name: str) -> Array:
        """Return a figure over that of the same case in another variant, of the cases that both
        have; at least a pair each.
        """
        mine, theirs = (of.rows.set_index(study_flight(of.rows))[name] for of in (self, other))
        pairs = pd.concat([mine, theirs], axis=1, join="inner").dropna()
        ratio: Array = pairs.iloc[:, 0].to_numpy(dtype=np.float64) / pairs.iloc[:, 1].to_numpy(
            dtype=np.float64
        )
        return ratio


def variants_of(trial: Trial) -> list[Variant]:
    """Return the study's own flights, and those of each comparison; none of a variant without a
    flight on its orbit.
    """
    compared = trial.run.comparison
    names: list[str] = []
    if len(compared):
        compared = compared[compared["trial"] == trial.key]
        names = [str(name) for name in dict.fromkeys(compared["variant"])]
    own = Variant(name=AS_IN_THE_STUDY, colour=Meaning.FLOWN, rows=_on_orbit(trial.rows))
    others = [
        Variant(
            name=name.replace("_", " "),
            colour=VARIANTS[i % len(VARIANTS)],
            style=VARIANT_STYLES[i % len(VARIANT_STYLES)],
            rows=_on_orbit(compared[compared["variant"] == name]),
        )
        for i, name in enumerate(names)
    ]
    return [variant for variant in (own, *others) if len(variant.rows)]


def searching_variants(run: RunData) -> list[Variant]:
    """Return the variants of a run of one trial in which several flights search for the plume; none
    of any other.
    """
    trials = read_trials(run)
    if len(trials) != 1 or len(trials[0].rows) < _SEVERAL:
        return []
    rows = trials[0].rows
    searches = "axis_height_end_m" in rows and rows["axis_height_end_m"].notna().any()
    return variants_of(trials[0]) if searches else []


def _on_orbit(rows: pd.DataFrame) -> pd.DataFrame:
    return rows[rows["orbit_at_s"].notna()] if "orbit_at_s" in rows else rows.iloc[:0]


_KNOWN_AXIS = "told"
"""Name of the variant that knows the axis, if the run has it."""


def search_table(variants: list[Variant]) -> Table:
    """Return how soon each variant found its plumes, how often it hit them, and what it measured of
    the fuel.
    """
    known = next((variant for variant in variants if variant.name == _KNOWN_AXIS), None)

    def over(name: str) -> Callable[[Variant], str]:
        return lambda of: _over(of, known, name)

    cells = [
        Cell("Variant", lambda of: of.name, width=1.5),
        Cell("Flights", lambda of: len(of.rows), "{:,.0f}", 0.7),
        Cell(
            f"Found within {FOUND_WITHIN / 60.0:g} min",
            lambda of: percent(of.share_found(FOUND_WITHIN)),
        ),
        Cell("Time to find, median [s]", lambda of: seconds_words(float(np.median(of.times)))),
        Cell("95 % quantile [s]", lambda of: seconds_words(of.latest), width=0.8),
        Cell("Hits after found", hits_words, width=0.9),
        Cell(
            f"Sulphur error, rms [{MASS_PERCENT}]",
            lambda of: _rms(column(of.rows, "fsc_percent") - column(of.rows, _EXPECTED)),
            "{:.4f}",
        ),
        Cell(
            f"Sulphur 1σ stated, median [{MASS_PERCENT}]",
            lambda of: _median(column(of.rows, "fsc_uncertainty_percent")),
            "{:.4f}",
            1.2,
        ),
        Cell("1σ over known", over("fsc_uncertainty_percent"), width=0.8),
        Cell("Its noise over known", over("fsc_noise_percent"), width=0.9),
    ]
    return rows_table(variants, cells, caption=_SEARCHES)


_EXPECTED = "fsc_expected_percent"

_SEARCHES = (
    "How soon plumes were found, how often they were hit, and what was measured of the sulphur."
    " Over known: beside the same cases with a known axis, median of the pairs."
)


def height_table(variants: list[Variant]) -> Table | None:
    """Return how well the height of the axis was known after 3 minutes; none where no flight has an
    estimate then.
    """
    rows = []
    for variant in variants:
        error, deviation = (
            column(variant.rows, f"axis_height_{of}_3min_m") for of in ("error", "deviation")
        )
        known = np.isfinite(error) & np.isfinite(deviation)
        if not known.any():
            continue
        held = np.abs(error[known]) <= COVERAGE * deviation[known]
        interval = shared_interval(held, variant.rows.loc[known, "seed"], CONFIDENCE)
        rows.append([
            variant.name,
            f"{len(held):,}",
            number(float(np.mean(error[known])), "{:+.1f}"),
            number(_rms(error), "{:.1f}"),
            number(_median(deviation), "{:.1f}"),
            percent(float(held.mean())),
            f"{percent(interval.low)} to {percent(interval.high)}",
        ])  # fmt: skip
    return (
        Table(
            caption="Height of the axis after 3 minutes on the orbit: error, and how often the"
            " stated 95 % interval held it.",
            head=[
                "Variant",
                "Flights",
                "Bias [m]",
                "Error, rms [m]",
                "Stated 1σ, median [m]",
                "Covered",
                "Interval of that",
            ],
            rows=rows,
            widths=[1.5, 0.7, 0.8, 1.0, 1.2, 0.8, 1.4],
        )
        if rows
        else None
    )


def seconds_words(value: float) -> str:
    """Return a time to find to a second; infinite ones are those of plumes that were not found."""
    return f"{value:.0f}" if math.isfinite(value) else "not found"


def hits_words(variant: Variant) -> str:
    """Return the share of a variant's passes that hit the plume once it was found, the mean over
    its flights.
    """
    shares = column(variant.rows, "hit_rate_found")
    known = shares[np.isfinite(shares)]
    return percent(float(np.mean(known))) if len(known) else "–"


def _rms(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else None


def _median(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else None


def _over(variant: Variant, known: Variant | None, name: str) -> str:
    if known is None or name not in variant.rows or name not in known.rows:
        return "–"
    return number(_median(variant.beside(known, name)), "{:.2f}")


_HISTORIES_MAX = 40
"""Flights of a variant whose passes are counted at most: their time histories are read for it."""

_STRETCH = 30.0
"""Time over which the hits of all flights are counted together [s]."""


def finding_charts(trial: Trial, variants: list[Variant]) -> list[Chart]:
    """Return how soon plumes were found, and how often they were hit from then on."""
    panels = [_found_panel(variants), *_hits_panel(trial, variants)]
    name = f"{trial.name}-detection"
    return [Chart(name=name, caption=_FOUND, panels=panels, columns=len(panels), panel_height=0.38)]


_FOUND = (
    "Share of flights that have found their plume over the time since they reached their orbit, and"
    f" share of the passes that hit it, peak above {HIT:g} of the plume's axis, in stretches of"
    f" {_STRETCH:g} s."
)


def _found_panel(variants: list[Variant]) -> Panel:
    lines = []
    for variant in variants:
        times = np.sort(variant.times)
        within = times <= FOUND_WITHIN
        # A step at each flight, and level up to the end.
        found = int(np.count_nonzero(within))
        share = np.linspace(0.0, found / len(times), found + 1)
        x = np.concatenate([[0.0], np.repeat(times[within], 2), [FOUND_WITHIN]])
        lines.append(
            Line(
                x=x,
                y=np.repeat(share, 2),
                label=variant.name,
                colour=variant.colour,
                style=variant.style,
            )
        )
    return Panel(
        x_label="Time since the orbit was reached [s]",
        y_label="Plume found [-]",
        lines=lines,
        x_range=(0.0, FOUND_WITHIN),
        y_range=(0.0, 1.03),
    )


def _hits_panel(trial: Trial, variants: list[Variant]) -> list[Panel]:
    lines = []
    for variant in variants:
        times, hits = hits_over_time(trial, variant.rows)
        if len(times):
            middle = _STRETCH * (np.floor(times / _STRETCH) + 0.5)
            shares = (
                pd.DataFrame({"middle": middle, "hit": hits})
                .groupby("middle", as_index=False)
                .mean()
            )
            x, y = column(shares, "middle"), column(shares, "hit")
            lines.append(
                Line(x=x, y=y, label=variant.name, colour=variant.colour, style=variant.style)
            )
    panel = Panel(
        x_label="Time since the orbit was reached [s]",
        y_label="Passes that hit [-]",
        lines=lines,
        y_range=(0.0, 1.03),
    )
    return [panel] if lines else []


def hits_over_time(trial: Trial, rows: pd.DataFrame) -> tuple[Array, Array]:
    """Return the time of each pass since the orbit was reached [s], and 1 if it hit the plume, else
    0; of flights with a record.
    """
    kept = rows[[trial.run.has_history(str(flight_id)) for flight_id in rows["flight_id"]]]
    times, hits = [], []
    for _, row in kept.iloc[:: max(1, -(-len(kept) // _HISTORIES_MAX))].iterrows():
        history = trial.run.history(str(row["flight_id"]))
        if history is None:
            continue
        orbit = history[history["time_s"] >= float(row["orbit_at_s"])]
        time, fraction = (
            column(orbit, "time_s") - float(row["orbit_at_s"]),
            column(orbit, "plume_fraction"),
        )
        for at in passes(column(orbit, "plume_across_m")):
            times.append(float(time[(at.start + at.stop) // 2 if at.stop < len(time) else -1]))
            hits.append(float(np.max(fraction[at]) > HIT))
    return np.array(times), np.array(hits)


_ANSWER = (
    "Plume found in {found:,} of {flown:,} flights, median {median} s; passes that hit: {hits}"
)


def search_answer(run: RunData) -> str:
    """Return in how many flights the plume was found, how soon, and the share of passes that hit in
    each variant; no word of a run that does not search in several flights.
    """
    variants = searching_variants(run)
    if not variants:
        return ""
    own, *others = variants
    shares = [hits_words(own), *(f"{of.name} {hits_words(of)}" for of in others)]
    return _ANSWER.format(
        found=own.found, flown=_flown(run), median=_median_time(own), hits=", ".join(shares)
    )


def search_cards(run: RunData) -> list[Card]:
    """Return the tiles of a search."""
    variants = searching_variants(run)
    if not variants:
        return []
    own, *others = variants
    flown = _flown(run)
    criterion = run.verdict.whole.criterion("time_to_find_s")
    judged = (f"within {criterion.limits[0]:g} s", criterion.met) if criterion.judged else ()
    beside = ", ".join(f"{of.name} {hits_words(of)}" for of in others)
    return [
        Card("Flights that found the plume", f"{own.found:,} of {flown:,}", *judged),
        Card(
            "Time to find it, median",
            f"{_median_time(own)} s",
            note=f"95 % quantile {seconds_words(own.latest)} s",
        ),
        Card("Passes that hit it, once found", hits_words(own), note=beside),
    ]


def _flown(run: RunData) -> int:
    return len(flights_flown(run.summary))


def _median_time(variant: Variant) -> str:
    return seconds_words(float(np.median(variant.times)))


_LATE = "axis_height_error_3min_m"
"""Error of the axis' height by which flights are chosen."""

_NAMED_MAX = 12
"""Flights without their plume that are named."""


def finding_sections(run: RunData, trials: list[Trial], name: Name) -> list[Section]:
    """Return the sections of a run whose flights searched for a plume, and none of any other;
    ``name`` is that of a flight.
    """
    found = [trial for trial in trials if len(searched(trial.rows))]
    whole = [block for trial in found for block in _whole(trial, name, only=len(found) == 1)]
    single = [block for trial in found for block in _single(run, trial, name)]
    sections = [
        Section(anchor="finding", title="Search for the plume", nav_title="Search", blocks=whole),
        Section(
            anchor="searches", title="Searches one by one", nav_title="Searches", blocks=single
        ),
    ]
    return [section for section in sections if section.blocks]


def searched(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights that reached their orbit and had an estimate of the plume."""
    return rows[rows["axis_height_end_m"].notna()] if "axis_height_end_m" in rows else rows.iloc[:0]


def _whole(trial: Trial, name: Name, *, only: bool) -> list[Block]:
    """Return figures and tables of all flights of a trial, beside its comparisons."""
    variants = variants_of(trial)
    if not variants:
        return []
    heights = height_table(variants)
    missed = variants[0].rows[variants[0].times > FOUND_WITHIN]
    unfound = (
        f"Not found within {FOUND_WITHIN:g} s:"
        f" {'; '.join(name(row) for _, row in missed[:_NAMED_MAX].iterrows())}"
    )
    more = f" and {len(missed) - _NAMED_MAX} more" if len(missed) > _NAMED_MAX else ""
    return [
        *([] if only else [Heading(trial.title)]),
        search_table(variants),
        *([heights] if heights is not None else []),
        *finding_charts(trial, variants),
        *([Text(f"{unfound}{more}.")] if len(missed) else []),
    ]


def _single(run: RunData, trial: Trial, name: Name) -> list[Block]:
    """Return the figures of a typical search and of the one with the largest error."""
    blocks: list[Block] = []
    for row, why in _picked(run, searched(trial.rows)):
        view = search_view(run, row)
        if view is not None:
            file = str(row["flight_id"]).replace("_", "-")
            blocks += [
                Heading(f"{name(row)}: {why}"),
                Text(_search_words(row)),
                *_charts(view, file),
            ]
    return blocks


def _charts(view: SearchView, name: str) -> list[Block]:
    section = section_chart(view, name)
    return [height_chart(view, name), *([section] if section is not None else [])]


def _picked(run: RunData, rows: pd.DataFrame) -> list[tuple["pd.Series[Any]", str]]:
    """Return the flights to be shown, of those with a time history, and why each is: none twice."""
    kept, judged = rows[run.with_history(rows)], rows[np.isfinite(column(rows, _LATE))]
    errors, recorded = np.abs(column(judged, _LATE)), run.with_history(judged)
    if not recorded.any():
        return [(kept.iloc[0], "the first with a time history")] if len(kept) else []
    # The median of all flights: among those with a time history is every one that failed.
    typical, median = recorded_at(errors, recorded, (len(errors) - 1) // 2)
    worst = int(np.argmax(np.where(recorded, errors, -1.0)))
    picked = [
        (
            judged.iloc[typical],
            f"{'' if median else 'nearest to '}the median error of the height after 3 minutes",
        )
    ]
    return picked + (
        [(judged.iloc[worst], "the largest error of the height after 3 minutes")]
        if worst != typical
        else []
    )


def _search_words(row: "pd.Series[Any]") -> str:
    """Return when the plume was found and what was believed of it, in words."""
    time, error = float(row.get("time_to_find_s", np.nan)), float(row.get(_LATE, np.nan))
    words = [
        f"Found {time:.0f} s after the orbit was reached"
        if np.isfinite(time)
        else "The plume was not found"
    ]
    if np.isfinite(error):
        believed = f"believed {abs(error):.1f} m too {'high' if error > 0.0 else 'low'}"
        sure = f"± {COVERAGE * row['axis_height_deviation_3min_m']:.1f} m (95 %)"
        words.append(
            f"after 3 minutes its height of {row['axis_height_3min_m']:.1f} m was {believed},"
            f" {sure}"
        )
    if np.isfinite(hits := float(row.get("hit_rate_found", np.nan))):
        words.append(f"{100.0 * hits:.0f} % of the passes since then hit it")
    enough = row.get("enough")
    words += [f"the flight ended with {enough}"] if isinstance(enough, str) and enough else []
    return f"{'; '.join(words)}."
