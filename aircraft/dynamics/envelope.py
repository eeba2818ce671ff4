"""The envelope of an aircraft: airspeeds between stall and the engines' limit, with a reserve for
banked turns.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from aircraft.dynamics.equilibrium import Trim, TrimOutcome
from aircraft.dynamics.trim import search_trim, trim
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.state import RigidBodyState, body_velocity
from aircraft.spec import BANK_RESERVE, AircraftSpec, Envelope
from common.physics.units import KG_PER_SLUG, METRES_PER_FOOT, NEWTONS_PER_POUND

BANK_LIMITS = ((150.0, 45.0), (5_670.0, 30.0), (math.inf, 25.0))
"""Largest mass [kg] of a class and the bank it turns with [deg]: aircraft too small to carry
people, light aeroplanes (up to 12,500 lb, where CS-23 drew the line), and larger ones, which bank
as airliners do."""

TABLE_REACH = 1.1
"""Largest bank of the autopilot's tables, over its bank limit [-]: an overshoot is then still
inside the tables.
"""

_STALL_RESERVE = 1.3
"""Least airspeed over stall in the same turn [-]: CS-23's reference landing speed, 1.3 times the
stall speed.
"""

_AIRSPEED_RATIO = 1.6
"""Largest airspeed over the least [-]: dynamic pressure then varies by 2.6, which tables at five
airspeeds follow.
"""

_AIRSPEED_RATIO_MIN = 1.12
"""Narrowest range of airspeeds, largest over least [-]: the guidance varies the airspeed within it.
"""

_AIRSPEED_STEPS = 4
"""Steps from the least to the largest airspeed, of equal ratio, at which trims are tried."""

_MACH_MAX = 0.6
"""Largest Mach number [-]: above it compressibility matters, which a schedule over airspeed alone
ignores.
"""

_SPEED_OF_SOUND = 340.3
_DENSITY = 1.225
"""Speed of sound [m/s] and density [kg/m^3] of the ISO standard atmosphere at sea level, taken at
every altitude: the true Mach number is up to 6 % above the largest at 5,000 m, the highest altitude
of a design."""

_BANK_FRACTIONS = (1.0, 0.75, 0.5)
"""Fractions of the bank of the aircraft's class that are tried, one after the other [-]."""

_THROTTLE_RANGE = (0.03, 0.95)
"""Throttles of an equilibrium that leave a reserve for control [-]; to slow down takes less than to
climb.
"""

_SURFACE_FRACTION = 0.9
"""Fraction of a surface's travel that an equilibrium may take [-], for the same reason."""

_LIFT_STEP = math.radians(1.0)
_ALPHA_MAX = 0.4
"""Step and end of the angles of attack at which the largest lift is sought [rad]; wings without
slots stall below 0.4 rad, 23 deg."""

_START_LIFT_COEFFICIENTS = (0.5, 0.35, 0.7, 0.25)
"""Lift coefficients at which a first equilibrium is sought, one after the other [-]: those of
cruising aircraft.
"""


def find_envelope(fdm: Fdm, altitude: float) -> Envelope:
    """Return the envelope that the aircraft's spec states, or one found by trimming the aircraft.

    The range found begins 1.3 times above stall in the steepest turn of the autopilot's tables, and
    ends where level flight or that turn takes more than 95 % of the throttle or 90 % of a surface,
    at 1.6 times its beginning or at 204 m/s, which is Mach 0.6 at sea level. Where that leaves no
    range, the bank is cut to three quarters and to a half.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    altitude : [m]

    Raises
    ------
    AircraftError : there is no such range, with the reason
    """
    if fdm.spec.envelope is not None:
        return fdm.spec.envelope
    level = first_trim(fdm, altitude)
    stall, notes = _stall_airspeed(fdm, level)
    bank = bank_by_class(fdm.read("inertia/mass-slugs") * KG_PER_SLUG)
    why = ""
    for fraction in _BANK_FRACTIONS:
        flown, ended = _airspeeds(fdm, level, stall, fraction * bank)
        if flown:
            if why:
                notes = (*notes, f"bank cut from {math.degrees(bank):g} deg: {why}")
            if ended:
                notes = (*notes, f"airspeeds limited: {ended}")
            return Envelope(
                airspeed_min=flown[0],
                airspeed_max=flown[-1],
                airspeed=0.5 * (flown[0] + flown[-1]),
                bank=fraction * bank,
                stall=stall,
                notes=notes,
            )
        why = why or ended
    raise AircraftError(f"aircraft '{fdm.spec.name}' cannot fly the study: {why}")


def with_reserve_note(envelope: Envelope, trims: Sequence[Trim], spec: AircraftSpec) -> Envelope:
    """Return an envelope with a note where equilibria in it lack the reserves that one that is
    found has.

    Parameters
    ----------
    envelope : as a spec states it
    trims : equilibria at its airspeeds and banks
    spec : the aircraft as it was trimmed
    """
    lacking = [reason for t in trims if (reason := _lacks(t, spec))]
    if not lacking:
        return envelope
    note = (
        f"a reserve is lacking at {len(lacking)} of {len(trims)} equilibria in the envelope as stated: {lacking[0]}."
        " Raise airspeed_min, or lower airspeed_max or bank, to have one"
    )
    return replace(envelope, notes=(*envelope.notes, note))


def bank_by_class(mass: float) -> float:
    """Return the bank of turns of aircraft of a mass [kg] [rad]."""
    return math.radians(next(bank for largest, bank in BANK_LIMITS if mass <= largest))


def first_trim(fdm: Fdm, altitude: float) -> Trim:
    """Return level flight at the airspeed of the spec's envelope, or at one with an ordinary lift
    coefficient.

    Raises
    ------
    AircraftError : the model has no weight or no wing area, or it does not trim
    """
    weight = fdm.read("inertia/weight-lbs") * NEWTONS_PER_POUND
    area = fdm.read("metrics/Sw-sqft") * METRES_PER_FOOT**2
    for what, value, unit, key in (
        ("weight", weight, "N", "emptywt"),
        ("wing area", area, "m²", "wingarea"),
    ):
        if not value > 0.0:
            raise AircraftError(
                f"aircraft '{fdm.spec.name}': its {what} is {value:g} {unit}; it must be above 0: correct {key} in the model"
            )
    if fdm.spec.envelope is not None:
        return trim(fdm, airspeed=fdm.spec.envelope.airspeed, altitude=altitude)
    found: list[Trim] = []
    for lift_coefficient in _START_LIFT_COEFFICIENTS:
        airspeed = math.sqrt(2.0 * weight / (_DENSITY * area * lift_coefficient))
        found.append(search_trim(fdm, airspeed=airspeed, altitude=altitude))
        if found[-1].outcome is TrimOutcome.CONVERGED:
            return found[-1]
    nearest = min(found, key=lambda t: t.residual)
    raise AircraftError(f"aircraft '{fdm.spec.name}' does not trim: {_why(nearest)}")


def _why(t: Trim) -> str:
    held = f", {' and '.join(t.limits)}" if t.limits else ""
    turn = f" at {math.degrees(t.roll):.0f} deg of bank" if t.yaw_rate else ""
    return f"{t.outcome.value} at {t.airspeed:.0f} m/s{turn}{held}"


def _stall_airspeed(fdm: Fdm, level: Trim) -> tuple[float, tuple[str, ...]]:
    """Return the airspeed at which the largest lift carries the weight [m/s], by pitching the held
    aircraft up; and notes."""
    weight = fdm.read("inertia/weight-lbs")
    lift = fdm.node("forces/fwz-aero-lbs")
    largest, alpha = 0.0, level.alpha
    fdm.command(dict(level.inputs))
    with fdm.frozen():
        while alpha < _ALPHA_MAX:
            fdm.place(
                RigidBodyState(
                    altitude=level.altitude,
                    roll=0.0,
                    pitch=alpha,
                    velocity_body=body_velocity(level.airspeed, alpha, 0.0),
                )
            )
            fdm.step(2)
            now = abs(lift.get_double_value())
            if now < largest:
                break
            largest, alpha = now, alpha + _LIFT_STEP
    notes = (
        ()
        if alpha < _ALPHA_MAX
        else (f"lift still rises at {math.degrees(_ALPHA_MAX):.0f} deg, taken for the stall",)
    )
    return level.airspeed * math.sqrt(weight / largest), notes


def _airspeeds(fdm: Fdm, level: Trim, stall: float, bank: float) -> tuple[list[float], str]:
    """Return the airspeeds, ascending, at which level flight and steepest turns trim with reserve;
    and why they end."""
    steepest = TABLE_REACH * (bank + BANK_RESERVE)
    slowest = _STALL_RESERVE * stall / math.sqrt(math.cos(steepest))
    fastest = min(_AIRSPEED_RATIO * slowest, _MACH_MAX * _SPEED_OF_SOUND)
    flown: list[float] = []
    why = ""
    for i in range(_AIRSPEED_STEPS + 1):
        airspeed = slowest * (fastest / slowest) ** (i / _AIRSPEED_STEPS)
        near = level
        for turn in (0.0, steepest, -steepest):
            found = search_trim(
                fdm, airspeed=airspeed, altitude=level.altitude, bank=turn, start=near
            )
            reason = _lacks(found, fdm.spec)
            if reason:
                why = reason
                break
            near = found if turn == 0.0 else near
        else:
            flown.append(airspeed)
            continue
        if flown:
            break
    if not flown or flown[-1] / flown[0] < _AIRSPEED_RATIO_MIN:
        return [], why or "stall and its largest Mach number leave no range of airspeeds"
    return flown, why


def _lacks(t: Trim, spec: AircraftSpec) -> str:
    """Return the reserve that an equilibrium lacks, in words; empty if it lacks none."""
    if t.outcome is not TrimOutcome.CONVERGED:
        return f"trim is {_why(t)}"
    where = f"{t.airspeed:.0f} m/s and {math.degrees(t.roll):.0f} deg of bank"
    for name, value in t.inputs.items():
        travel = spec.input(name)
        low, high = (
            _THROTTLE_RANGE
            if name == "throttle"
            else (_SURFACE_FRACTION * travel.lower, _SURFACE_FRACTION * travel.upper)
        )
        if not low <= value <= high:
            return f"{where} take {value:.2f} of {name}; {low:g} to {high:g} leaves a reserve"
    if t.alpha > spec.alpha_max:
        return (
            f"{where} take {math.degrees(t.alpha):.1f} deg of angle of attack; the model is right up to"
            f" {math.degrees(spec.alpha_max):.1f} deg"
        )
    return ""
