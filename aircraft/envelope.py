"""The flight envelope: airspeeds between stall and the engines' limit, and the bank in turns."""

import math
from collections.abc import Sequence
from dataclasses import replace

from aircraft.fdm import Fdm
from aircraft.spec import BANK_RESERVE, AircraftError, AircraftSpec, Envelope
from aircraft.state import RigidBodyState, body_velocity
from aircraft.trim import Trim, TrimOutcome, search_trim, trim
from common.physics import KG_PER_SLUG, METRES_PER_FOOT, NEWTONS_PER_POUND

BANK_LIMITS = ((150.0, 45.0), (5_670.0, 30.0), (math.inf, 25.0))
"""Largest mass of each class of aircraft [kg], and its bank in turns [deg].

The classes are aircraft too small to carry people, light aeroplanes (up to 12,500 lb, the limit of
CS-23), and larger ones, which bank like airliners.
"""

TABLE_REACH = 1.1
"""Largest bank of the autopilot's tables, over its bank limit [-]: room for an overshoot."""

_STALL_RESERVE = 1.3
"""Least airspeed over the stall airspeed in the same turn [-]: CS-23's reference landing speed."""

_AIRSPEED_RATIO = 1.6
"""Largest airspeed over the least [-]: five design airspeeds cover a factor of 2.6 in pressure."""

_AIRSPEED_RATIO_MIN = 1.12
"""Smallest usable ratio of the largest to the least airspeed [-]: the guidance varies airspeed."""

_AIRSPEED_STEPS = 4
"""Steps from the least to the largest airspeed, of equal ratio, at which trims are tried."""

_MACH_MAX = 0.6
"""Largest Mach number [-]: gains scheduled over airspeed ignore compressibility."""

_SPEED_OF_SOUND = 340.3
_DENSITY = 1.225
"""Speed of sound [m/s] and density [kg/m^3] of the ISO standard atmosphere at sea level.

They are used at every altitude: at 5,000 m, the highest altitude of a design, the true Mach number
may exceed ``_MACH_MAX`` by 6 %.
"""

_BANK_FRACTIONS = (1.0, 0.75, 0.5)
"""Fractions of the bank of the aircraft's class that are tried, one after the other [-]."""

_THROTTLE_RANGE = (0.03, 0.95)
"""Range of an equilibrium's throttle that leaves a reserve to slow down and to climb [-]."""

_SURFACE_FRACTION = 0.9
"""Fraction of a surface's travel that an equilibrium may take [-]; the rest is reserve."""

_LIFT_STEP = math.radians(1.0)
_ALPHA_MAX = 0.4
"""Step and end of the search for the stall [rad]: wings without slots stall below 23 deg."""

_START_LIFT_COEFFICIENTS = (0.5, 0.35, 0.7, 0.25)
"""Lift coefficients of cruising aircraft, tried in turn for the first equilibrium [-]."""


def find_envelope(fdm: Fdm, altitude: float) -> Envelope:
    """The envelope in the aircraft's spec, or else an envelope found by trimming the aircraft.

    The least airspeed is 1.3 times the stall airspeed in the steepest turn of the autopilot's
    tables. The largest airspeed is 1.6 times the least, at most 204 m/s (Mach 0.6 at sea level),
    and leaves level flight and that turn 5 % of the throttle and 10 % of each surface. Where no
    range is left, the bank is reduced to three quarters, then to a half.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    altitude : [m]

    Raises
    ------
    AircraftError : no range of airspeeds is left; the message says why
    """
    if fdm.spec.envelope is not None:
        return fdm.spec.envelope
    first = first_trim(fdm, altitude)
    stall, notes = _stall_airspeed(fdm, first)
    bank = bank_by_class(fdm.read("inertia/mass-slugs") * KG_PER_SLUG)
    why_cut = ""
    for fraction in _BANK_FRACTIONS:
        airspeeds, why_ended = _flyable_airspeeds(fdm, first, stall, fraction * bank)
        if not airspeeds:
            why_cut = why_cut or why_ended
            continue
        if why_cut:
            notes = (*notes, f"bank cut from {math.degrees(bank):g} deg: {why_cut}")
        if why_ended:
            notes = (*notes, f"airspeeds limited: {why_ended}")
        return Envelope(
            airspeed_min=airspeeds[0],
            airspeed_max=airspeeds[-1],
            airspeed=0.5 * (airspeeds[0] + airspeeds[-1]),
            bank=fraction * bank,
            stall=stall,
            notes=notes,
        )
    raise AircraftError(f"aircraft '{fdm.spec.name}' cannot fly the study: {why_cut}")


def with_reserve_note(envelope: Envelope, trims: Sequence[Trim], spec: AircraftSpec) -> Envelope:
    """The stated envelope, with a note if some of its equilibria lack the usual control reserve."""
    lacking = [reason for t in trims if (reason := _lacking_reserve(t, spec))]
    if not lacking:
        return envelope
    note = (
        f"no control reserve at {len(lacking)} of {len(trims)} equilibria in the stated envelope:"
        f" {lacking[0]}. To gain one, raise airspeed_min, or lower airspeed_max or bank"
    )
    return replace(envelope, notes=(*envelope.notes, note))


def bank_by_class(mass: float) -> float:
    """Bank in turns [rad] for an aircraft's mass [kg]."""
    return math.radians(next(bank for largest, bank in BANK_LIMITS if mass <= largest))


def first_trim(fdm: Fdm, altitude: float) -> Trim:
    """Level flight at the airspeed of the spec's envelope, or else at a usual lift coefficient.

    Raises
    ------
    AircraftError : the model has no weight or no wing area, or does not trim
    """
    weight = fdm.read("inertia/weight-lbs") * NEWTONS_PER_POUND
    area = fdm.read("metrics/Sw-sqft") * METRES_PER_FOOT**2
    for what, value, unit, key in (
        ("weight", weight, "N", "emptywt"),
        ("wing area", area, "m²", "wingarea"),
    ):
        if not value > 0.0:
            raise AircraftError(
                f"aircraft '{fdm.spec.name}': its {what} is {value:g} {unit}; it must be above 0:"
                f" correct {key} in the model"
            )
    if fdm.spec.envelope is not None:
        return trim(fdm, airspeed=fdm.spec.envelope.airspeed, altitude=altitude)
    tried: list[Trim] = []
    for lift_coefficient in _START_LIFT_COEFFICIENTS:
        airspeed = math.sqrt(2.0 * weight / (_DENSITY * area * lift_coefficient))
        found = search_trim(fdm, airspeed=airspeed, altitude=altitude)
        if found.outcome is TrimOutcome.CONVERGED:
            return found
        tried.append(found)
    nearest = min(tried, key=lambda t: t.residual)
    raise AircraftError(f"aircraft '{fdm.spec.name}' does not trim: {_outcome(nearest)}")


def _outcome(t: Trim) -> str:
    """How a trim ended, in words."""
    turn = f" at {math.degrees(t.roll):.0f} deg of bank" if t.yaw_rate else ""
    limits = f", {' and '.join(t.limits)}" if t.limits else ""
    return f"{t.outcome.value} at {t.airspeed:.0f} m/s{turn}{limits}"


def _stall_airspeed(fdm: Fdm, first: Trim) -> tuple[float, tuple[str, ...]]:
    """Airspeed at which the largest lift equals the weight [m/s], and notes.

    The body is held still and pitched up until its lift decreases.
    """
    weight = fdm.read("inertia/weight-lbs")
    lift = fdm.node("forces/fwz-aero-lbs")
    largest, alpha = 0.0, first.alpha
    fdm.command(dict(first.inputs))
    with fdm.frozen():
        while alpha < _ALPHA_MAX:
            fdm.place(
                RigidBodyState(
                    altitude=first.altitude,
                    roll=0.0,
                    pitch=alpha,
                    velocity_body=body_velocity(first.airspeed, alpha, 0.0),
                )
            )
            fdm.step(2)
            now = abs(lift.get_double_value())
            if now < largest:
                break
            largest, alpha = now, alpha + _LIFT_STEP
    notes: tuple[str, ...] = ()
    if alpha >= _ALPHA_MAX:
        end = math.degrees(_ALPHA_MAX)
        notes = (f"lift still rises at {end:.0f} deg, taken for the stall",)
    return first.airspeed * math.sqrt(weight / largest), notes


def _flyable_airspeeds(fdm: Fdm, first: Trim, stall: float, bank: float) -> tuple[list[float], str]:
    """Airspeeds at which the aircraft has control reserve [m/s], and why the range ends.

    Level flight and the steepest turns both ways are tried. The airspeeds ascend; the list is empty
    if their range is too narrow.
    """
    steepest = TABLE_REACH * (bank + BANK_RESERVE)
    slowest = _STALL_RESERVE * stall / math.sqrt(math.cos(steepest))
    fastest = min(_AIRSPEED_RATIO * slowest, _MACH_MAX * _SPEED_OF_SOUND)
    flyable: list[float] = []
    why = ""
    for i in range(_AIRSPEED_STEPS + 1):
        airspeed = slowest * (fastest / slowest) ** (i / _AIRSPEED_STEPS)
        reason = _why_not_flyable(fdm, first, airspeed, steepest)
        if not reason:
            flyable.append(airspeed)
            continue
        why = reason
        if flyable:
            break
    if not flyable or flyable[-1] / flyable[0] < _AIRSPEED_RATIO_MIN:
        return [], why or "the stall and the largest Mach number leave no range of airspeeds"
    return flyable, why


def _why_not_flyable(fdm: Fdm, first: Trim, airspeed: float, bank: float) -> str:
    """Reserve that level flight or a turn lacks, in words; empty if nothing is lacking."""
    near = first
    for turn in (0.0, bank, -bank):
        found = search_trim(fdm, airspeed=airspeed, altitude=first.altitude, bank=turn, start=near)
        reason = _lacking_reserve(found, fdm.spec)
        if reason:
            return reason
        if turn == 0.0:
            near = found
    return ""


def _lacking_reserve(t: Trim, spec: AircraftSpec) -> str:
    """Reserve that an equilibrium lacks, in words; empty if nothing is lacking."""
    if t.outcome is not TrimOutcome.CONVERGED:
        return f"trim is {_outcome(t)}"
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
            f"{where} take {math.degrees(t.alpha):.1f} deg of angle of attack; the model is right"
            f" up to {math.degrees(spec.alpha_max):.1f} deg"
        )
    return ""
