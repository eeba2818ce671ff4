"""What flights in six degrees of freedom need of their aircraft beyond their scenario, and where it comes from."""

from dataclasses import dataclass

from aircraft.dynamics.equilibrium import Trim
from aircraft.errors import AircraftError
from aircraft.fleet.find import find_spec
from aircraft.spec import AircraftSpec, Envelope
from innerloop.designs.cache import Designed, designed
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.step_responses import level_trim
from innerloop.flight.turn_reversal import TurnReversalResponse, measure_turn_reversal
from innerloop.jsbsim.root import write_root
from scenarios.engine.run_directory import RunDirectory
from scenarios.errors import InputError
from scenarios.schema.config import Scenario
from scenarios.schema.sea_config import SeaScenario


@dataclass(frozen=True, slots=True, kw_only=True)
class SixDof:
    """What flights of the aircraft need beyond their scenario.

    Attributes
    ----------
    spec : the aircraft
    start : equilibrium to start from
    lag : of the autopilot's heading rate behind its command [s]
    reversal : how the heading rate follows a reversal of the turn
    envelope : where the autopilot may fly it
    """

    spec: AircraftSpec
    start: Trim
    lag: float
    reversal: TurnReversalResponse
    envelope: Envelope


def spec_flown(scenario: Scenario | SeaScenario) -> AircraftSpec | None:
    """Return the aircraft that flies a scenario, or that kinematic flights of it are fitted to; none where there is neither.

    Raises
    ------
    InputError : there is no such aircraft, or it is none for an autopilot
    """
    if scenario.fidelity == "kinematic" and scenario.aircraft == type(scenario).model_fields["aircraft"].default:
        return None
    try:
        return find_spec(scenario.aircraft)
    except AircraftError as error:
        raise InputError(f"aircraft: {error}") from None


def design_of(spec: AircraftSpec, altitude: float) -> tuple[Designed | None, str]:
    """Return the aircraft's autopilot at ``altitude`` [m], or nothing and why there is none."""
    try:
        return designed(spec, altitude), ""
    except AircraftError as error:
        return None, str(error)


def six_dof_of(found: Designed, *, airspeed: float, altitude: float, run: RunDirectory) -> SixDof:
    """Write the autopilot into the run directory, and return what flights that start at ``airspeed`` [m/s] need of the aircraft."""
    schedule = found.design.schedule
    write_root(schedule, run.model)
    run.write_json(run.innerloop, found.record)
    start = level_trim(schedule.spec, airspeed, altitude, schedule.level(schedule.middle))
    return SixDof(
        spec=schedule.spec,
        start=start,
        lag=float(found.record["heading_rate_lag_s"]),
        reversal=measure_turn_reversal(AutopilotedAircraft(schedule.spec, run.model), start, schedule.envelope.bank),
        envelope=schedule.envelope,
    )
