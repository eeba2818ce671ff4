"""Figures of a trial, by what it is about, and panels over a key in which its flights differ."""

import math
from collections.abc import Sequence

import numpy as np

from reports.document.chart import Chart, Line, Panel, Style
from reports.document.palette import SERIES, Meaning, series_colour
from reports.document.panels import Group, around, capped, histogram, level, points, strips
from reports.flights.names import (
    changes_flights,
    flown_elsewhere,
    manoeuvres_flown,
    swept_words,
    words_together,
)
from reports.monte_carlo.names import input_label, input_name
from reports.run.columns import Array, clearance, column, figure, interval_error, violated
from reports.run.flight_config import is_level, names_of_faults
from reports.run.trials import Kind, Trial

_OSCILLATIONS: tuple[tuple[str, str, str, Style], ...] = (
    ("sinusoid", "sinusoid", "grey", "dash"),
    ("fastest", "fastest oscillation", "black", "dash"),
)
"""Shapes whose crossing interval is shown where another one is flown: name, label, colour and
style.
"""

LIMIT_LABEL = "limit, two crossings a period"

_LIMIT: tuple[str, str, Style] = (LIMIT_LABEL, Meaning.LIMIT, "dot")
"""Label, colour and style of the shortest interval of any path."""

_PLAIN = ("flight", "largest command")
"""Labels of what a panel shows alone: a word that was swept stands in the place of these."""

_MARGINS_APART = 0.05
"""Range of the planned margins, over the largest, from which they are an abscissa [-]."""

_RATIOS = (-0.02, 1.02)
"""Speed ratios that a panel shows, however many are flown [-]."""


def by_violation(trial: Trial) -> list[Group]:
    """Return the flights without a keep-out violation and those with one, as groups of markers."""
    inside = violated(trial.flown)
    return [
        (~inside, "flight", Meaning.FLOWN),
        (inside, "flight with a keep-out violation", Meaning.LIMIT),
    ]


def by_words(trial: Trial) -> list[Group]:
    """Return the flights in groups of the words that were swept, as laws, each of a colour; by
    violation where no word was swept.

    Where there are more words than colours, no word has one.
    """
    words, inside = words_together(trial), violated(trial.flown)
    names = list(dict.fromkeys(words))
    if not 1 < len(names) <= len(SERIES):
        return by_violation(trial)
    groups: list[Group] = [
        (np.array([word == name for word in words]) & ~inside, name, series_colour(i))
        for i, name in enumerate(names)
    ]
    return [*groups, *by_violation(trial)[1:]]


class PanelsOver:
    """Panels over one key, of the flights that were flown; each is None if no flight has its
    figure.

    Parameters
    ----------
    trial, key : whose flights, and over what; a key of figures
    groups : in which markers are coloured
    by_words : whether these are of words that were swept, so that what is measured of flights is
        coloured by them, too
    """

    def __init__(
        self, trial: Trial, key: str, groups: list[Group], *, by_words: bool = False
    ) -> None:
        self._parted = by_words and len(groups) > len(by_violation(trial))
        self._trial, self._key, self._groups, self._rows = trial, key, groups, trial.flown
        self._x = trial.input(key).reindex(self._rows["flight_id"]).to_numpy(dtype=np.float64)
        self._span = np.array([0.0, 1.0]) if key == "nu" else self._x
        ratio = "Speed ratio ν as flown [-]" if flown_elsewhere(trial) else "Speed ratio ν [-]"
        self._label = ratio if key == "nu" else input_label(key)

    def figure(self, name: str) -> Panel | None:
        """Return a panel of any figure, its criterion if it has one, and those far above all others
        at its edge.
        """
        of = self._trial.run.column(name)
        limit = of.scale * self.limit(name)
        y = of.scale * column(self._rows, name)
        words = of.title.partition(",")[0].lower()
        lines, top = capped(self._x, y, self._groups, limit, of.after.strip(), words)
        criterion = [] if math.isnan(limit) else [level(self._span, limit, "criterion")]
        least = float(np.nanmin(y, initial=0.0))
        y_range = (least - 0.03 * (top - least), top)
        return self._panel(of.label, [*lines, *criterion], y_range=y_range)

    def interval_error(self) -> Panel | None:
        """Return the mean crossing interval against its prediction."""
        limit = 100.0 * self.limit("crossing_interval_error")
        criterion = (
            []
            if math.isnan(limit)
            else [level(self._span, side * limit, "criterion") for side in (1.0, -1.0)]
        )
        return self._panel(
            "Mean interval against π/ω₀ [%]",
            [*points(self._x, 100.0 * interval_error(self._rows), self._groups), *criterion],
        )

    def interval(self) -> Panel | None:
        """Return the crossing interval, with bars of one standard deviation, its prediction, and
        what else could be flown.
        """
        flown = self._points(
            "crossing_interval_mean_s", "flight", Meaning.FLOWN, error="crossing_interval_std_s"
        )
        theory = self._theory("crossing_interval_predicted_s", "theory, π/ω₀", "black")
        return self._panel("Crossing interval [s]", [*self._other_intervals(), theory, *flown])

    def _other_intervals(self) -> list[Line]:
        """Return the intervals of the oscillations that were not flown, and the shortest of any
        path; none over other keys.
        """
        shape = str(self._trial.setting("reference.shape", ""))
        curves = [
            (self._trial.theory(f"crossing_interval_{other}_s"), label, colour, style)
            for other, label, colour, style in _OSCILLATIONS
            if other != shape
        ]
        curves.append((self._trial.theory("crossing_interval_limit_s", "limit_nu"), *_LIMIT))
        if self._key != "nu":
            return []
        return [
            Line(x=curve[0], y=curve[1], label=label, colour=colour, style=style)
            for curve, label, colour, style in curves
            if curve
        ]

    def distances(self) -> Panel | None:
        """Return the distances of the crossings and the closest approach."""
        closest = (
            "closest approach, horizontal"
            if is_level(self._trial.shape)
            else "closest approach, whole flight"
        )
        lines = [
            self._limit("keepout_radius_m", f"r_min of the keep-out {self._trial.shape}"),
            self._theory("r_co_m", "centre of oscillation r_CO", "grey"),
            *self._points(
                "crossing_distance_mean_m",
                "crossings, mean",
                Meaning.CROSSING,
                "dots" if self._parted else "points",
            ),
            *self._points(
                "crossing_distance_min_m", "crossings, closest", Meaning.CROSSING, "ring"
            ),
            *self._points(
                "min_distance_m", closest, Meaning.FLOWN, "square" if self._parted else "points"
            ),
        ]
        return self._panel("Distance from the stack [m]", lines)

    def margin(self) -> Panel | None:
        """Return what of the planned margin was left, over the margin if flights differ in it by
        much.
        """
        planned, kept = column(self._rows, "keepout_margin_m"), clearance(self._rows)
        beyond = self._trial.run.column("clearance_m").label
        if not np.isfinite(planned).any():
            return self._panel(
                beyond, [*points(self._x, kept, self._groups), level(self._span, 0.0, "r_min")]
            )
        if float(np.ptp(planned)) <= _MARGINS_APART * float(np.max(planned)):
            margin = level(self._span, float(np.mean(planned)), "planned margin", Meaning.COMMANDED)
            levels = [level(self._span, 0.0, "r_min"), margin]
            return self._panel(beyond, [*points(self._x, kept, self._groups), *levels])
        ends = np.array([float(planned.min()), float(planned.max())])
        same = Line(x=ends, y=ends, label="planned margin", colour=Meaning.COMMANDED, style="dash")
        levels = [level(planned, 0.0, "r_min"), same]
        return Panel(
            x_label=self._trial.run.column("keepout_margin_m").label,
            y_label=beyond,
            lines=[*points(planned, kept, self._groups), *levels],
        )

    def limit(self, key: str) -> float:
        """Return the limit of a criterion, or not a number."""
        value = self._trial.criteria.get(key)
        # A criterion that does not apply is false.
        return math.nan if value is None or value is False else float(value)

    def _points(
        self, name: str, label: str, colour: str, style: Style = "points", error: str = ""
    ) -> list[Line]:
        """Return what is measured of the flights, in its colour; of each word that was swept in the
        colour of that.
        """
        bars, values = column(self._rows, error) if error else None, column(self._rows, name)
        if not self._parted:
            return [Line(x=self._x, y=values, label=label, colour=colour, style=style, error=bars)]
        return [
            Line(
                x=self._x[of],
                y=values[of],
                label=word if label in _PLAIN else f"{word}: {label}",
                colour=tint,
                style=style,
                error=None if bars is None else bars[of],
            )
            for of, word, tint in self._groups
            if np.any(of)
        ]

    def _theory(self, name: str, label: str, colour: str) -> Line:
        """Return what theory says: its curve over the speed ratio, however few flights there are;
        else a mark for each flight.
        """
        curve = self._trial.theory(name) if self._key == "nu" else None
        if curve is None:
            return Line(
                x=self._x, y=column(self._rows, name), label=label, colour=colour, style="diamonds"
            )
        return Line(x=curve[0], y=curve[1], label=label, colour=colour)

    def _limit(self, name: str, label: str) -> Line:
        """Return a limit of the flights: a level if it is the same for all."""
        values = column(self._rows, name)
        if len(values) and np.ptp(values) < 1e-9:
            return level(self._span, float(values[0]), label)
        return Line(x=self._x, y=values, label=label, colour=Meaning.LIMIT, style="diamonds")

    def _panel(
        self, y_label: str, lines: list[Line], y_range: tuple[float, float] | None = None
    ) -> Panel | None:
        known = [line for line in lines if np.isfinite(line.y).any()]
        shown = any(
            line.style in ("points", "dots", "diamonds", "ring", "square") for line in known
        )
        if not shown:
            return None
        x_range = _RATIOS if self._key == "nu" else around(self._x)
        return Panel(
            x_label=self._label, y_label=y_label, lines=known, x_range=x_range, y_range=y_range
        )


_Figure = tuple[Array, str, list[tuple[float, str]]]
"""Values of the flights, the label of their axis, and values to be marked, by name."""

_ROW = 3
"""Panels that stand in one row."""

_R_MIN = (0.0, "r_min")
_TRACKING = "tracking_error_rms_m"


def trial_charts(trial: Trial) -> list[Chart]:
    """Return the figures of a trial, of the flights that have something to show."""
    makers = {Kind.SWEEP: _sweep, Kind.FAULTS: _faults, Kind.MANOEUVRES: _manoeuvres}
    charts = makers.get(trial.kind, _distances)(trial) if len(trial.flown) else []
    return [chart for chart in charts if chart.panels]


def _chart(
    trial: Trial,
    name: str,
    caption: str,
    panels: Sequence[Panel | None],
    height: float,
    columns: int = 2,
) -> Chart:
    """Return a chart of the panels that show anything."""
    shown = [
        panel for panel in panels if panel is not None and any(len(line.x) for line in panel.lines)
    ]
    columns = max(1, min(columns, len(shown)))
    # What would be alone in its row is as wide as the page.
    last = height if len(shown) > columns and len(shown) % columns == 1 else 0.0
    return Chart(
        name=f"{trial.name}-{name}",
        caption=caption,
        panels=shown,
        columns=columns,
        panel_height=height,
        last_height=last,
    )


def _sweep(trial: Trial) -> list[Chart]:
    """Return the figures over the keys that were swept: over several numbers in as many columns,
    over one in more detail.
    """
    names = {
        key: f"{key.rsplit('.', 1)[-1]}{i}".replace("_", "")
        for i, key in enumerate(trial.swept, start=1)
    }
    words = swept_words(trial)
    numbers = [key for key in trial.swept if key not in words]
    in_rows = [numbers[i : i + _ROW] for i in range(0, len(numbers), _ROW)]
    charts = [chart for keys in in_rows for chart in _over(trial, keys, names[keys[0]])]
    return [
        *charts,
        *(
            _by_word(trial, key, of, names[key])
            for key, of in words.items()
            if changes_flights(trial, key)
        ),
    ]


def _figure(trial: Trial, name: str, *marks: tuple[float, str]) -> _Figure:
    """Return a figure of the flights that were flown, with what its axis says and its marks."""
    of = trial.run.column(name)
    return of.scale * figure(trial.flown, name), of.label, list(marks)


def _by_word(trial: Trial, key: str, words: list[str], name: str) -> Chart:
    """Return figures by a key that is no number."""
    figures: list[_Figure] = [
        _figure(trial, "clearance_m", _R_MIN),
        _figure(trial, _TRACKING),
    ]
    caption = "Closest approach of the whole flight, and tracking error after settling."
    return _strips(trial, name, caption, words, input_name(key), figures)


def _over(trial: Trial, keys: Sequence[str], name: str) -> list[Chart]:
    """Return the crossings and the errors of flights over keys that were swept: over one with what
    is off its prediction, over several in a column for each.
    """
    every = [PanelsOver(trial, key, by_words(trial), by_words=True) for key in keys]
    intervals = [over.interval() for over in every]
    figures = [_TRACKING, "settling_time_s"]
    if len(keys) == 1:
        intervals += [every[0].interval_error()]
        figures += ["airspeed_error_rms_mps", "altitude_error_max_m"]
    shortest = any(
        line.label == LIMIT_LABEL for panel in intervals if panel for line in panel.lines
    )
    caption = _CROSSINGS.format(closest=trial.measured_from) + _SHORTEST * shortest
    columns = max(2, len(keys))
    crossings = [*intervals, *(over.distances() for over in every)]
    charts = [_chart(trial, f"{name}-crossings", caption, crossings, 0.27, columns)]
    # The table says all of a single flight that is not beside theory.
    if len(trial.flown) > 1:
        errors = [over.figure(figure) for figure in figures for over in every]
        charts.append(_chart(trial, f"{name}-errors", _ERRORS, errors, 0.25, columns))
    return charts


_CROSSINGS = (
    "Time between plume crossings against half the reference's period, π/ω₀, with bars of one"
    " standard deviation. Distances from the stack's mouth: of the crossings after settling,"
    " three-dimensional, and the closest approach of the whole flight, {closest}."
)
_SHORTEST = (
    " The limit is the shortest that bank and roll rate allow any path with two crossings a period,"
    " by optimal control, with nothing reserved for feedback."
)
_ERRORS = "Errors after settling, and the time to settle."


def _distances(trial: Trial) -> list[Chart]:
    """Return how near flights came: counted, and against the planned margin."""
    statistics = trial.run.statistics
    margin = PanelsOver(trial, "nu", by_violation(trial)).margin()
    # A Monte Carlo study has the same histogram among its distributions.
    if statistics is not None and statistics.get("method") != "subset":
        return [_chart(trial, "distances", _NEAREST.format(trial.measured_from), [margin], 0.3)]
    kept, label, marks = _figure(trial, "clearance_m", _R_MIN)
    counted = histogram([(kept, "all flights", Meaning.FLOWN)], label, marks)
    caption = _NEAREST.format(trial.measured_from)
    return [_chart(trial, "distances", caption, [counted, margin], 0.3)]


_NEAREST = "Closest approach of each flight beyond r_min, from its first second, {}."


def _manoeuvres(trial: Trial) -> list[Chart]:
    kinds = manoeuvres_flown(trial)
    if kinds is None:
        return []
    limit = trial.criteria.get("resumes_within_periods")
    criterion = [(float(limit), "criterion")] if limit else []
    resumed = _figure(trial, "resume_periods", *criterion)
    kept = _figure(trial, "clearance_m", _R_MIN)
    caption = (
        "By what the vessel did: time from the end of its last manoeuvre to the next crossing, in"
        " periods of the oscillation, and closest approach of the whole flight."
    )
    return [_strips(trial, "manoeuvres", caption, kinds, "Manoeuvre", [resumed, kept])]


def _faults(trial: Trial) -> list[Chart]:
    kept = _figure(trial, "clearance_m", _R_MIN)
    end = _figure(trial, "end_distance_m", (trial.radius, "r_min"))
    caption = (
        "By the fault: closest approach of the whole flight, and distance from the vessel at the"
        " end."
    )
    return [_strips(trial, "faults", caption, names_of_faults(trial.flown), "Fault", [kept, end])]


def _strips(
    trial: Trial, name: str, caption: str, kinds: list[str], y_label: str, figures: list[_Figure]
) -> Chart:
    """Return panels beside each other with a row of markers per kind; the first panel names the
    rows.
    """
    known = [figure for figure in figures if np.isfinite(figure[0]).any()]
    panels = [
        strips(values, kinds, x_label, y_label, by_violation(trial), marks, named=i == 0)
        for i, (values, x_label, marks) in enumerate(known)
    ]
    return _chart(trial, name, caption, panels, 0.2 + 0.03 * len(set(kinds)))
