"""The paper's figures 3 to 9, each on its kinematic vehicle and on the aircraft, side by side."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from reports.document.chart import Chart, Line, Panel, Style, across
from reports.document.map_marks import on_map
from reports.document.palette import Meaning
from reports.document.ship_map import ship_lines
from reports.paper.flown import VEHICLES, Flown, find_flight, vehicle_name
from reports.run.columns import Array, column
from reports.run.flight_config import flight_config, is_level, keepout_shape
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import keepout_distance

_PHI_GONE = 0.02
"""|phi| below which a coincidence of phi and phi_r counts as one at zero [rad]."""


def sim_1_charts(run: RunData) -> list[Chart]:
    """Return figures 3, 4 and 5: a circular reference, opposite initial headings."""
    return [
        _side_by_side(
            run, ["sim1"], _figure_3, name="fig3", aspect=0.9, panel_height=0.44,
            labels=("East [m]", "North [m]"),
            caption=(
                "To put beside the paper's figure 3: the circular reference and the UAV. Rings:"
                " where each is at the start."
            ),
        ),
        _side_by_side(
            run, ["sim1"], _figure_4, name="fig4", labels=("Time [s]", "Angle [rad]"),
            caption="The paper's figure 4: "
            "φ, course of the UAV against that of z, goes to zero first; then φ_r follows as the"
            " unforced system does.",
        ),
        _side_by_side(
            run, ["sim1"], _figure_5, name="fig5", labels=("Time [s]",
            "Distance to the reference [m]"),
            caption="The paper's figure 5: "
            "while |φ| ≤ |φ_r| the distance does not rise. Where φ_r = φ the rate of V₁ vanishes,"
            " eq. (35): a peak or a trough of the distance while φ is not zero, a saddle point"
            " once it is. The aircraft closes in there too, for it trims its airspeed.",
        ),
    ]  # fmt: skip


def sim_2_charts(run: RunData) -> list[Chart]:
    """Return figures 6 and 7, and the distance, which the paper does not show: line of sight
    against the delta formulation.
    """
    cases = ["sim2_los", "sim2_delta"]
    return [
        _side_by_side(
            run, cases, _figure_6, name="fig6", aspect=1.2, panel_height=0.36, labels=("East [m]",
            "North [m]"),
            caption=(
                "The paper's figure 6: both UAVs start in front of the reference and fly the"
                " other way. UAV 1 steers by the line of sight, UAV 2 by the δ formulation. Rings:"
                " starts."
            ),
        ),
        _side_by_side(
            run, cases, _figure_7, name="fig7", labels=("Time [s]", "Heading-rate demand [rad/s]"),
            caption="The paper's figure 7: "
            "the heading-rate demand of each law. Dashed: ±ω_max. The kinematic UAV 1 flies its"
            " demand, as in the paper; the aircraft's commands are cut at ω_max.",
        ),
        _side_by_side(
            run, cases, _distances, name="sim2distance", labels=("Time [s]",
            "Distance to the reference [m]"),
            caption=(
                "Not in the paper: UAV 1 is near sooner, but at constant speed stays behind the"
                " reference. The aircraft trims its airspeed and catches up, and there its line of"
                " sight swings again and again. UAV 2 gets onto the reference."
            ),
        ),
    ]  # fmt: skip


def sim_3_charts(run: RunData) -> list[Chart]:
    """Return figures 8 and 9, of the smoke plume; none of flights without a vessel."""
    flights = run.summary[run.summary["flight_id"].astype(str).str.startswith("sim3_")]
    if flights["nu"].isna().any():
        return []

    def figure_8(flights: dict[str, Flown]) -> list[Line]:
        flown = flights["sim3"]
        times = run.crossings_of(str(flown.row["flight_id"]))["time_s"].to_numpy(dtype=np.float64)
        times = times[times <= flown.time[-1]]
        east, north = (
            np.interp(times, flown.time, flown.column(name)) for name in ("east_m", "north_m")
        )
        about = surroundings(flight_config(run, flown.row), flown.row, flown.history)
        place = (float(flown.column(name)[-1]) for name in ("vessel_east_m", "vessel_north_m"))
        return [
            *ship_lines(about, 0.0, *place),
            _path(flown, "vessel_", "ship's track", Meaning.SHIP, "thin"),
            _path(flown, "", "flown"),
            _path(flown, "reference_", "reference", Meaning.ASKED, "thin"),
            _crossings(east, north),
        ]

    def figure_9(flights: dict[str, Flown]) -> list[Line]:
        flown = flights["sim3"]
        crossings = run.crossings_of(str(flown.row["flight_id"]))
        config = flight_config(run, flown.row)
        times, distance = (
            crossings["time_s"].to_numpy(dtype=np.float64),
            keepout_distance(flown.history, config),
        )
        crossed = column(
            crossings,
            "horizontal_distance_m" if is_level(keepout_shape(config)) else "distance_m",
        )
        return [
            across(flown.time[[0, -1]], float(flown.row["keepout_radius_m"]), "r_min"),
            Line(x=flown.time, y=distance, label="flown", colour=Meaning.FLOWN),
            _crossings(times, crossed),
        ]

    return [
        _side_by_side(
            run, ["sim3"], figure_8, name="fig8", aspect=4.6, labels=("East [m]", "North [m]"),
            shown_after=100.0, columns=1,
            panel_height=0.2,
            caption=(
                "The paper's figure 8: over the ground. The UAV starts at a random place behind"
                " the ship. Diamonds: plume crossings after settling, of which the first hundred"
                " seconds are shown; ship, plume and keep-out area at the end of them."
            ),
        ),
        _side_by_side(
            run, ["sim3"], figure_9, name="fig9", labels=("Time [s]", "Distance to the vessel [m]"),
            shown_after=math.inf,
            caption="The paper's figure 9: "
            "distance between the vessel, at its stack, and the UAV; dashed the radius of the"
            " keep-out area.",
        ),
    ]  # fmt: skip


def coincidences(flown: Flown) -> Array:
    """Return the times at which phi_r = phi [s], linear between samples. Jumps by a turn do not
    count.
    """
    gap = flown.column("phi_r_rad") - flown.column("phi_rad")
    at = np.nonzero((gap[:-1] * gap[1:] < 0.0) & (np.abs(np.diff(gap)) < math.pi))[0]
    fraction = gap[at] / (gap[at] - gap[at + 1])
    return flown.time[at] + fraction * (flown.time[at + 1] - flown.time[at])


Lines = Callable[[dict[str, Flown]], list[Line]]


def _side_by_side(
    run: RunData,
    cases: list[str],
    lines: Lines,
    *,
    name: str,
    caption: str,
    labels: tuple[str, str],
    aspect: float = 0.0,
    shown_after: float = 20.0,
    columns: int = 2,
    panel_height: float = 0.27,
) -> Chart:
    """Return a panel for each vehicle that has flown every case, up to ``shown_after`` [s] after
    the last of them has settled.

    With an ``aspect``, width over height, they are maps.
    """
    found = {
        fidelity: {case: find_flight(run, f"{case}_{fidelity}") for case in cases}
        for fidelity in VEHICLES
    }
    pairs = {
        fidelity: {c: f for c, f in flights.items() if f is not None}
        for fidelity, flights in found.items()
    }
    pairs = {fidelity: flights for fidelity, flights in pairs.items() if len(flights) == len(cases)}
    settled = [
        float(f.row["settling_time_s"]) for flights in pairs.values() for f in flights.values()
    ]
    until = max((time for time in settled if not math.isnan(time)), default=math.inf) + shown_after
    drawn = {
        vehicle_name(run, key): lines({c: flown.until(until) for c, flown in flights.items()})
        for key, flights in pairs.items()
    }
    every = [line for curves in drawn.values() for line in curves]
    panels = [
        Panel(
            x_label=labels[0], y_label=labels[1], title=title[0].upper() + title[1:], lines=curves
        )
        for title, curves in drawn.items()
    ]
    if aspect:
        panels = [on_map(panel, north=0.0, shown=every, aspect=aspect) for panel in panels]
    elif drawn:
        x_range, y_range = _common_ranges(every)
        panels = [replace(panel, x_range=x_range, y_range=y_range) for panel in panels]
    return Chart(
        name=name, caption=caption, panels=panels, columns=columns, panel_height=panel_height
    )


def _common_ranges(lines: list[Line]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return ranges that hold every curve, so that panels side by side compare at a glance."""
    x, y = (
        np.concatenate(curves) for curves in zip(*((line.x, line.y) for line in lines), strict=True)
    )
    across, up = 0.02 * float(np.ptp(x)), 0.05 * float(np.ptp(y))
    return (float(np.min(x)) - across, float(np.max(x)) + across), (
        float(np.min(y)) - up,
        float(np.max(y)) + up,
    )


def _figure_3(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [_path(flown, "", "flown"), _reference(flown), _starts([flown])]


def _figure_4(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [
        Line(x=flown.time, y=flown.column("phi_rad"), label="φ", colour=Meaning.FLOWN),
        Line(x=flown.time, y=flown.column("phi_r_rad"), label="φ_r", colour=Meaning.ASKED),
        *_coincidence_marks(flown, flown.column("phi_r_rad")),
    ]


def _figure_5(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [
        Line(x=flown.time, y=flown.distance, label="distance d", colour=Meaning.FLOWN),
        *_coincidence_marks(flown, flown.distance),
    ]


def _coincidence_marks(flown: Flown, curve: Array) -> list[Line]:
    """Return marks on a curve over time where phi_r = phi: saddle points of the distance apart from
    its peaks and troughs.
    """
    times = coincidences(flown)
    saddle = np.abs(np.interp(times, flown.time, flown.column("phi_rad"))) < _PHI_GONE
    marks = (
        (saddle, "φ_r = φ = 0, a saddle point of d", "plum"),
        (~saddle, "φ_r = φ ≠ 0, a peak or trough of d", "black"),
    )
    return [
        Line(
            x=times[which],
            y=np.interp(times[which], flown.time, curve),
            label=label,
            colour=colour,
            style="diamonds",
        )
        for which, label, colour in marks
        if which.any()
    ]


_UAVS = {
    "sim2_los": ("UAV 1, line of sight", "plum"),
    "sim2_delta": ("UAV 2, δ formulation", Meaning.FLOWN),
}


def _figure_6(flights: dict[str, Flown]) -> list[Line]:
    first = next(iter(flights.values()))
    tracks = [_path(flown, "", *_UAVS[case]) for case, flown in flights.items()]
    return [*tracks, _reference(first), _starts(list(flights.values()))]


def _figure_7(flights: dict[str, Flown]) -> list[Line]:
    commands = [
        Line(
            x=flown.time,
            y=flown.column("heading_rate_demand_rad_s"),
            label=_UAVS[case][0],
            colour=_UAVS[case][1],
        )
        for case, flown in flights.items()
    ]
    first = next(iter(flights.values()))
    limit = float(first.row["heading_rate_limit_rad_s"])
    return [*commands, *(across(first.time[[0, -1]], value, "±ω_max") for value in (limit, -limit))]


def _distances(flights: dict[str, Flown]) -> list[Line]:
    return [
        Line(x=flown.time, y=flown.distance, label=_UAVS[case][0], colour=_UAVS[case][1])
        for case, flown in flights.items()
    ]


def _path(
    flown: Flown, prefix: str, label: str, colour: str = Meaning.FLOWN, style: Style = "solid"
) -> Line:
    """Return where the UAV, or what a prefix names, went over the ground."""
    return Line(
        x=flown.column(f"{prefix}east_m"),
        y=flown.column(f"{prefix}north_m"),
        label=label,
        colour=colour,
        style=style,
    )


def _reference(flown: Flown) -> Line:
    """Return the circle of the reference, to be drawn over the tracks that come to lie on it."""
    return _path(flown, "reference_", "reference", Meaning.ASKED, "dash")


def _starts(flights: list[Flown]) -> Line:
    places = [
        (float(flown.column(east)[0]), float(flown.column(north)[0]))
        for flown in flights
        for east, north in (("east_m", "north_m"), ("reference_east_m", "reference_north_m"))
    ]
    x, y = np.array(places).T
    return Line(x=x, y=y, label="start", colour=Meaning.SHIP, style="ring")


def _crossings(x: Array, y: Array) -> Line:
    return Line(x=x, y=y, label="plume crossing", colour=Meaning.CROSSING, style="diamonds")
