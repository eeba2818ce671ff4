"""From the record of a flight to its row in the summary."""

import math

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline

from aircraft.wind import CALM
from common.faults import fault_columns
from common.hull import HULL_SHAPES
from common.premises import UNEXPLAINED
from common.text import utc_text
from gnc.mission.mission import LEAVING, Mode
from gnc.mission.track import DirectParameters
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import FlightRecord
from scenarios.measures.crossings import Crossing, find_crossings
from scenarios.measures.keepout import (
    closest_approach,
    hull_distance,
    hull_keepout_figures,
    keepout_figures,
)
from scenarios.measures.premises import is_unexplained, premise_figures
from scenarios.measures.traffic import traffic_figures
from scenarios.planning.flight_plan import FlightPlan
from scenarios.world.ais.track import AisVessel
from scenarios.world.faults import Faults
from scenarios.world.vessel import Place

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

_BESIDE = 1e-6
"""Distance of a centre of oscillation from the plume's axis that is rounding [m]."""


def plan_row(plan: FlightPlan) -> Row:
    """Return the part of a row that is known once the flight is planned."""
    law = plan.guidance.tracking.law
    row: Row = {
        "heading_rate_limit_rad_s": plan.heading_rate_max,
        "heading_rate_bound_rad_s": plan.steering.bound
        if math.isfinite(plan.steering.bound)
        else math.nan,
        "epsilon_per_m": plan.steering.look_ahead.epsilon,
        "look_ahead_m": plan.steering.look_ahead.radius,
        "steering_max_rad_s": getattr(law, "steering_max_rad_s", plan.steering.steering_max),
    }
    if plan.oscillation is None or plan.world is None:
        return row
    world, start = plan.world, plan.start
    axis = world.plume.axis(0.0)
    wind, speed = plan.apparent_wind, plan.guidance.speed
    row |= {
        "nu": plan.nu,
        "nu_min": wind.least / speed if wind else plan.nu,
        "nu_max": wind.greatest / speed if wind else plan.nu,
        "plume_heading_deg": math.degrees(axis - world.vessel.course(0.0)) % 360.0,
        "plume_elevation_deg": math.degrees(world.elevation),
        "start_distance_m": math.hypot(start.north, start.east),
        "start_aspect_deg": math.degrees(
            math.remainder(math.atan2(start.east, start.north) - axis, 2.0 * math.pi)
        ),
        "eta": plan.oscillation.eta,
        "omega_0_rad_s": plan.oscillation.omega_0,
        "oscillation_limit": plan.oscillation.limit,
        "r_co_m": plan.centre_distance,
        "keepout_shape": plan.keepout_shape
        if plan.keepout_hull is None
        else HULL_SHAPES[plan.keepout_shape],
        "keepout_radius_m": plan.keepout_radius,
        **_hull_row(plan),
        "crossing_interval_predicted_s": plan.oscillation.crossing_interval,
        "manoeuvre_end_s": world.vessel.manoeuvres_end,
    }
    if isinstance(world.vessel, AisVessel):
        row["vessel_speed_mps"] = math.hypot(*world.vessel.motion(0.0)[2:])
    if not world.weather.wind.constant:
        north, east = world.weather.wind.now(0.0, world.source_height)
        row |= {
            "wind_speed_mps": math.hypot(north, east),
            "wind_from_deg": round(math.degrees(math.atan2(-east, -north)), 6) % 360.0,
        }
    row |= _fault_row(world.faults) | _place_row(world.place)
    if plan.margin is not None:
        row |= {
            "keepout_margin_m": plan.margin.total + plan.guarded_radius - plan.keepout_radius,
            "spread_predicted_m": plan.margin.tracking_sigma,
        }
    return row


def _hull_row(plan: FlightPlan) -> Row:
    """Return the figures of the hull, and the radius that the guard keeps because of it."""
    hull = plan.world.hull if plan.world else None
    if hull is None:
        return {}
    return {
        "hull_length_m": hull.length,
        "hull_beam_m": hull.beam,
        "stack_from_bow_m": hull.stack[0],
        "stack_from_port_m": hull.stack[1],
        "antenna_distance_m": hull.antenna_distance,
        "guarded_radius_m": plan.guarded_radius,
    }


def _fault_row(faults: Faults) -> Row:
    """Return kind and time of each fault, in the order of time."""
    row: Row = {}
    for number, fault in enumerate(faults.each, start=1):
        kind, begins = fault_columns(number)
        row[kind] = fault.kind
        row[begins] = fault.begins if math.isfinite(fault.begins) else math.nan
    return row


def _place_row(place: Place) -> Row:
    """Return place and time of the flight's start, as far as they are known."""
    row: Row = {}
    if math.isfinite(place.latitude):
        row |= {
            "place_latitude_deg": math.degrees(place.latitude),
            "place_longitude_deg": math.degrees(place.longitude),
        }
    if math.isfinite(place.utc):
        row["start_utc"] = utc_text(place.utc)
    return row


def flight_figures(plan: FlightPlan, record: FlightRecord) -> tuple[Row, list[Crossing]]:
    """Measure a flight.

    Keep-out, guard and limits count from the first second, and crossings from settling. Tracking,
    airspeed and altitude count from settling until the vehicle leaves for good. The time in which
    it gives way to other ships does not count, until it is back within the settling band. Intervals
    between crossings count until it first gives way.

    Returns
    -------
    row : the measured part of the flight's row
    crossings : of the settled flight
    """
    column = record.column
    time, altitude = column("time_s"), column("altitude_m")
    airspeed = column("airspeed_mps")
    to_reference = np.hypot(
        column("reference_north_m") - column("north_m"),
        column("reference_east_m") - column("east_m"),
    )
    row: Row = {
        "outcome": record.outcome.value,
        "message": record.message,
        "modes": ", ".join(_modes(record)),
        "mode_at_end": record.mode,
        "tracking_error_end_m": float(to_reference[-1]),
        "heading_rate_demand_max_rad_s": record.heading_rate_demand_max,
        "heading_rate_command_max_rad_s": record.heading_rate_command_max,
        "heading_rate_flown_max_rad_s": float(np.max(np.abs(column("heading_rate_rad_s")))),
        "speed_max_mps": float(
            np.max(np.hypot(column("velocity_north_mps"), column("velocity_east_mps")))
        ),
        "airspeed_min_mps": float(np.min(airspeed)),
        "airspeed_max_mps": float(np.max(airspeed)),
        "altitude_min_m": float(np.min(altitude)),
        "bank_max_deg": math.degrees(float(np.max(np.abs(column("roll_rad"))))),
        "saturation_fraction": record.saturation_fraction,
        "duration_s": float(time[-1]),
    }
    settled = time >= record.settled_at
    if np.count_nonzero(settled) < 2:
        settled = np.zeros_like(settled)
    yielded = _yielded(record, to_reference, plan.settling_band)
    leaves = np.isin(column("mode"), [mode.number for mode in LEAVING])
    beside = settled & ~leaves & ~yielded
    if beside.any():
        row |= _tracking_figures(plan, record, beside, to_reference[beside])
    row["settling_time_s"] = record.settled_at
    if plan.world is None:
        return row, []
    position, velocity = in_vessel_frame(record, plan.source_height)
    row |= _keepout_figures(plan, record, position, velocity) | premise_figures(plan, record)
    row |= traffic_figures(plan, record)
    row["keepout_violations"] += row.get("others_violations", 0)
    if is_unexplained(row):
        row |= {"outcome": Outcome.UNEXPLAINED_VIOLATION.value, "message": UNEXPLAINED}
    if not settled.any():
        return row, []
    if beside.any():
        row["spread_m"] = _spread(record, beside, position)
    row |= _estimation_figures(plan, record, settled)
    crossings = crossings_of(plan, record, settled, position, velocity)
    row |= _crossing_figures(plan, record, crossings, yielded)
    if crossings:
        nearest = _nearest_crossing(plan, time, position, velocity, crossings)
        row["crossing_clearance_min_m"] = nearest - plan.keepout_radius
    return row, crossings


def _yielded(record: FlightRecord, to_reference: Array, band: float) -> Mask:
    """Return the samples at which a flight gives way to other ships, or is on its way back
    afterwards.

    Parameters
    ----------
    record : of the flight
    to_reference : distance from the reference at each sample, shape (n,) [m]
    band : within which it is back [m]
    """
    yielding: Mask = record.column("mode") == Mode.YIELDING.number
    if not yielding.any():
        return yielding
    numbers = np.arange(len(yielding))
    last_yielding = np.maximum.accumulate(np.where(yielding, numbers, -1))
    last_back = np.maximum.accumulate(np.where(~yielding & (to_reference < band), numbers, -1))
    return last_yielding > last_back


def in_vessel_frame(record: FlightRecord, source_height: float) -> tuple[Array, Array]:
    """Return position and velocity from the plume's origin, each shape (n, 3): north, east, up
    [m, m/s].
    """
    column = record.column
    position = [column(f"{axis}_m") - column(f"vessel_{axis}_m") for axis in ("north", "east")]
    velocity = [
        column(f"velocity_{axis}_mps") - column(f"vessel_velocity_{axis}_mps")
        for axis in ("north", "east")
    ]
    return (
        np.column_stack([*position, column("altitude_m") - source_height]),
        np.column_stack([*velocity, column("climb_rate_mps")]),
    )


def _modes(record: FlightRecord) -> list[str]:
    """Return the modes that a flight went through, each once, in the order of their first time."""
    names = [mode.value for mode in Mode]
    return [names[int(number)] for number in dict.fromkeys(record.column("mode").tolist())]


def _tracking_figures(
    plan: FlightPlan, record: FlightRecord, beside: Mask, to_reference: Array
) -> Row:
    """Measure a settled flight until it leaves, with a vessel or without."""
    column = record.column
    airspeed_error = (column("airspeed_mps") - column("airspeed_command_mps"))[beside]
    altitude_error = (column("altitude_m") - column("altitude_command_m"))[beside]
    heading_rate_error = (column("heading_rate_rad_s") - column("reference_heading_rate_rad_s"))[
        beside
    ]
    return {
        "tracking_error_rms_m": rms(to_reference),
        "tracking_error_max_m": float(np.max(to_reference)),
        "airspeed_error_rms_mps": rms(airspeed_error),
        "airspeed_error_max_mps": float(np.max(np.abs(airspeed_error))),
        "airspeed_trim_rms_mps": rms(column("airspeed_command_mps")[beside] - plan.guidance.speed),
        "altitude_error_rms_m": rms(altitude_error),
        "altitude_error_max_m": float(np.max(np.abs(altitude_error))),
        "heading_rate_error_rms_rad_s": rms(heading_rate_error),
    }


def _keepout_figures(
    plan: FlightPlan, record: FlightRecord, position: Array, velocity: Array
) -> Row:
    """Measure the keep-out area and its guard over the whole flight."""
    time = record.column("time_s")
    hull = plan.keepout_hull
    if hull is None or plan.world is None:
        keepout = keepout_figures(time, position, velocity, plan.keepout_radius, plan.keepout_shape)
    else:
        keepout = hull_keepout_figures(
            time,
            position,
            velocity,
            plan.keepout_radius,
            plan.keepout_shape,
            hull,
            plan.world.headings,
        )
    row: Row = {
        "keepout_violations": keepout.violations,
        "keepout_time_s": keepout.time_inside,
        "keepout_depth_m": keepout.depth,
        "min_distance_m": keepout.distance_min,
        "horizontal_distance_min_m": closest_approach(time, position[:, :2], velocity[:, :2]),
        "end_distance_m": float(np.linalg.norm(position[-1])),
        "vessel_error_max_m": float(np.max(_vessel_error(record))),
    }
    if plan.guidance.guard is not None:
        sample = plan.log_interval * plan.time_step
        row |= {
            "guard_interventions": len(record.interventions),
            "guard_time_s": record.guard_time,
            "guard_lost_s": sample * float(np.count_nonzero(record.column("guard") > 1.0)),
        }
    return row


def _vessel_error(record: FlightRecord) -> Array:
    """Return the error of the guidance's estimate of the vessel's place [m]."""
    column = record.column
    return np.hypot(
        *(
            column(f"vessel_seen_{axis}_m") - column(f"vessel_{axis}_m")
            for axis in ("north", "east")
        )
    )


def _spread(record: FlightRecord, beside: Mask, position: Array) -> float:
    """Return the standard deviation of the tracking error towards the vessel, of a settled flight
    until it leaves [m].
    """
    north, east = position[beside, 0], position[beside, 1]
    to_north, to_east = (
        record.column(f"reference_{axis}_m")[beside] - record.column(f"{axis}_m")[beside]
        for axis in ("north", "east")
    )
    return float(np.std((to_north * north + to_east * east) / np.hypot(north, east)))


def _estimation_figures(plan: FlightPlan, record: FlightRecord, settled: Mask) -> Row:
    """Measure the errors of the guidance's estimates, and how often the guard acted, after
    settling.
    """

    def column(name: str) -> Array:
        return record.column(name)[settled]

    weather = plan.world.weather if plan.world else None
    row: Row = {
        "vessel_error_rms_m": rms(_vessel_error(record)[settled]),
        "centre_error_rms_m": rms(column("centre_error_m")),
        "guard_after_settling_s": plan.log_interval
        * plan.time_step
        * float(np.count_nonzero(column("guard") > 0.0)),
    }
    if weather is not None:
        north, east = weather.wind.at(column("time_s"), column("altitude_m"))
        row["wind_error_rms_mps"] = rms(
            np.hypot(column("wind_north_mps") - north, column("wind_east_mps") - east)
        )
    return row


def crossings_of(
    plan: FlightPlan, record: FlightRecord, settled: Mask, position: Array, velocity: Array
) -> list[Crossing]:
    """Find crossings of an axis that may turn, in the frame that turns with it."""
    time = record.column("time_s")[settled]
    axis = np.unwrap(record.column("plume_axis_rad")[settled])
    position, velocity = position[settled], velocity[settled]
    elevation = plan.world.elevation if plan.world else 0.0
    if axis[0] == axis[-1] and not np.any(axis - axis[0]):
        return find_crossings(
            time, position, velocity, (math.cos(axis[0]), math.sin(axis[0])), elevation
        )
    rate = np.gradient(axis, time)
    cos_a, sin_a = np.cos(axis), np.sin(axis)
    along = cos_a * position[:, 0] + sin_a * position[:, 1]
    across = cos_a * position[:, 1] - sin_a * position[:, 0]
    along_rate = cos_a * velocity[:, 0] + sin_a * velocity[:, 1] + rate * across
    across_rate = cos_a * velocity[:, 1] - sin_a * velocity[:, 0] - rate * along
    return find_crossings(
        time,
        np.column_stack([along, across, position[:, 2]]),
        np.column_stack([along_rate, across_rate, velocity[:, 2]]),
        (1.0, 0.0),
        elevation,
    )


def _nearest_crossing(
    plan: FlightPlan, time: Array, position: Array, velocity: Array, crossings: list[Crossing]
) -> float:
    """Return the least distance of a crossing from the point or the hull about which the keep-out
    area lies [m].
    """
    if plan.keepout_hull is None or plan.world is None:
        return min(
            crossing.horizontal_distance if plan.keepout_shape == "cylinder" else crossing.distance
            for crossing in crossings
        )
    moments = np.array([crossing.time for crossing in crossings])
    places = CubicHermiteSpline(time, position, velocity)(moments)
    headings = plan.world.headings(moments)
    return float(hull_distance(plan.keepout_hull, places, headings, plan.keepout_shape).min())


def _crossing_figures(
    plan: FlightPlan, record: FlightRecord, crossings: list[Crossing], yielded: Mask
) -> Row:
    """Measure the crossings of a settled flight; means are over whole periods of the orbit.

    Interval and distance may differ between the crossings of one period. If a flight has less than
    a period and the halves of the orbit differ, it has no mean interval; if the halves are equal,
    the error of its only interval is in proportion to the distance of the centre from the axis.
    """
    row: Row = {"crossing_count": len(crossings)}
    alike = _crossings_until_alike(plan, record)
    if crossings:
        whole = crossings[: len(crossings) // alike * alike] or crossings
        row |= {
            "crossing_distance_mean_m": float(np.mean([crossing.distance for crossing in whole])),
            "crossing_distance_min_m": min(crossing.distance for crossing in crossings),
            "crossing_angle_mean_deg": math.degrees(
                float(np.mean([crossing.angle for crossing in whole]))
            ),
        }
    last = (len(crossings) - 1) // alike * alike
    if not last and plan.oscillation is not None and plan.oscillation.symmetric:
        last = len(crossings) - 1
    if last > 0:
        times = np.array([crossing.time for crossing in crossings[: last + 1]])
        intervals = np.diff(times)
        if yielded.any():
            # The orbit closes in again after that, which takes some periods.
            left = record.column("time_s")[int(np.argmax(yielded))]
            whole_periods = (np.count_nonzero(times < left) - 1) // alike * alike
            intervals = intervals[: max(0, whole_periods)]
        if len(intervals):
            row |= {
                "crossing_interval_mean_s": float(np.mean(intervals)),
                "crossing_interval_std_s": float(np.std(intervals)),
            }
        wind = plan.apparent_wind
        if wind is not None and wind.greatest > wind.least:
            row["crossing_interval_predicted_s"] = _predicted_interval(
                plan, record, crossings[0].time, crossings[last].time
            )
    manoeuvres_end = plan.world.vessel.manoeuvres_end if plan.world else math.nan
    after = [crossing.time for crossing in crossings if crossing.time >= manoeuvres_end]
    if after:
        row["resume_time_s"] = after[0] - manoeuvres_end
        row["resume_periods"] = row["resume_time_s"] / plan.period(
            float(record.column("speed_ratio")[-1])
        )
    return row


def _crossings_until_alike(plan: FlightPlan, record: FlightRecord) -> int:
    """Return the number of crossings after which interval and distance repeat [-].

    They repeat after a period of the orbit, or after half a period if one half mirrors the other
    and the orbit's centre is on the plume's axis, so that each half has one crossing. A centre that
    follows estimates is beside the axis most of the time, and then the two intervals of a period
    differ.
    """
    orbit, mission = plan.oscillation, plan.guidance.mission
    if orbit is None:
        return 1
    a_period = max(1, round(orbit.period / orbit.crossing_interval))
    if a_period != 2 or not orbit.symmetric or not isinstance(mission, DirectParameters):
        return a_period
    axis = record.column("plume_axis_rad")
    beside = mission.centre.x * np.sin(axis) - mission.centre.y * np.cos(axis)
    return 1 if np.max(np.abs(beside)) < _BESIDE else a_period


def _predicted_interval(plan: FlightPlan, record: FlightRecord, first: float, last: float) -> float:
    """Return the mean crossing interval over a vessel's changes of course and speed, between two
    crossings [s].

    If the period changes with time, the rate of crossings is their number per period over the
    period, omega_0/pi for an oscillation. The number of crossings between two times is the integral
    of that rate.
    """
    time = np.linspace(first, last, max(2, math.ceil(last - first)))
    wind = (plan.world.weather.wind if plan.world else CALM).at(time, plan.source_height)
    through_air = [
        np.interp(time, record.column("time_s"), record.column(f"vessel_velocity_{axis}_mps"))
        - of_air
        for axis, of_air in zip(("north", "east"), wind, strict=True)
    ]
    ratio = np.hypot(*through_air) / plan.guidance.speed
    steps = np.linspace(0.0, plan.speed_ratio_max, len(plan.periods))
    per_period = (
        plan.oscillation.period / plan.oscillation.crossing_interval
        if plan.oscillation
        else math.nan
    )
    crossing_rate = per_period / np.interp(ratio, steps, plan.periods)
    return float((last - first) / np.trapezoid(crossing_rate, time))


def rms(values: npt.NDArray[np.float64]) -> float:
    """Return the root of the mean square of ``values``, in their unit; NaN if there are
    none.
    """
    return float(np.sqrt(np.mean(values**2)))
