"""Figures of trials over the real sea, by what a trial is about."""

import math
from typing import Any

import numpy as np

from reports.document.chart import Array, Chart, Line, Panel, circle
from reports.document.panels import capped, classes, histogram, level, points, quartiles, strips
from reports.run.trials import Kind, Mask, Trial, clearance, column, entered, interval_error

_NU = "Speed ratio ν [-]"
_CLEARANCE = "Distance kept beyond r_min [m]"
_WIND_BOUNDS = (2.5, 5.0, 7.5)
_R_MIN = (0.0, "r_min")


def trial_charts(trial: Trial) -> list[Chart]:
    """Return the figures of a trial, of the flights that have something to show."""
    makers = {
        Kind.FAULTS: [_faults],
        Kind.TOGETHER: [_keeping_out, _estimates],
        Kind.MANOEUVRES: [_manoeuvres],
        Kind.TURBULENCE: [_turbulence],
        Kind.CROSSINGS: [_crossings],
        Kind.APPROACH: [_starts, _settling],
        Kind.OTHER: [_keeping_out, _estimates],
    }
    charts = [maker(trial) for maker in makers[trial.kind]] if len(trial.flown) else []
    return [chart for chart in charts if chart is not None]


def _chart(trial: Trial, name: str, caption: str, panels: list[Panel | None], height: float) -> Chart | None:
    """Return a chart of the panels that show anything, two beside each other, or None."""
    shown = [panel for panel in panels if panel is not None and any(len(line.x) for line in panel.lines)]
    if not shown:
        return None
    columns = min(2, len(shown))
    return Chart(name=f"{trial.name}-{name}", caption=caption, panels=shown, columns=columns, panel_height=height)


def _every(trial: Trial) -> list[tuple[Mask, str, str]]:
    """Return the flights that kept out and those that did not, as groups of markers."""
    inside = entered(trial.flown)
    return [(~inside, "flight", "blue"), (inside, "flight that entered", "vermillion")]


def _limit(trial: Trial, key: str) -> float:
    value = trial.criteria.get(key)
    return math.nan if value is None else float(value)


def _crossings(trial: Trial) -> Chart | None:
    rows = trial.flown
    nu, wind = column(rows, "nu"), column(rows, "wind_speed_mps")
    groups = classes(wind, _WIND_BOUNDS, "wind", "m/s")
    limit = 100.0 * _limit(trial, "crossing_interval_error")
    lines = [*points(nu, 100.0 * interval_error(rows), groups), level(nu, limit, "criterion"), level(nu, -limit, "criterion")]
    intervals = Panel(x_label=_NU, y_label="Mean interval against π/ω₀ [%]", lines=lines)
    return _chart(
        trial,
        "crossings",
        "Left: mean time between plume crossings against half the reference's period, a marker per flight. Right: how well each"
        " flight knew the wind, rms after settling.",
        [intervals, _wind_error(trial, groups)],
        0.4,
    )


def _wind_error(trial: Trial, groups: list[tuple[Mask, str, str]]) -> Panel:
    rows = trial.flown
    lines, top = capped(column(rows, "nu"), column(rows, "wind_error_rms_mps"), groups, math.nan)
    return Panel(x_label=_NU, y_label="Error of the wind estimate, rms [m/s]", lines=lines, y_range=(0.0, top))


def _tracking(trial: Trial) -> Panel:
    rows = trial.flown
    nu, limit = column(rows, "nu"), _limit(trial, "tracking_error_rms_m")
    lines, top = capped(nu, column(rows, "tracking_error_rms_m"), _every(trial), limit)
    limits = [] if math.isnan(limit) else [level(nu, limit, "criterion")]
    return Panel(x_label=_NU, y_label="Tracking error, rms [m]", lines=[*lines, *limits], y_range=(0.0, top))


def _spread(trial: Trial) -> Panel | None:
    rows = trial.flown
    predicted, measured = column(rows, "spread_predicted_m"), column(rows, "spread_m")
    if not np.nanmax(predicted, initial=0.0) > 0.0:
        return None
    lines, top = capped(predicted, measured, _every(trial), float(np.nanmax(predicted)))
    ends = np.array([0.0, min(top, 1.05 * float(np.nanmax(predicted)))])
    same = Line(x=ends, y=ends, label="as predicted", colour="black", style="dot")
    return Panel(
        x_label="Predicted spread [m]", y_label="Measured spread towards the vessel [m]", lines=[*lines, same], y_range=(0.0, top)
    )


def _margin(trial: Trial) -> Panel:
    rows = trial.flown
    planned = column(rows, "keepout_margin_m")
    all_alike = float(np.ptp(planned)) < 1e-6
    x, x_label = (column(rows, "nu"), _NU) if all_alike else (planned, "Planned margin [m]")
    lines = [*points(x, clearance(rows), _every(trial)), level(x, 0.0, "r_min", "black")]
    if all_alike:
        lines.append(level(x, float(planned[0]), "planned margin", "green"))
    else:
        ends = np.array([float(planned.min()), float(planned.max())])
        lines.append(Line(x=ends, y=ends, label="planned margin", colour="green", style="dash"))
    return Panel(x_label=x_label, y_label=_CLEARANCE, lines=lines)


def _turbulence(trial: Trial) -> Chart | None:
    return _chart(
        trial,
        "turbulence",
        "A marker per flight. What of the planned margin was left at the closest approach, from the first second; the tracking"
        " error after settling; the spread of that error towards the vessel against the one that the margin was planned for,"
        " where one was; and how well the wind was known.",
        [_margin(trial), _tracking(trial), _spread(trial), _wind_error(trial, _every(trial))],
        0.38,
    )


def _keeping_out(trial: Trial) -> Chart | None:
    counted = histogram([(clearance(trial.flown), "all flights", "blue")], _CLEARANCE, [_R_MIN])
    return _chart(
        trial,
        "keepingout",
        "Closest approach of each flight from its first second, beyond r_min: counted, and against the margin that was planned.",
        [counted, _margin(trial)],
        0.38,
    )


def _estimates(trial: Trial) -> Chart | None:
    rows = trial.flown
    vessel = None
    if trial.reported:
        largest = (column(rows, "vessel_error_max_m"), "largest of the flight", "orange")
        typical = (column(rows, "vessel_error_rms_m"), "rms after settling", "blue")
        vessel = histogram([largest, typical], "Error of the vessel's place [m]")
    nu, guard = column(rows, "nu"), column(rows, "guard_time_s")
    lines, top = capped(nu, guard, _every(trial), float(np.quantile(guard, 0.95)) + 1.0)
    guarding = Panel(x_label=_NU, y_label="Guard changes commands for [s]", lines=lines, y_range=(-0.03 * top, top))
    return _chart(
        trial,
        "estimates",
        "How well the UAV knew the vessel's place (if by reports) and the wind, how well it tracked its reference, and for how"
        " long the keep-out guard changed its commands. A marker per flight.",
        [vessel, _wind_error(trial, _every(trial)), _tracking(trial), guarding],
        0.36,
    )


def _starts(trial: Trial) -> Chart | None:
    rows = trial.flown
    distance, aspect = column(rows, "start_distance_m"), np.radians(column(rows, "start_aspect_deg"))
    right, along = distance * np.sin(aspect), distance * np.cos(aspect)
    settling, guard = column(rows, "settling_time_s"), column(rows, "guard_time_s")
    bounds = quartiles(settling, 10.0)
    never = (np.isnan(settling), "never settled", "black")
    guarded = [
        (guard == 0.0, "no guard", "grey"),
        ((guard > 0.0) & (guard <= 5.0), "guard for up to 5 s", "green"),
        (guard > 5.0, "guard for longer", "purple"),
    ]
    return _chart(
        trial,
        "starts",
        "Where flights began, seen from the vessel with its plume trailing up the page; coloured by how long they took to settle"
        " (left), and by how long the keep-out guard changed commands (right).",
        [
            _places(trial, right, along, [*classes(settling, bounds, "settled", "s"), never]),
            _places(trial, right, along, guarded),
        ],
        0.48,
    )


def _places(trial: Trial, right: Array, along: Array, groups: list[Any]) -> Panel:
    x, y = circle(trial.radius)
    reach = 1.08 * float(np.nanmax(np.hypot(right, along)))
    return Panel(
        x_label="Right of the plume's axis [m]",
        y_label="Along the plume's axis [m]",
        equal=True,
        lines=[
            Line(x=x, y=y, label="keep-out area", colour="vermillion", fill=True),
            Line(x=np.zeros(2), y=np.array([0.0, reach]), label="plume", colour="grey", style="dash"),
            *points(right, along, groups),
        ],
        x_range=(-reach, reach),
        y_range=(-reach, reach),
    )


def _settling(trial: Trial) -> Chart | None:
    rows = trial.flown
    return _chart(
        trial,
        "settling",
        "Settling time, of the flights that settled, and closest approach of each flight from its first second.",
        [
            histogram([(column(rows, "settling_time_s"), "", "blue")], "Settling time [s]"),
            histogram([(clearance(rows), "", "blue")], _CLEARANCE, [_R_MIN]),
        ],
        0.34,
    )


def _manoeuvres(trial: Trial) -> Chart | None:
    rows = trial.flown
    flown = trial.rows["min_distance_m"].notna()
    kinds = [manoeuvre_name(value) for value, shown in zip(trial.dealt("vessel.manoeuvres"), flown, strict=True) if shown]
    limit, periods = _limit(trial, "resumes_within_periods"), column(rows, "resume_periods")
    known = bool(np.isfinite(periods).any())
    resumed = "Next crossing after the manoeuvre [periods]"
    groups = _every(trial)
    criterion = [] if math.isnan(limit) else [(limit, "criterion")]
    return _chart(
        trial,
        "manoeuvres",
        "By what the vessel did: time from the end of its last manoeuvre to the next crossing, in periods of the oscillation, and"
        " closest approach of the whole flight.",
        [
            strips(periods, kinds, resumed, "Manoeuvre [-]", groups, criterion, named=True) if known else None,
            strips(clearance(rows), kinds, _CLEARANCE, "Manoeuvre [-]", groups, [_R_MIN], named=not known),
        ],
        0.2 + 0.03 * len(set(kinds)),
    )


def manoeuvre_name(manoeuvres: list[dict[str, Any]]) -> str:
    """Return what a vessel does, in a few words."""
    return ", then ".join(_one_manoeuvre(manoeuvre) for manoeuvre in manoeuvres) or "none"


def _one_manoeuvre(manoeuvre: dict[str, Any]) -> str:
    parts = []
    turn, speed = float(manoeuvre.get("turn_deg", 0.0)), manoeuvre.get("speed_mps")
    if turn:
        rate = f" at {float(manoeuvre['turn_rate_deg_s']):g}°/s" if "turn_rate_deg_s" in manoeuvre else ""
        parts.append(f"{abs(turn):g}° to {'starboard' if turn > 0.0 else 'port'}{rate}")
    if speed is not None:
        parts.append("stops" if speed == 0.0 else f"to {float(speed):g} m/s")
    return " and ".join(parts) or "holds on"


def _faults(trial: Trial) -> Chart | None:
    rows = trial.flown
    kinds = [fault_name(kind) for kind in rows["fault"]]
    groups = _every(trial)
    radius = [(trial.radius, "r_min")]
    return _chart(
        trial,
        "faults",
        "By what failed: closest approach of the whole flight, and distance from the vessel at the end.",
        [
            strips(clearance(rows), kinds, _CLEARANCE, "Fault [-]", groups, [_R_MIN], named=True),
            strips(column(rows, "end_distance_m"), kinds, "Distance at the end [m]", "Fault [-]", groups, radius, named=False),
        ],
        0.2 + 0.03 * len(set(kinds)),
    )


def fault_name(kind: object) -> str:
    """Return what a fault is called."""
    return str(kind).replace("_", " ")
