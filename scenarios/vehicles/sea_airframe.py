"""What flights over a real sea need of what flies them, and designing it."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from innerloop.designs.cache import Designed
from innerloop.flight.turn_reversal import TurnReversalResponse
from innerloop.synthesis.schedule import Schedule
from scenarios.engine.run_directory import RunDirectory
from scenarios.planning.limits import omega_max
from scenarios.schema.sea_config import SeaScenario
from scenarios.vehicles.six_dof import SixDof, design_of, six_dof_of, spec_flown

KINEMATIC_BANDWIDTH = 1.0
"""Bandwidth of a kinematic vehicle's airspeed that its guidance reckons with; it follows at once [rad/s]."""

KINEMATIC_LAG = 0.4
"""Lag of a kinematic vehicle's heading rate over the real sea, where it stands for an aircraft [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Airframe:
    """What flights need of what flies them.

    Attributes
    ----------
    lag : of the heading rate behind the guidance [s]
    airspeed_bandwidth, airspeed_min, airspeed_max : of the airspeed behind its command, and its range [rad/s, m/s]
    turning_airspeed : up to which omega_max can be flown at the autopilot's largest bank [m/s]
    reversal : how the heading rate follows a reversal of the turn
    crab_banks, crab_offsets : banks in steady turns, and course through the air minus heading at each [rad]
    six_dof, model : the aircraft and the JSBSim root of its autopilot; neither for a kinematic vehicle
    """

    lag: float
    airspeed_bandwidth: float
    airspeed_min: float
    airspeed_max: float
    turning_airspeed: float
    reversal: TurnReversalResponse
    crab_banks: tuple[float, ...]
    crab_offsets: tuple[float, ...]
    six_dof: SixDof | None
    model: Path | None


def design_for(scenario: SeaScenario) -> tuple[Designed | None, str]:
    """Return the autopilot of the aircraft that flies, or of the one that kinematic flights are fitted to, or why there is none.

    Raises
    ------
    InputError : there is no such aircraft
    """
    spec = spec_flown(scenario)
    return design_of(spec, scenario.plume.source_height_m) if spec else (None, "")


def airframe_for(scenario: SeaScenario, directory: Path) -> Airframe:
    """Return what flights of one scenario need of its aircraft, with its autopilot written into a run directory.

    Raises
    ------
    InputError : there is no such aircraft
    """
    return airframe_of(scenario, design_for(scenario)[0], RunDirectory(directory))


def airframe_of(scenario: SeaScenario, found: Designed | None, run: RunDirectory) -> Airframe:
    """Return what flights need of the aircraft; write its autopilot into the run directory."""
    half_step = 0.5 / scenario.guidance.rate_hz
    if found is None or scenario.fidelity == "kinematic":
        reversal = TurnReversalResponse(delay=0.0, lag=KINEMATIC_LAG)
        return Airframe(
            lag=KINEMATIC_LAG + half_step,
            airspeed_bandwidth=KINEMATIC_BANDWIDTH,
            airspeed_min=0.7 * scenario.guidance.airspeed_mps,
            airspeed_max=1.3 * scenario.guidance.airspeed_mps,
            turning_airspeed=math.inf,
            reversal=reversal,
            crab_banks=(-1.0, 1.0),
            crab_offsets=(0.0, 0.0),
            six_dof=None,
            model=None,
        )
    schedule = found.design.schedule
    turns = schedule.trims[schedule.middle]
    six_dof = six_dof_of(found, airspeed=scenario.guidance.airspeed_mps, altitude=scenario.plume.source_height_m, run=run)
    return Airframe(
        lag=six_dof.lag + half_step,
        airspeed_bandwidth=found.design.bandwidths.airspeed,
        airspeed_min=schedule.envelope.airspeed_min,
        airspeed_max=schedule.envelope.airspeed_max,
        turning_airspeed=_turning_airspeed(schedule, omega_max(scenario.guidance)),
        reversal=six_dof.reversal,
        crab_banks=tuple(turn.roll for turn in turns),
        crab_offsets=tuple(turn.course_offset() for turn in turns),
        six_dof=six_dof,
        model=run.model,
    )


def _turning_airspeed(schedule: Schedule, heading_rate: float) -> float:
    """Return the airspeed at which the slower of both turns at the autopilot's largest bank has a heading rate [m/s]."""
    bank = schedule.envelope.bank_max
    turns = [
        min(abs(float(np.interp(side * bank, [t.roll for t in row], [t.yaw_rate for t in row]))) for side in (-1.0, 1.0))
        for row in schedule.trims
    ]
    # Turns are slower the faster it flies.
    return float(np.interp(-heading_rate, [-turn for turn in turns], schedule.airspeeds))
