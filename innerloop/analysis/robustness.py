"""Margins at every operating point of a design, between them, and with a perturbed aircraft."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from aircraft.dynamics.equilibrium import Trim
from aircraft.dynamics.linear_model import LinearModel
from innerloop.analysis.checks import NOMINAL, Check, Margin
from innerloop.analysis.margins import Loops
from innerloop.analysis.perturbations import CASES, Change
from innerloop.law.control_law import ControlLaw
from innerloop.law.linear_controller import linear_controller
from innerloop.synthesis.rate import loop_delay
from innerloop.synthesis.schedule import GAIN_BANKS, TRIM_BANKS, Schedule


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """Where margins are computed: an equilibrium, the aircraft about it, and whether it lies between those of the
    grid.

    ``bank`` is that of the grid [rad]: straight flight has 0, even if a small bank balances the propeller's torque.
    """

    trim: Trim
    bank: float
    model: LinearModel
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


def _between(first: LinearModel, second: LinearModel) -> list[LinearModel]:
    """Return the mean of two models, or both where their states differ."""
    if first.state_labels != second.state_labels:
        return [first, second]
    mean = {name: 0.5 * (getattr(first, name) + getattr(second, name)) for name in "ABCD"}
    return [replace(first, **mean)]


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
