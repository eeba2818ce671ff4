"""Margins at every operating point of a design, between them, and with a perturbed aircraft."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import control

from aircraft.dynamics.equilibrium import Trim
from innerloop.analysis.margins import ALL_CONTROLS, Loops, Margin
from innerloop.analysis.perturbations import CASES, NOMINAL, Change, matrices, with_matrices
from innerloop.law.control_law import ControlLaw
from innerloop.law.linear_controller import linear_controller
from innerloop.synthesis.rate import loop_delay
from innerloop.synthesis.schedule import GAIN_BANKS, TRIM_BANKS, Schedule


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """Least margins.

    Attributes
    ----------
    gain_db, phase_deg : of the aircraft as modelled, each loop opened alone
    perturbed_gain_db, perturbed_phase_deg : of the perturbed aircraft
    """

    gain_db: float = 6.0
    phase_deg: float = 45.0
    perturbed_gain_db: float = 4.0
    perturbed_phase_deg: float = 30.0


REQUIRED = Requirement()
"""Nominal: MIL-F-9490D's 6 dB and 45 deg. A fifth of effectiveness is 1.6 to 1.9 dB, so 4 dB must remain."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """The margins of one operating point, with the aircraft as modelled or perturbed.

    Attributes
    ----------
    case : the perturbation
    airspeed, bank : [m/s, rad]
    between : whether the point lies between those of the design's grid
    stable : whether the closed loop is stable
    margins : of every loop
    """

    case: str
    airspeed: float
    bank: float
    between: bool
    stable: bool
    margins: tuple[Margin, ...]

    @property
    def required(self) -> tuple[float, float]:
        """Return the least gain [dB] and phase [deg]."""
        if self.case == NOMINAL:
            return REQUIRED.gain_db, REQUIRED.phase_deg
        return REQUIRED.perturbed_gain_db, REQUIRED.perturbed_phase_deg

    @property
    def short_loops(self) -> tuple[str, ...]:
        """Return the loops with too little margin; all of them if the closed loop is unstable."""
        gain, phase = self.required
        judged = [m for m in self.margins if m.loop != ALL_CONTROLS]
        return tuple(m.loop for m in judged if not (self.stable and m.gain_db >= gain and m.phase_deg >= phase))

    @property
    def met(self) -> bool:
        """Whether every margin is as required."""
        return self.stable and not self.short_loops

    @property
    def worst_gain(self) -> Margin:
        """Return the loop with the least gain margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.gain_db) else m.gain_db)

    @property
    def worst_phase(self) -> Margin:
        """Return the loop with the least phase margin."""
        return min(self.margins, key=lambda m: math.inf if math.isnan(m.phase_deg) else m.phase_deg)

    @property
    def shortfall(self) -> float:
        """Return the smallest margin as a fraction of the required one; below 0 if unstable."""
        gain, phase = self.required
        return min(self.worst_gain.gain_db / gain, self.worst_phase.phase_deg / phase) if self.stable else -1.0

    def describe(self) -> str:
        """Return the least margins in words."""
        where = f"at {self.airspeed:.1f} m/s and {math.degrees(self.bank):.0f} deg of bank, {self.case}"
        if not self.stable:
            return f"an unstable closed loop {where}"
        gain, phase = self.worst_gain, self.worst_phase
        return f"{gain.gain_db:.1f} dB ({gain.loop}) and {phase.phase_deg:.1f} deg ({phase.loop}) {where}"


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """Where margins are computed: an equilibrium, the aircraft about it, and whether it lies between those of the
    grid.

    ``bank`` is that of the grid [rad]: straight flight has 0, even if a small bank balances the propeller's torque.
    """

    trim: Trim
    bank: float
    model: control.StateSpace
    between: bool


def operating_points(schedule: Schedule) -> list[OperatingPoint]:
    """Return the points of the grid, and those in the middle between them along airspeed and along bank.

    Between, the linear model is interpolated, and so is the equilibrium: both are smooth there. Where two neighbours'
    measured lags are of different order there is nothing to interpolate, and the point is checked with either
    aircraft.
    """
    columns = [TRIM_BANKS.index(share) for share in GAIN_BANKS]
    at = {
        (i, j): OperatingPoint(trim=row[columns[j]], bank=schedule.gain_banks[j], model=schedule.models[i][j], between=False)
        for i, row in enumerate(schedule.trims)
        for j in range(len(columns))
    }
    points = list(at.values())
    for (i, j), point in at.items():
        for neighbour in ((i + 1, j), (i, j + 1)):
            if neighbour in at:
                points += _middle(point, at[neighbour])
    return points


def _middle(first: OperatingPoint, second: OperatingPoint) -> list[OperatingPoint]:
    def mean(a: float, b: float) -> float:
        return 0.5 * (a + b)

    p, q = first.trim, second.trim
    trim = Trim(
        **{name: mean(getattr(p, name), getattr(q, name)) for name in ("airspeed", "altitude", "climb_angle", "alpha", "beta")},
        roll=mean(p.roll, q.roll),
        pitch=mean(p.pitch, q.pitch),
        rates_body=(
            mean(p.rates_body[0], q.rates_body[0]),
            mean(p.rates_body[1], q.rates_body[1]),
            mean(p.rates_body[2], q.rates_body[2]),
        ),
        yaw_rate=mean(p.yaw_rate, q.yaw_rate),
        inputs={name: mean(value, q.inputs[name]) for name, value in p.inputs.items()},
        driven={},
        outcome=p.outcome,
        residuals=p.residuals,
        limits=(),
    )
    bank = mean(first.bank, second.bank)
    models = _between(first.model, second.model)
    return [OperatingPoint(trim=trim, bank=bank, model=model, between=True) for model in models]


def _between(first: control.StateSpace, second: control.StateSpace) -> list[control.StateSpace]:
    """Return the mean of two models, or both where their states differ."""
    if list(first.state_labels) != list(second.state_labels):
        return [first, second]
    a, b, c, d = (0.5 * (x + y) for x, y in zip(matrices(first), matrices(second), strict=True))
    return [with_matrices(first, a, b, c, d)]


ClosedLoops = Sequence[tuple[OperatingPoint, Loops]]
"""Operating points, and the loops that are closed there."""


def closed_loops(schedule: Schedule) -> ClosedLoops:
    """Return the loops at every operating point, as modelled.

    But for their delay they are those of every ``period`` of the schedule.
    """
    law = ControlLaw(schedule)
    return [(p, Loops(p.model, linear_controller(law, p.trim), schedule.delay)) for p in operating_points(schedule)]


def check_design(period: int, closed: ClosedLoops, *, changed: bool = True) -> list[Check]:
    """Return the margins at every operating point, as modelled and, if ``changed``, with the perturbed aircraft.

    Parameters
    ----------
    period : from one computation of the autopilot to the next, as in ``Schedule``
    closed : the loops of the schedule, as ``closed_loops`` returns them
    changed : whether the aircraft is perturbed, too
    """
    cases = CASES if changed else {NOMINAL: CASES[NOMINAL]}
    return [check for point, loops in closed for check in _checks(point, loops, period, cases)]


def _checks(point: OperatingPoint, as_modelled: Loops, period: int, cases: "dict[str, tuple[Change, int]]") -> Iterator[Check]:
    for case, (change, late) in cases.items():
        loops = as_modelled.with_aircraft(change(point.model, point.trim), loop_delay(period, late))
        yield Check(
            case=case,
            airspeed=point.trim.airspeed,
            bank=point.bank,
            between=point.between,
            stable=loops.stable,
            margins=tuple(loops.margins()),
        )


def with_all_controls(period: int, closed: ClosedLoops, checks: Sequence[Check]) -> list[Check]:
    """Return the checks of a design, to those of the grid's points as modelled added the disk margins at all controls at once.

    Nothing is required of those, and they take as long as all other margins.

    Parameters
    ----------
    period, closed : as for ``check_design``
    checks : as it returned them
    """
    of_grid = iter([(point, loops) for point, loops in closed if not point.between])

    def at_all_controls() -> Margin:
        point, loops = next(of_grid)
        return loops.with_aircraft(point.model, loop_delay(period)).margin_at_all_controls()

    return [
        replace(check, margins=(*check.margins, at_all_controls())) if check.case == NOMINAL and not check.between else check
        for check in checks
    ]
