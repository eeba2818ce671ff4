"""Design an aircraft's autopilot: trim, linearise, compute gains, check margins, slow loops."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from aircraft.controls import with_flight_idle, with_linearised_controls
from aircraft.envelope import find_envelope, first_trim, with_reserve_note
from aircraft.fdm import Fdm
from aircraft.linearise import LinearModel, linearise
from aircraft.spec import AircraftSpec, Envelope
from aircraft.trim import Trim, trim
from innerloop.margins import ALL_CONTROLS, NOMINAL, Check
from innerloop.robustness import (
    OperatingPointMargins,
    check_design,
    operating_point_margins,
    with_all_controls,
)
from innerloop.schedule import (
    GAIN_BANKS,
    LEVEL,
    LEVEL_GAINS,
    PERIODS,
    TRIM_BANKS,
    LoopBandwidths,
    Schedule,
    table_banks,
)
from innerloop.store import Design, DesignError
from innerloop.synthesis import control_weights, design_gains, design_weights, reachable_bandwidths

_SLOWER = 0.8
"""Factor that reduces the bandwidths of an axis with too little margin [-]."""

_ATTEMPTS = 10
"""Number of designs before an aircraft is refused: the last has 13 % of the first bandwidths."""

_PHASE_LOSS_MAX = 5.0
"""Phase margin that a loop may lose if the autopilot computes less often [deg]."""

_NO_CROSSOVER = 180.0
"""Phase margin that a loop counts with if its gain never crosses 1 [deg]."""

_LATERAL_LOOPS = ("aileron", "rudder", "heading_rate", "sideslip")
_AIRSPEED_LOOPS = ("throttle", "airspeed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Equilibria and linear models from which gains are designed; fields as in ``Schedule``."""

    spec: AircraftSpec
    envelope: Envelope
    altitude: float
    trims: tuple[tuple[Trim, ...], ...]
    models: tuple[tuple[LinearModel, ...], ...]
    edges: tuple[tuple[LinearModel, LinearModel], ...]


def design_autopilot(spec: AircraftSpec, altitude: float = 100.0) -> Design:
    """Return the autopilot of an aircraft at ``altitude`` [m] and its margins.

    The first design has the highest bandwidths that the aircraft can follow. Axes with too little
    margin are slowed until every margin is as required. The autopilot then gets the longest period
    that the margins allow.

    Raises
    ------
    AircraftError : the aircraft has no usable envelope, or no equilibrium in part of the envelope
    DesignError : no design has the required margins
    """
    grid = linear_grid(spec, altitude)
    bandwidths = reachable_bandwidths([row[LEVEL_GAINS] for row in grid.models], grid.envelope.bank)
    short: list[Check] = []
    for _ in range(_ATTEMPTS):
        schedule = schedule_at(grid, bandwidths)
        points = operating_point_margins(schedule)
        period, checks = _longest_period(points)
        short = [check for check in checks if not check.met]
        if not short:
            return Design(
                schedule=replace(schedule, period=period),
                bandwidths=bandwidths,
                checks=tuple(with_all_controls(period, points, checks)),
            )
        bandwidths = _slowed(bandwidths, short)
    worst = min(short, key=lambda check: check.shortfall)
    gain, phase = worst.required
    where = "at every operating point"
    if worst.case != NOMINAL:
        where += " under every perturbation"
    raise DesignError(
        f"aircraft '{spec.name}': no design has {gain:g} dB and {phase:g} deg {where};"
        f" the slowest tried has {worst.describe()}. It cannot be flown"
    )


def linear_grid(spec: AircraftSpec, altitude: float) -> Grid:
    """Return an aircraft's equilibria and linear models at ``altitude`` [m].

    Raises
    ------
    AircraftError : the aircraft has no usable envelope, or no equilibrium in part of the envelope
    """
    fdm = Fdm(spec)
    spec = with_linearised_controls(fdm, first_trim(fdm, altitude))
    fdm = Fdm(spec)
    envelope = find_envelope(fdm, altitude)
    banks = table_banks(envelope, TRIM_BANKS)
    trims: list[tuple[Trim, ...]] = []
    models, edges = [], []
    # A second simulation computes the edges. A simulation's last state influences the last bits of
    # its next equilibrium, and so the gains and flights.
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
    return Grid(
        spec=with_flight_idle(fdm, trims[len(trims) // 2][LEVEL]),
        envelope=envelope,
        altitude=altitude,
        trims=tuple(trims),
        models=tuple(models),
        edges=tuple(edges),
    )


def schedule_at(grid: Grid, bandwidths: LoopBandwidths) -> Schedule:
    """Return the autopilot's tables for given bandwidths, with a period of one time step."""
    airspeeds = tuple(row[LEVEL].airspeed for row in grid.trims)
    weights = design_weights(bandwidths, airspeeds[len(airspeeds) // 2])
    gains = []
    for row, models in zip(grid.trims, grid.models, strict=True):
        controls = control_weights(models[LEVEL_GAINS], bandwidths, weights)
        of_row = [
            design_gains(model, row[TRIM_BANKS.index(share)], weights, controls)
            for model, share in zip(models, GAIN_BANKS, strict=True)
        ]
        gains.append(tuple(of_row))
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


def _longest_period(points: Sequence[OperatingPointMargins]) -> tuple[int, list[Check]]:
    """Return the longest of ``PERIODS`` that the margins allow, and the margins with this period.

    A period is allowed if every margin is as required, also for the perturbed aircraft, and no loop
    loses more phase than ``_PHASE_LOSS_MAX``. If no period is allowed, the shortest is returned.
    The longest is tried first, because most designs allow it and perturbed aircraft take most of
    the computing time.
    """
    shortest = PERIODS[0]
    nominal = check_design(shortest, points, perturbed=False)
    if all(check.met for check in nominal):
        for period in reversed(PERIODS[1:]):
            slower = check_design(period, points, perturbed=False)
            if phase_loss(nominal, slower) <= _PHASE_LOSS_MAX:
                found = check_design(period, points)
                if all(check.met for check in found):
                    return period, found
    return shortest, check_design(shortest, points)


def phase_loss(before: Sequence[Check], after: Sequence[Check]) -> float:
    """Return the largest loss of phase margin of any loop between two checks of a design [deg]."""
    return max(
        min(was.phase_deg, _NO_CROSSOVER) - min(now.phase_deg, _NO_CROSSOVER)
        for first, second in zip(before, after, strict=True)
        for was, now in zip(first.margins, second.margins, strict=True)
        if was.loop != ALL_CONTROLS
    )


def _slowed(bandwidths: LoopBandwidths, short: Sequence[Check]) -> LoopBandwidths:
    """Return bandwidths that are reduced in the axes with too little margin."""
    loops = {name for check in short for name in check.short_loops}
    lateral = not loops.isdisjoint(_LATERAL_LOOPS)
    longitudinal = bool(loops.difference(_LATERAL_LOOPS, _AIRSPEED_LOOPS))
    airspeed = longitudinal or not loops.isdisjoint(_AIRSPEED_LOOPS)
    return LoopBandwidths(
        lateral=bandwidths.lateral * (_SLOWER if lateral else 1.0),
        longitudinal=bandwidths.longitudinal * (_SLOWER if longitudinal else 1.0),
        airspeed=bandwidths.airspeed * (_SLOWER if airspeed else 1.0),
    )
