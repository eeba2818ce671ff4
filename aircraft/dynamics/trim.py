"""Equilibrium flight, straight or turning, level or climbing.

JSBSim's own trim fails for small electric aircraft (its engine loop steps the propeller at 0.5 s),
so equilibrium is sought here on the accelerations themselves: the rigid body is held still, servos
and engines settle, and a solver drives the six accelerations to zero. Powell's hybrid method
(MINPACK) finds the equilibrium within a dozen evaluations where there is one; where it does not, a
bounded least-squares search gives the point of least acceleration, and the limits that it is at.
"""

import math

from aircraft.dynamics.equilibrium import Trim, TrimOutcome
from aircraft.dynamics.trim_search import TOLERANCE, TrimProblem
from aircraft.errors import TrimError
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec
from aircraft.spec_check import check_spec


def trim(
    fdm: Fdm,
    *,
    airspeed: float,
    altitude: float,
    bank: float = 0.0,
    climb_angle: float = 0.0,
    start: Trim | None = None,
) -> Trim:
    """Find the equilibrium at ``airspeed`` [m/s] and ``altitude`` [m].

    Parameters are those of ``search_trim``.

    Raises
    ------
    TrimError : the search does not converge, with its reason
    """
    found = search_trim(
        fdm, airspeed=airspeed, altitude=altitude, bank=bank, climb_angle=climb_angle, start=start
    )
    if found.outcome is TrimOutcome.CONVERGED:
        return found
    where = f"{airspeed:g} m/s, {altitude:g} m, bank {math.degrees(bank):g} deg, climb {math.degrees(climb_angle):g} deg"
    held, remedy = " and ".join(found.limits), _remedy(fdm.spec)
    if found.residual < TOLERANCE and held:
        raise TrimError(
            f"trim of '{fdm.spec.name}' at {where} did not converge: {held} is not enough; {remedy}"
        )
    raise TrimError(
        f"trim of '{fdm.spec.name}' at {where} did not converge: largest acceleration {found.residual:.2g}"
        f"{f' with {held}' if held else ''} against a limit of {TOLERANCE:g}; {remedy}"
    )


def _remedy(spec: AircraftSpec) -> str:
    """Return what to do where there is no equilibrium: an envelope that the user states may be what
    is wrong.
    """
    or_else = "" if spec.envelope is None else ", or state another one: its airspeeds and its bank"
    return f"choose a condition inside the flight envelope{or_else}; or correct the model"


def level_trim(
    spec: AircraftSpec, airspeed: float, altitude: float, start: Trim | None = None
) -> Trim:
    """Return the straight and level equilibrium of the bare aircraft at ``airspeed`` [m/s] and
    ``altitude`` [m].

    Parameters
    ----------
    spec, airspeed, altitude : the aircraft and its flight condition
    start : an equilibrium nearby
    """
    return trim(Fdm(spec), airspeed=airspeed, altitude=altitude, start=start)


def search_trim(
    fdm: Fdm,
    *,
    airspeed: float,
    altitude: float,
    bank: float = 0.0,
    climb_angle: float = 0.0,
    start: Trim | None = None,
) -> Trim:
    """Search for an equilibrium at ``airspeed`` [m/s] and ``altitude`` [m]; the outcome of the
    result says whether it is one.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    airspeed : true airspeed [m/s], positive
    altitude : [m]
    bank : 0 for straight flight (the small bank that balances the propeller's torque is then part
        of the solution), otherwise the bank angle of a steady turn [rad], whose yaw rate is part of
        the solution
    climb_angle : [rad]
    start : a known equilibrium nearby, from which the search begins

    Raises
    ------
    TrimError : an impossible condition, such as a negative airspeed
    AircraftError : the aircraft has other inputs than the autopilot flies with
    """
    if not (math.isfinite(airspeed) and airspeed > 0.0):
        raise TrimError(
            f"trim of '{fdm.spec.name}': airspeed is {airspeed} m/s; it must be finite and above 0"
        )
    for name, value, unit in (
        ("altitude", altitude, "m"),
        ("bank", bank, "rad"),
        ("climb angle", climb_angle, "rad"),
    ):
        if not math.isfinite(value):
            raise TrimError(
                f"trim of '{fdm.spec.name}': {name} is {value} {unit}; it must be finite"
            )
    if not abs(bank) < 0.5 * math.pi:
        raise TrimError(
            f"trim of '{fdm.spec.name}': bank is {math.degrees(bank):g} deg; it must lie within -90 and 90 deg"
        )
    check_spec(fdm.spec)
    problem = TrimProblem(
        fdm, airspeed=airspeed, altitude=altitude, bank=bank, climb_angle=climb_angle
    )
    tried: list[Trim] = []
    with fdm.frozen():
        for i, guess in enumerate(problem.guesses(start)):
            # Near a known equilibrium the engines are already as it needs them.
            found = problem.solve(guess, run_up=start is None or i > 0)
            if found.outcome is TrimOutcome.CONVERGED:
                return found
            tried.append(found)
        return problem.nearest(min(tried, key=lambda t: t.residual))
