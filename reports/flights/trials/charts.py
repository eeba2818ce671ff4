"""Figures of a trial, by what it is about."""

from collections.abc import Sequence

import numpy as np

from reports.document.chart import Chart, Panel
from reports.document.palette import Meaning
from reports.document.panels import histogram, strips
from reports.flights.names import changes_flights, manoeuvres_flown, swept_words
from reports.flights.trials.panels_over import LIMIT_LABEL, PanelsOver, by_violation, by_words
from reports.monte_carlo.names import input_name
from reports.run.columns import Array, figure
from reports.run.faults import names_of_faults
from reports.run.trials import Kind, Trial

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
    # Of a flight alone the table says all that is not beside theory.
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
    """Return panels beside each other with a row of markers per kind, of which the first names the
    rows.
    """
    known = [figure for figure in figures if np.isfinite(figure[0]).any()]
    panels = [
        strips(values, kinds, x_label, y_label, by_violation(trial), marks, named=i == 0)
        for i, (values, x_label, marks) in enumerate(known)
    ]
    return _chart(trial, name, caption, panels, 0.2 + 0.03 * len(set(kinds)))
