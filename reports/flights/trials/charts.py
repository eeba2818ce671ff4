"""Figures of a trial, by what it is about."""

import math
from collections.abc import Sequence

import numpy as np

from reports.document.chart import Chart, Line, Panel, circle
from reports.document.map_marks import hull_line, on_map, plume_lines
from reports.document.palette import Meaning
from reports.document.panels import (
    COUNTED_MIN,
    Group,
    capped,
    classes,
    histogram,
    points,
    quartiles,
    strips,
)
from reports.flights.names import changes_flights, manoeuvres_flown, swept_words
from reports.flights.trials.panels_over import (
    LIMIT_LABEL,
    PanelsOver,
    by_violation,
    by_words,
)
from reports.monte_carlo.names import input_name
from reports.run.columns import NOTICEABLE, Array, clearance, column, figure, total
from reports.run.faults import names_of_faults
from reports.run.ship import hull_of
from reports.run.trials import Kind, Trial

_Figure = tuple[Array, str, list[tuple[float, str]]]
"""Values of the flights, the label of their axis, and values to be marked, by name."""

_ROW = 3
"""Panels that stand in one row."""

_OVER_THEORY = 2
"""Figures of a sweep that show theory, too, and so are drawn of a single flight: the table says all
that is in the others.
"""

_LIMIT_TOLD = (
    " The limit is the shortest that bank and roll rate allow any path with two crossings a period, by optimal control, with"
    " nothing reserved for feedback."
)
"""What a caption says of the shortest interval of any path, where that is drawn."""

_NEVER = "never settled"
"""What the legend calls flights that did not settle: black as the slowest to settle, and so of
another shape.
"""

_R_MIN = (0.0, "r_min")
_TRACKING = "tracking_error_rms_m"


def trial_charts(trial: Trial) -> list[Chart]:
    """Return the figures of a trial, of the flights that have something to show."""
    makers = {
        Kind.SWEEP: [_sweep],
        Kind.FAULTS: [_faults],
        Kind.MANOEUVRES: [_manoeuvres],
        Kind.APPROACH: [_starts, _distances],
        Kind.GENERAL: [_distances, _errors],
    }
    charts = (
        [chart for maker in makers[trial.kind] for chart in maker(trial)]
        if len(trial.flown)
        else []
    )
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
    columns = max(1, min(columns if len(shown) != _ROW else _ROW, len(shown)))
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
    if len(numbers) > 1:
        in_rows = [numbers[i : i + _ROW] for i in range(0, len(numbers), _ROW)]
        charts = [chart for keys in in_rows for chart in _over_keys(trial, keys, names[keys[0]])]
    else:
        charts = [chart for key in numbers for chart in _over_key(trial, key, names[key])]
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


def _over_keys(trial: Trial, keys: Sequence[str], name: str) -> list[Chart]:
    """Return two figures over several keys, a column for each."""
    every = [PanelsOver(trial, key, by_words(trial), by_words=True) for key in keys]
    crossings = (
        "Time between plume crossings against half the reference's period, π/ω₀, with bars of one standard deviation; below,"
        " distances from the funnel's mouth, of the crossings after settling, three-dimensional, and the closest approach of the"
        f" whole flight, {trial.measured_from}. A column for each key: flights of other values of the other keys stand above each"
        " other."
    )
    errors = "Tracking error, the distance to the reference, after settling, and settling time, over the same keys."
    rows = {
        ("crossings", crossings): [
            [over.interval() for over in every],
            [over.distances() for over in every],
        ],
        ("errors", errors): [
            [over.figure(_TRACKING) for over in every],
            [over.figure("settling_time_s") for over in every],
        ],
    }
    return [
        _chart(
            trial,
            f"{name}-{what}",
            caption,
            [panel for row in panels for panel in row],
            0.3,
            columns=len(keys),
        )
        for (what, caption), panels in rows.items()
    ]


def _over_key(trial: Trial, key: str, name: str) -> list[Chart]:
    """Return four figures over one key."""
    over = PanelsOver(trial, key, by_words(trial), by_words=True)
    interval = over.interval()
    settling = over.figure("settling_time_s")
    bank = "Largest bank, and settling time." if settling else "Largest bank."
    if trial.setting("fidelity") == "kinematic":
        bank += " The kinematic vehicle has no bank: shown is that of a coordinated turn."
    charts = [
        _chart(
            trial, f"{name}-interval",
            "Time between plume crossings against half the reference's period, π/ω₀. Bars are one standard deviation."
            + (_LIMIT_TOLD if interval and any(line.label == LIMIT_LABEL for line in interval.lines) else ""),
            [interval, over.interval_error()], 0.28,
        ),
        _chart(
            trial, f"{name}-distance",
            "Distances from the funnel's mouth: of the crossings after settling, three-dimensional, and the closest approach of the"
            f" whole flight, {trial.measured_from}.",
            [over.distances()], 0.22,
        ),
        _chart(
            trial, f"{name}-errors",
            "Errors after settling: tracking error, the distance to the reference; airspeed and altitude off their commands.",
            [
                over.figure(_TRACKING),
                over.figure("airspeed_error_rms_mps"),
                over.figure("altitude_error_max_m"),
            ],
            0.32, columns=3,
        ),
        _chart(
            trial, f"{name}-bank", bank,
            [over.figure("bank_max_deg"), settling], 0.28,
        ),
    ]  # fmt: skip
    return charts if len(trial.flown) > 1 else charts[:_OVER_THEORY]


def _spread(trial: Trial) -> Panel | None:
    predicted, measured = column(trial.flown, "spread_predicted_m"), column(trial.flown, "spread_m")
    most = float(np.nanmax(predicted, initial=0.0))
    if not most > 0.0:
        return None
    lines, top = capped(predicted, measured, by_violation(trial), most, unit="m", what="deviation")
    ends = np.array([0.0, min(top, 1.05 * most)])
    same = Line(x=ends, y=ends, label="turbulence alone", colour="black", style="dot")
    return Panel(
        x_label="From turbulence alone [m]",
        y_label="Deviation towards the vessel [m]",
        lines=[*lines, same],
        y_range=(0.0, top),
    )


def _distances(trial: Trial) -> list[Chart]:
    statistics = trial.run.statistics
    # A Monte Carlo study has the same histograms among its distributions.
    counted_there = statistics is not None and statistics.get("method") != "subset"
    if counted_there and trial.kind is Kind.APPROACH:
        return []
    all_flights = [(clearance(trial.flown), "all flights", Meaning.FLOWN)]
    counted = (
        None
        if counted_there
        else histogram(all_flights, trial.run.column("clearance_m").label, [_R_MIN])
    )
    if trial.kind is Kind.APPROACH:
        settling, label, _ = _figure(trial, "settling_time_s")
        other = histogram([(settling, "", Meaning.FLOWN)], label)
        shown = f"beyond r_min{', and settling time, of those that settled' if other else ''}."
    else:
        other = PanelsOver(trial, "nu", by_violation(trial)).margin()
        shown = f"beyond r_min: {'counted, and ' if counted else ''}against the planned margin."
    caption = (
        f"Closest approach of each flight from its first second, {trial.measured_from}, {shown}"
    )
    return [_chart(trial, "distances", caption, [counted, other], 0.3)]


def _errors(trial: Trial) -> list[Chart]:
    rows, over = trial.flown, PanelsOver(trial, "nu", by_violation(trial))
    largest, typical = column(rows, "vessel_error_max_m"), column(rows, "vessel_error_rms_m")
    vessel = None
    if np.nanmax(largest, initial=0.0) > NOTICEABLE:
        series = [
            (largest, "largest of the flight", "plum"),
            (typical, "rms after settling", Meaning.FLOWN),
        ]
        vessel = histogram(series, "Error of the vessel's position [m]")
    panels = {
        "mean crossing interval": over.interval_error()
        if trial.criteria.get("crossing_interval_error")
        else None,
        "tracking error": over.figure(_TRACKING),
        "its part towards the vessel, from all causes, over the one predicted from turbulence alone": _spread(
            trial
        ),
        "error of the wind estimate": over.figure("wind_error_rms_mps"),
        "error of the vessel's position, counted": vessel,
        "how long the keep-out guard changed commands": (
            over.figure("guard_time_s") if total(rows, "guard_time_s") else None
        ),
    }
    shown = [(words, panel) for words, panel in panels.items() if panel is not None]
    in_rows = [shown[i : i + _ROW] for i in range(0, len(shown), _ROW)]
    captions = [
        f"Each flight, with errors as they are after settling: {'; '.join(words for words, _ in row)}."
        for row in in_rows
    ]
    # A Monte Carlo study has its distributions: one row beside them.
    rows_shown = len(in_rows) if trial.run.statistics is None else 1
    return [
        _chart(trial, f"errors{i}", caption, [panel for _, panel in row], 0.34)
        for i, (caption, row) in enumerate(zip(captions, in_rows, strict=True), start=1)
    ][:rows_shown]


def _starts(trial: Trial) -> list[Chart]:
    rows = trial.flown
    distance, aspect = (
        column(rows, "start_distance_m"),
        np.radians(column(rows, "start_aspect_deg")),
    )
    if np.count_nonzero(np.isfinite(distance)) < COUNTED_MIN:
        return []
    right, along = distance * np.sin(aspect), distance * np.cos(aspect)
    settling, guard = column(rows, "settling_time_s"), column(rows, "guard_time_s")
    unsettled = np.isnan(settling) & np.isfinite(distance)
    never = Line(
        x=right[unsettled], y=along[unsettled], label=_NEVER, colour="black", style="cross"
    )
    guarded: list[Group] = [
        (guard == 0.0, "no intervention", "grey"),
        (guard > 0.0, "guard changed commands", Meaning.GUARD),
    ]
    acted = bool(np.any(guard > 0.0))
    caption = (
        "Where flights began, seen from the ship, who heads as in calm air, with her plume up the page. Coloured by"
        f" how long flights took to settle{' (left), and by whether the keep-out guard changed commands (right)' if acted else ''}."
    )
    settled = classes(settling, quartiles(settling, 10.0), "settled", "s")
    marks = [[*points(right, along, settled), *([never] if len(never.x) else [])]]
    marks += [points(right, along, guarded)] if acted else []
    panels = [_places(trial, float(np.nanmax(distance)), of) for of in marks]
    return [_chart(trial, "starts", caption, panels, 0.48)]


def _places(trial: Trial, farthest: float, marks: list[Line]) -> Panel:
    x, y = circle(trial.radius)
    reach = 1.08 * farthest
    # Flights differ in where their ship heads, so that she is drawn as in calm air: the plume
    # trails behind her.
    lines = [
        Line(x=x, y=y, label="keep-out area, r_min", colour=Meaning.LIMIT, fill=True),
        *plume_lines(np.array([0.0, reach]), None),
        hull_line(hull_of(trial.config), math.pi),
        *marks,
    ]
    panel = Panel(x_label="Right of the plume's axis [m]", y_label="Along it [m]", lines=lines)
    return on_map(panel, north=None)


def _manoeuvres(trial: Trial) -> list[Chart]:
    kinds = manoeuvres_flown(trial)
    if kinds is None:
        return []
    limit = trial.criteria.get("resumes_within_periods")
    criterion = [(float(limit), "criterion")] if limit else []
    resumed = _figure(trial, "resume_periods", *criterion)
    kept = _figure(trial, "clearance_m", _R_MIN)
    caption = (
        "By what the vessel did: time from the end of its last manoeuvre to the next crossing, in periods of the oscillation, and"
        " closest approach of the whole flight."
    )
    return [_strips(trial, "manoeuvres", caption, kinds, "Manoeuvre", [resumed, kept])]


def _faults(trial: Trial) -> list[Chart]:
    kept = _figure(trial, "clearance_m", _R_MIN)
    end = _figure(trial, "end_distance_m", (trial.radius, "r_min"))
    caption = "By the fault: closest approach of the whole flight, and distance from the vessel at the end."
    return [
        _strips(
            trial,
            "faults",
            caption,
            names_of_faults(trial.flown),
            "Fault",
            [kept, end],
        )
    ]


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
