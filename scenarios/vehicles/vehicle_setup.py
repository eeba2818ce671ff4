"""The vehicle's data that flights need in addition to their scenario: for an aircraft with its
autopilot, or for the kinematic vehicle.
"""

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aircraft.faults import fault_names
from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.spec import AircraftError, AircraftSpec, Envelope
from aircraft.trim import Trim, trim
from aircraft.user_check import check_user_aircraft
from common.files import write_tree
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.part_failure import PartFailure, measure_part_failure
from innerloop.flight.turn_reversal import TurnReversalResponse, reversal_record
from innerloop.flight.weave import Weave, measure_weaves
from innerloop.jsbsim.system import write_root
from innerloop.schedule import Schedule
from innerloop.store import Designed, designed
from scenarios.engine.run_directory import RunDirectory
from scenarios.errors import InputError
from scenarios.scenario.scenario import DEFAULT_AIRCRAFT, Scenario
from scenarios.vehicles.thrust_expectation import ThrustExpectation, thrust_expectation

KINEMATIC_BANDWIDTH = 1.0
"""Bandwidth of a kinematic vehicle's airspeed that its guidance reckons with; it follows at once
[rad/s].
"""

_SAME_BANK = 1e-3
"""By how much the guidance's bank may exceed that of the design before its reversal is measured
anew [rad].
"""

_SAME_AIRSPEED = 0.05
"""Difference of the airspeed flown from that of the design above which it is, too, over the latter
[-].
"""

_KINEMATIC_AIRSPEEDS = 0.7, 1.3
"""Airspeeds between which a kinematic vehicle is flown, over V_r [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Aircraft:
    """An aircraft in six degrees of freedom, and the JSBSim root of its autopilot.

    Attributes
    ----------
    spec, envelope : the aircraft, and where the autopilot may fly it
    start : equilibrium to start from
    model : JSBSim root
    """

    spec: AircraftSpec
    envelope: Envelope
    start: Trim
    model: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleSetup:
    """The vehicle's data that flights need.

    Attributes
    ----------
    lag : of the heading rate behind its command [s]
    reversal : how the heading rate follows a reversal of the turn
    response_error : distance by which a full reversal may come nearer than that response predicts
        [m]
    altitude_error : by which the altitude may differ from its command in a turn away [m]
    airspeed_bandwidth, airspeed_min, airspeed_max : of the airspeed behind its command, and its
        range [rad/s, m/s]
    airspeed_overshoot : of the airspeed over a step of its command [-]
    failing_level, failing_climbing : effect of a part's failure in a level turn, and in level and
        climbing turns; None if not measured
    thrust : expected thrust of the engine; None if no flight monitors it
    altitude_reach : largest altitude error that the autopilot certainly removes [m]
    turn_airspeeds, turn_rates : the slower turn at the autopilot's largest bank over airspeed;
        empty without a limit [m/s, rad/s]
    crab_banks, crab_offsets : banks in steady turns, and course through the air minus heading at
        each [rad]
    weaves : in still air, as sensors see them; none if not measured
    aircraft : in six degrees of freedom, or none for the kinematic vehicle
    meets_ships : whether ships other than the measured one may become known in flight
    """

    lag: float
    reversal: TurnReversalResponse
    response_error: float
    airspeed_bandwidth: float
    airspeed_min: float
    airspeed_max: float
    altitude_error: float = 0.0
    airspeed_overshoot: float = 0.0
    failing_level: PartFailure | None = None
    failing_climbing: PartFailure | None = None
    thrust: ThrustExpectation | None = None
    altitude_reach: float = math.inf
    turn_airspeeds: tuple[float, ...] = ()
    turn_rates: tuple[float, ...] = ()
    crab_banks: tuple[float, ...] = (-1.0, 1.0)
    crab_offsets: tuple[float, ...] = (0.0, 0.0)
    weaves: tuple[Weave, ...] = ()
    aircraft: Aircraft | None = None
    meets_ships: bool = False

    def turning_airspeed(self, heading_rate: float) -> float:
        """Return the airspeed up to which a heading rate [rad/s] can be flown at the autopilot's
        largest bank [m/s].
        """
        if not self.turn_airspeeds:
            return math.inf
        # At a given bank the time of a full turn is proportional to the airspeed, apart from the
        # effect of the angle of attack.
        return float(
            np.interp(
                1.0 / heading_rate, [1.0 / turn for turn in self.turn_rates], self.turn_airspeeds
            )
        )


def spec_of(scenario: Scenario) -> AircraftSpec | None:
    """Return a scenario's aircraft, or the one to which its kinematic flights are scaled; None if
    there is neither.

    Raises
    ------
    InputError : there is no such aircraft, or no autopilot can be designed for it, or JSBSim
        refuses the user's own
    """
    if scenario.fidelity == "kinematic" and scenario.aircraft == DEFAULT_AIRCRAFT:
        return None
    try:
        spec = find_spec(scenario.aircraft)
        check_user_aircraft(spec)
        return spec
    except AircraftError as error:
        raise InputError(f"aircraft: {error}") from None


def design_of(spec: AircraftSpec, altitude: float) -> tuple[Designed | None, str]:
    """Return the aircraft's autopilot at ``altitude`` [m], or nothing and the reason."""
    try:
        return designed(spec, altitude), ""
    except AircraftError as error:
        return None, str(error)


def kinematic_setup(scenario: Scenario) -> VehicleSetup:
    """Return the vehicle's data for kinematic flights of a scenario."""
    lag, speed = scenario.kinematic.heading_rate_lag_s, scenario.guidance.airspeed_mps
    slowest, fastest = _KINEMATIC_AIRSPEEDS
    return VehicleSetup(
        lag=lag,
        reversal=TurnReversalResponse(delay=0.0, lag=lag),
        response_error=0.0,
        airspeed_bandwidth=KINEMATIC_BANDWIDTH,
        airspeed_min=slowest * speed,
        airspeed_max=fastest * speed,
    )


def aircraft_setup(
    found: Designed,
    scenario: Scenario,
    run: RunDirectory,
    *,
    settings: Sequence[Scenario],
    bank: float = 0.0,
) -> VehicleSetup:
    """Return the data of the aircraft that flights need; write its autopilot into the run
    directory.

    Parameters
    ----------
    found : the aircraft's autopilot
    scenario : scenario with the airspeed and the height at the start
    run : the run directory
    settings : of all the flights; in some a part of the aircraft may be declared to fail
    bank : steepest bank that the guidance commands [rad]
    """
    schedule = found.design.schedule
    with tempfile.TemporaryDirectory() as folder:
        write_tree(write_root(schedule, Path(folder)), run.model)
    run.write_text(run.innerloop, found.record_text)
    start = trim(
        Fdm(schedule.spec),
        airspeed=scenario.guidance.airspeed_mps,
        altitude=scenario.altitude,
        start=schedule.level(schedule.middle),
    )
    turns = schedule.trims[schedule.middle]
    reversal, slow_lag = found.record["turn_reversal"], float(found.record["heading_rate_lag_s"])
    slower_or_faster = abs(start.airspeed / reversal["airspeed_mps"] - 1.0)
    if bank > schedule.envelope.bank + _SAME_BANK or slower_or_faster > _SAME_AIRSPEED:
        reversal = reversal_record(
            schedule.spec, run.model, start, max(bank, schedule.envelope.bank), slow_lag
        )
    parts = fault_names(schedule.spec)
    failing = [setting for setting in settings if setting.declared_faults.intersection(parts)]
    level = climbing = None
    if failing:
        failable = AutopilotedAircraft(schedule.spec, run.model, failable=True)
        gradient = max(setting.following.climb_gradient for setting in failing)
        turn, slowest = max(bank, schedule.envelope.bank), schedule.envelope.airspeed_min
        level = measure_part_failure(failable, start, turn, slowest, 0.0)
        climbing = measure_part_failure(failable, start, turn, slowest, gradient).or_worse(level)
    thrust: ThrustExpectation | None = None
    weaves: tuple[Weave, ...] = ()
    if any(setting.follows for setting in settings):
        sound = AutopilotedAircraft(schedule.spec, run.model)
        thrust = thrust_expectation(sound, schedule, start)
        weaves = measure_weaves(
            sound,
            start,
            max(bank, schedule.envelope.bank),
            schedule.envelope.airspeed_min,
            schedule.envelope.airspeed_max,
        )
    return VehicleSetup(
        lag=slow_lag,
        reversal=TurnReversalResponse(delay=reversal["delay_s"], lag=reversal["lag_s"]),
        response_error=reversal["deviation_max_m"],
        altitude_error=reversal["altitude_error_max_m"],
        airspeed_bandwidth=found.design.bandwidths.airspeed,
        airspeed_min=schedule.envelope.airspeed_min,
        airspeed_max=schedule.envelope.airspeed_max,
        airspeed_overshoot=next(
            response["overshoot"]
            for response in found.record["responses"]
            if (response["kind"], response["command"]) == ("flown", "airspeed")
        ),
        failing_level=level,
        failing_climbing=climbing,
        thrust=thrust,
        altitude_reach=schedule.weights.altitude_error_max,
        turn_airspeeds=tuple(schedule.airspeeds),
        turn_rates=_slower_turns(schedule),
        crab_banks=tuple(turn.roll for turn in turns),
        crab_offsets=tuple(turn.course_offset() for turn in turns),
        weaves=weaves,
        aircraft=Aircraft(
            spec=schedule.spec, envelope=schedule.envelope, start=start, model=run.model
        ),
    )


def _slower_turns(schedule: Schedule) -> tuple[float, ...]:
    """Return the heading rate of the slower of both turns at the autopilot's largest bank, at each
    airspeed [rad/s].
    """
    tangent = math.tan(schedule.envelope.bank_max)
    slower = []
    for row in schedule.trims:
        tangents, rates = np.tan([turn.roll for turn in row]), [turn.yaw_rate for turn in row]
        left, right = (float(np.interp(each, tangents, rates)) for each in (-tangent, tangent))
        slower.append(min(abs(left), abs(right)))
    return tuple(slower)
