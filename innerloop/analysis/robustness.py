"""Margins at every operating point of a design, between them, and with a perturbed aircraft."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from aircraft.linearise import LinearModel
from aircraft.trim import Trim
from innerloop.analysis.checks import NOMINAL, Check, Margin
from innerloop.analysis.margins import Loops
from innerloop.analysis.perturbations import CASES
from innerloop.law.control_law import ControlLaw
from innerloop.law.linear_controller import linear_controller
from innerloop.synthesis.rate import loop_delay
from innerloop.synthesis.schedule import GAIN_BANKS, TRIM_BANKS, Schedule


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """Where margins are computed: an equilibrium, the aircraft about it, and whether it lies
    between those of the grid.

    ``bank`` is that of the grid [rad]: straight flight has 0, even if a small bank balances the
    propeller's torque.
    """

    trim: Trim
    bank: float
    model: LinearModel
    between: bool


def operating_points(schedule: Schedule) -> list[OperatingPoint]:
    """Return the points of the grid, those in the middle between them along airspeed and along
    bank, and those at the largest bank.

    The largest bank that the autopilot commands lies beyond the gains', in the middle between the
    last of these and the end of the tables, to a tenth of a degree. Between, the linear model is
    interpolated, and so is the equilibrium: both are smooth there. Where two neighbours' measured
    lags are of different order there is nothing to interpolate, and the point is checked with
    either aircraft.
    """
    columns = [TRIM_BANKS.index(share) for share in GAIN_BANKS]
    at = {
        (i, j): OperatingPoint(
            trim=row[columns[j]],
            bank=schedule.gain_banks[j],
            model=schedule.models[i][j],
            between=False,
        )
        for i, row in enumerate(schedule.trims)
        for j in range(len(columns))
    }
    points = list(at.values())
    for (i, j), point in at.items():
        for neighbour in ((i + 1, j), (i, j + 1)):
            if neighbour in at:
                points += _middle(point, at[neighbour])
    last = len(columns) - 1
    for i, (row, edges) in enumerate(zip(schedule.trims, schedule.edges, strict=True)):
        for j, trim, bank, model in zip(
            (0, last),
            (row[0], row[-1]),
            (schedule.banks[0], schedule.banks[-1]),
            edges,
            strict=True,
        ):
            points += _middle(
                at[i, j], OperatingPoint(trim=trim, bank=bank, model=model, between=True)
            )
    return points


def _middle(first: OperatingPoint, second: OperatingPoint) -> list[OperatingPoint]:
    def mean(a: float, b: float) -> float:
        return 0.5 * (a + b)

    p, q = first.trim, second.trim
    trim = Trim(
        **{
            name: mean(getattr(p, name), getattr(q, name))
            for name in ("airspeed", "altitude", "climb_angle", "alpha", "beta")
        },
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


class ClosedPoint:
    """An operating point and the loops that are closed there: as modelled, and with every changed
    aircraft that was asked for.

    What an aircraft is changed to and how it responds are independent of the autopilot's period:
    each is computed once, and so is each check.
    """

    def __init__(self, point: OperatingPoint, as_modelled: Loops) -> None:
        self.point = point
        self._of = {NOMINAL: as_modelled}
        self._checks: dict[tuple[str, int], Check] = {}

    def loops(self, case: str, period: int) -> Loops:
        """Return the loops of one of ``CASES`` with the delay of a period, as in ``Schedule``."""
        change, late = CASES[case]
        if case not in self._of:
            as_modelled = self._of[NOMINAL]
            changed = change(self.point.model, self.point.trim)
            self._of[case] = (
                as_modelled if changed is self.point.model else as_modelled.with_aircraft(changed)
            )
        return self._of[case].with_delay(loop_delay(period, late))

    def check(self, case: str, period: int) -> Check:
        """Return the margins of one of ``CASES`` with a period, as in ``Schedule``."""
        if (case, period) not in self._checks:
            loops, point = self.loops(case, period), self.point
            self._checks[case, period] = Check(
                case=case,
                airspeed=point.trim.airspeed,
                bank=point.bank,
                between=point.between,
                stable=loops.stable,
                margins=tuple(loops.margins()),
            )
        return self._checks[case, period]


ClosedLoops = Sequence[ClosedPoint]
"""The operating points of a schedule."""


def closed_loops(schedule: Schedule) -> ClosedLoops:
    """Return the loops at every operating point, as modelled.

    But for their delay they are those of every ``period`` of the schedule.
    """
    law = ControlLaw(schedule)
    return [
        ClosedPoint(p, Loops(p.model, linear_controller(law, p.trim), schedule.delay))
        for p in operating_points(schedule)
    ]


def check_design(period: int, closed: ClosedLoops, *, changed: bool = True) -> list[Check]:
    """Return the margins at every operating point, as modelled and, if ``changed``, with the
    perturbed aircraft.

    Parameters
    ----------
    period : from one computation of the autopilot to the next, as in ``Schedule``
    closed : the loops of the schedule, as ``closed_loops`` returns them
    changed : whether the aircraft is perturbed, too
    """
    cases = tuple(CASES) if changed else (NOMINAL,)
    return [at.check(case, period) for at in closed for case in cases]


def with_all_controls(period: int, closed: ClosedLoops, checks: Sequence[Check]) -> list[Check]:
    """Return the checks of a design, to those of the grid's points as modelled added the disk
    margins at all controls at once.

    Nothing is required of those, and they take as long as all other margins.

    Parameters
    ----------
    period, closed : as for ``check_design``
    checks : as it returned them
    """
    of_grid = iter([at for at in closed if not at.point.between])

    def at_all_controls() -> Margin:
        return next(of_grid).loops(NOMINAL, period).margin_at_all_controls()

    return [
        replace(check, margins=(*check.margins, at_all_controls()))
        if check.case == NOMINAL and not check.between
        else check
        for check in checks
    ]
