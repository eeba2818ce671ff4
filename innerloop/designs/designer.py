"""From an aircraft to its autopilot: trim, linearise, weigh, design, check; slow loops down, or
refuse.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from aircraft.controls import flight_idle, with_flight_idle, with_linearised_controls
from aircraft.envelope import find_envelope, first_trim, with_reserve_note
from aircraft.fdm import Fdm
from aircraft.linearise import LinearModel, linearise
from aircraft.spec import AircraftSpec, Envelope
from aircraft.trim import Trim, trim
from innerloop.analysis.checks import ALL_CONTROLS, NOMINAL, Check
from innerloop.analysis.robustness import ClosedLoops, check_design, closed_loops, with_all_controls
from innerloop.designs.designed import Design, DesignError
from innerloop.synthesis.rate import PERIODS
from innerloop.synthesis.schedule import (
    GAIN_BANKS,
    LEVEL,
    LEVEL_GAINS,
    TRIM_BANKS,
    Schedule,
    table_banks,
)
from innerloop.synthesis.servo_lqr import design_gains
from innerloop.synthesis.weights import (
    LoopBandwidths,
    control_weights,
    design_weights,
    reachable_bandwidths,
)

_SLOWER = 0.8
"""Factor on the bandwidths of an axis with too little margin [-]."""

_ATTEMPTS = 10
"""Number of designs after which an aircraft is refused: the last is at 13 % of the first
bandwidths.
"""

_PHASE_LOSS_MAX = 5.0
"""Phase margin that any loop may lose because the autopilot does not compute at every time step
[deg].
"""

_NO_CROSSOVER = 180.0
"""Phase margin that a loop counts as having if its gain never crosses 1 [deg]."""

_LATERAL_LOOPS = ("aileron", "rudder", "heading_rate", "sideslip")
_AIRSPEED_LOOPS = ("throttle", "airspeed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Equilibria and linear models of an aircraft over airspeed and bank, from which designs start.

    Attributes
    ----------
    spec, envelope, altitude : the aircraft, its envelope, and the altitude [m]
    trims, models, edges : as in ``Schedule``
    """

    spec: AircraftSpec
    envelope: Envelope
    altitude: float
    trims: tuple[tuple[Trim, ...], ...]
    models: tuple[tuple[LinearModel, ...], ...]
    edges: tuple[tuple[LinearModel, LinearModel], ...]


def design_autopilot(spec: AircraftSpec, altitude: float = 100.0) -> Design:
    """Design the autopilot of an aircraft at ``altitude`` [m].

    Loops start as fast as the aircraft can follow and are slowed, one axis at a time, until every
    margin holds. The autopilot then computes as seldom as no margin prevents.

    Raises
    ------
    AircraftError : the aircraft cannot fly the study, or one of its design conditions
    DesignError : no design has the margins
    """
    grid = linear_grid(spec, altitude)
    bandwidths = reachable_bandwidths([row[LEVEL_GAINS] for row in grid.models], grid.envelope.bank)
    short: list[Check] = []
    for _ in range(_ATTEMPTS):
        schedule = schedule_at(grid, bandwidths)
        closed = closed_loops(schedule)
        period, checks = _checked(closed)
        short = [check for check in checks if not check.met]
        if not short:
            checks = with_all_controls(period, closed, checks)
            return Design(
                schedule=replace(schedule, period=period),
                bandwidths=bandwidths,
                checks=tuple(checks),
            )
        bandwidths = _slowed(bandwidths, short)
    worst = min(short, key=lambda check: check.shortfall)
    gain, phase = worst.required
    when = "" if worst.case == NOMINAL else " under every perturbation"
    raise DesignError(
        f"aircraft '{spec.name}': no design has {gain:g} dB and {phase:g} deg at every operating point{when};"
        f" the slowest tried has {worst.describe()}. It cannot be flown"
    )


def linear_grid(spec: AircraftSpec, altitude: float) -> Grid:
    """Trim and linearise an aircraft over its airspeeds and banks at ``altitude`` [m]."""
    fdm = Fdm(spec)
    spec = with_linearised_controls(fdm, first_trim(fdm, altitude))
    fdm = Fdm(spec)
    envelope = find_envelope(fdm, altitude)
    banks = table_banks(envelope, TRIM_BANKS)
    trims: list[tuple[Trim, ...]] = []
    models, edges = [], []
    # An aircraft of its own: what was flown last is in the last bits of the next equilibrium, and
    # so of gains and flights.
    beyond = Fdm(spec)
    near: Trim | None = None
    for airspeed in envelope.design_airspeeds:
        near = trim(fdm, airspeed=airspeed, altitude=altitude, start=near)
        row = tuple(
            near
            if bank == 0.0
            else trim(fdm, airspeed=airspeed, altitude=altitude, bank=bank, start=near)
            for bank in banks
        )
        trims.append(row)
        models.append(tuple(linearise(fdm, row[TRIM_BANKS.index(share)]) for share in GAIN_BANKS))
        edges.append((linearise(beyond, row[0]), linearise(beyond, row[-1])))
    if spec.envelope is not None:
        envelope = with_reserve_note(envelope, [t for row in trims for t in row], spec)
    spec = with_flight_idle(spec, flight_idle(fdm, trims[len(trims) // 2][LEVEL]))
    return Grid(
        spec=spec,
        envelope=envelope,
        altitude=altitude,
        trims=tuple(trims),
        models=tuple(models),
        edges=tuple(edges),
    )


def schedule_at(grid: Grid, bandwidths: LoopBandwidths) -> Schedule:
    """Return the autopilot whose loops have these bandwidths."""
    airspeeds = tuple(row[LEVEL].airspeed for row in grid.trims)
    weights = design_weights(bandwidths, airspeeds[len(airspeeds) // 2])
    gains = []
    for row, models in zip(grid.trims, grid.models, strict=True):
        controls = control_weights(models[LEVEL_GAINS], bandwidths, weights)
        at = [row[TRIM_BANKS.index(share)] for share in GAIN_BANKS]
        gains.append(
            tuple(
                design_gains(model, t, weights, controls)
                for model, t in zip(models, at, strict=True)
            )
        )
    return Schedule(
        spec=grid.spec,
        envelope=grid.envelope,
        weights=weights,
        altitude=grid.altitude,
        airspeeds=airspeeds,
        trims=grid.trims,
        models=grid.models,
        edges=grid.edges,
        gains=tuple(gains),
        period=PERIODS[0],
    )


def _checked(closed: ClosedLoops) -> tuple[int, list[Check]]:
    """Return the longest of ``PERIODS`` that margins allow, and the margins with it; those with the
    shortest if they allow none.

    They allow it if each is as required, perturbed or not, and no loop has lost more than
    ``_PHASE_LOSS_MAX``. Most designs have the longest: so perturbed aircraft, most of the work, are
    first checked with that.
    """
    often = check_design(PERIODS[0], closed, changed=False)
    if all(check.met for check in often):
        for period in reversed(PERIODS[1:]):
            if phase_loss(often, check_design(period, closed, changed=False)) <= _PHASE_LOSS_MAX:
                found = check_design(period, closed)
                if all(check.met for check in found):
                    return period, found
    return PERIODS[0], check_design(PERIODS[0], closed)


def phase_loss(before: Sequence[Check], after: Sequence[Check]) -> float:
    """Return the largest loss of a loop's phase margin from the checks of one design to those of
    another [deg].
    """
    return max(
        min(was.phase_deg, _NO_CROSSOVER) - min(now.phase_deg, _NO_CROSSOVER)
        for first, second in zip(before, after, strict=True)
        for was, now in zip(first.margins, second.margins, strict=True)
        if was.loop != ALL_CONTROLS
    )


def _slowed(bandwidths: LoopBandwidths, short: Sequence[Check]) -> LoopBandwidths:
    """Return bandwidths lower in the axes whose loops have too little margin."""
    loops = {name for check in short for name in check.short_loops}
    lateral = any(name in _LATERAL_LOOPS for name in loops)
    airspeed = any(name in _AIRSPEED_LOOPS for name in loops)
    longitudinal = bool(loops - set(_LATERAL_LOOPS) - set(_AIRSPEED_LOOPS)) or not (
        lateral or airspeed
    )
    return bandwidths.scaled(
        lateral=_SLOWER if lateral else 1.0,
        longitudinal=_SLOWER if longitudinal else 1.0,
        airspeed=_SLOWER if airspeed or longitudinal else 1.0,
    )
