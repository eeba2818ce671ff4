"""Margins of a design at and between its operating points, also with a perturbed aircraft."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from aircraft.linearise import BODY_STATES, LinearModel
from aircraft.model import PERTURBATIONS, Perturbation
from aircraft.trim import Trim
from common.physics import STANDARD_GRAVITY
from innerloop.law import ControlLaw, linear_controller
from innerloop.margins import NOMINAL, Check, Loops
from innerloop.schedule import GAIN_BANKS, TRIM_BANKS, Schedule, loop_delay

_AVERAGED = ("airspeed", "altitude", "climb_angle", "alpha", "beta", "roll", "pitch", "yaw_rate")
"""Fields of an equilibrium that are averaged for the point midway between two of them."""

_DIFFERENCE = 1e-5
"""Step of the differences of the rigid body's equations [SI]."""


class Case(NamedTuple):
    """A perturbation of the aircraft, and an additional delay of the autopilot [periods]."""

    by: Perturbation
    periods_late: int


CASES = {
    NOMINAL: Case(Perturbation(), 0),
    **{name: Case(by, 0) for name, by in PERTURBATIONS.items()},
    "one more period of delay": Case(Perturbation(), 1),
}
"""The cases in which margins are computed, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """A point of the flight envelope at which margins are computed.

    Attributes
    ----------
    trim : the equilibrium
    bank : bank of the grid [rad]; 0 in straight flight, even if a small bank balances the
        propeller's torque
    model : linear model of the aircraft about the equilibrium
    between : whether the point lies between points of the grid
    """

    trim: Trim
    bank: float
    model: LinearModel
    between: bool


class OperatingPointMargins:
    """Margins at one operating point, in every case and with every period of the autopilot.

    Results are cached. The perturbed aircraft's response does not depend on the period.
    """

    def __init__(self, point: OperatingPoint, as_modelled: Loops) -> None:
        self.point = point
        self._loops = {NOMINAL: as_modelled}
        self._checks: dict[tuple[str, int], Check] = {}

    def loops(self, case: str, period: int) -> Loops:
        """Return the loops in one of ``CASES``, with one of ``PERIODS``."""
        by, late = CASES[case]
        if case not in self._loops:
            as_modelled = self._loops[NOMINAL]
            changed = perturbed_model(self.point.model, self.point.trim, by)
            self._loops[case] = (
                as_modelled if changed is self.point.model else as_modelled.with_aircraft(changed)
            )
        return self._loops[case].with_delay(loop_delay(period, late))

    def check(self, case: str, period: int) -> Check:
        """Return the margins in one of ``CASES``, with one of ``PERIODS``."""
        if (case, period) not in self._checks:
            loops = self.loops(case, period)
            self._checks[case, period] = Check(
                case=case,
                airspeed=self.point.trim.airspeed,
                bank=self.point.bank,
                between=self.point.between,
                stable=loops.stable,
                margins=tuple(loops.margins()),
            )
        return self._checks[case, period]


def operating_point_margins(schedule: Schedule) -> list[OperatingPointMargins]:
    """Return the margins at every operating point of a schedule, for checks with any period."""
    law = ControlLaw(schedule)
    return [
        OperatingPointMargins(
            point, Loops(point.model, linear_controller(law, point.trim), schedule.delay)
        )
        for point in operating_points(schedule)
    ]


def check_design(
    period: int, points: Sequence[OperatingPointMargins], *, perturbed: bool = True
) -> list[Check]:
    """Return the margins at every operating point, as modelled or, if ``perturbed``, in all cases.

    ``period`` is one of ``PERIODS``; ``points`` come from ``operating_point_margins``.
    """
    cases = tuple(CASES) if perturbed else (NOMINAL,)
    return [point.check(case, period) for point in points for case in cases]


def with_all_controls(
    period: int, points: Sequence[OperatingPointMargins], checks: Sequence[Check]
) -> list[Check]:
    """Return the checks of ``check_design`` with disk margins at all controls at once added.

    They are added at the points of the grid. They have no required value, and they take as long to
    compute as all other margins.
    """
    found = []
    for point, check in zip((point for point in points for _ in CASES), checks, strict=True):
        if check.case == NOMINAL and not check.between:
            margin = point.loops(NOMINAL, period).margin_at_all_controls()
            found.append(replace(check, margins=(*check.margins, margin)))
        else:
            found.append(check)
    return found


def operating_points(schedule: Schedule) -> list[OperatingPoint]:
    """Return the points of the grid, the midway points of airspeed and bank, and the largest bank.

    A midway point has the mean of two equilibria and of two linear models. If the measured lags of
    two neighbours differ in order, their models have no mean, and the point is checked with both.
    The largest commanded bank lies midway between the last bank of the gains and the end of the
    tables, to a tenth of a degree.
    """
    columns = [TRIM_BANKS.index(share) for share in GAIN_BANKS]
    grid = {
        (i, j): OperatingPoint(
            trim=row[columns[j]],
            bank=schedule.gain_banks[j],
            model=schedule.models[i][j],
            between=False,
        )
        for i, row in enumerate(schedule.trims)
        for j in range(len(columns))
    }
    points = list(grid.values())
    for (i, j), point in grid.items():
        for neighbour in ((i + 1, j), (i, j + 1)):
            if neighbour in grid:
                points += _midway(point, grid[neighbour])
    last = len(columns) - 1
    for i, (row, edges) in enumerate(zip(schedule.trims, schedule.edges, strict=True)):
        for j, end in ((0, 0), (last, -1)):
            edge = OperatingPoint(
                trim=row[end], bank=schedule.banks[end], model=edges[end], between=True
            )
            points += _midway(grid[i, j], edge)
    return points


def _midway(first: OperatingPoint, second: OperatingPoint) -> list[OperatingPoint]:
    def means(one: object, other: object, names: Sequence[str]) -> dict[str, Any]:
        return {name: 0.5 * (getattr(one, name) + getattr(other, name)) for name in names}

    p, q = first.trim, second.trim
    roll_rate, pitch_rate, yaw_rate = (
        0.5 * (a + b) for a, b in zip(p.rates_body, q.rates_body, strict=True)
    )
    trim = replace(
        p,
        **means(p, q, _AVERAGED),
        rates_body=(roll_rate, pitch_rate, yaw_rate),
        inputs={name: 0.5 * (value + q.inputs[name]) for name, value in p.inputs.items()},
        driven={},
        limits=(),
    )
    models = [first.model, second.model]
    if first.model.state_labels == second.model.state_labels:
        models = [replace(first.model, **means(first.model, second.model, "ABCD"))]
    bank = 0.5 * (first.bank + second.bank)
    return [OperatingPoint(trim=trim, bank=bank, model=model, between=True) for model in models]


def perturbed_model(model: LinearModel, trim: Trim, by: Perturbation) -> LinearModel:
    """Return the linear model of a perturbed aircraft, or ``model`` itself without perturbation."""
    if by.effectiveness != 1.0:
        model = _with_effectiveness(model, by.effectiveness)
    if by.mass != 1.0:
        model = _with_mass(model, trim, by.mass)
    if by.inertia != 1.0:
        model = _with_inertia(model, by.inertia)
    return model


def _with_effectiveness(model: LinearModel, factor: float) -> LinearModel:
    """Return the model with the effectiveness of every control, also the throttle's, scaled.

    The perturbed aircraft that fly reversals (``aircraft.model``) have scaled surfaces only. With
    less effectiveness the throttle's loop has less margin there than here, where its gain is lower
    as well.
    """
    rows = [i for i, name in enumerate(model.state_labels) if name in BODY_STATES]
    driven = [i for i, name in enumerate(model.state_labels) if name not in BODY_STATES]
    extras = [i for i, name in enumerate(model.output_labels) if name not in model.state_labels]
    a, b, c = model.A.copy(), model.B.copy(), model.C.copy()
    b[rows] *= factor
    a[np.ix_(rows, driven)] *= factor
    c[np.ix_(extras, driven)] *= factor
    return replace(model, A=a, B=b, C=c, D=model.D * factor)


def _with_mass(model: LinearModel, trim: Trim, factor: float) -> LinearModel:
    """Return the model with mass multiplied by a factor.

    The factor divides accelerations from air and engine, but not those from gravity and rotation.
    """
    a, b, c, d = (m.copy() for m in (model.A, model.B, model.C, model.D))
    rows = [model.state_labels.index(name) for name in ("airspeed", "alpha", "beta")]
    kinematic = gravity_and_turning(trim, model.state_labels)
    a[rows] = kinematic + (a[rows] - kinematic) / factor
    b[rows] /= factor
    # The rate of the course is side force over mass and speed. The attitude's part stays: an
    # aircraft in equilibrium carries its weight at any mass, so bank turns it by g/V as before.
    row = model.output_labels.index("heading_rate")
    columns = [i for i, name in enumerate(model.state_labels) if name not in ("roll", "pitch")]
    c[row, columns] /= factor
    d[row] /= factor
    return replace(model, A=a, B=b, C=c, D=d)


def _with_inertia(model: LinearModel, factor: float) -> LinearModel:
    """Return the model with all moments of inertia multiplied by a factor.

    The factor divides angular accelerations.
    """
    a, b = model.A.copy(), model.B.copy()
    rows = [model.state_labels.index(name) for name in "pqr"]
    a[rows] /= factor
    b[rows] /= factor
    return replace(model, A=a, B=b)


def gravity_and_turning(trim: Trim, states: Sequence[str]) -> npt.NDArray[np.float64]:
    """Return the part of A for airspeed, alpha and beta from gravity and rotation, (3, states).

    It is computed by differences of the rigid body's equations without air and engine.
    """
    names = ("airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch")
    point = np.array(
        [trim.airspeed, trim.alpha, trim.beta, *trim.rates_body, trim.roll, trim.pitch]
    )

    def rates(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        v, alpha, beta, p, q, r, roll, pitch = x
        along = math.cos(alpha) * math.cos(beta)
        side = math.sin(beta)
        down = math.sin(alpha) * math.cos(beta)
        u = v * along
        w = v * down
        g = STANDARD_GRAVITY
        u_dot = -g * math.sin(pitch) - (q * w - r * v * side)
        side_dot = g * math.sin(roll) * math.cos(pitch) - (r * u - p * w)
        w_dot = g * math.cos(roll) * math.cos(pitch) - (p * v * side - q * u)
        v_dot = along * u_dot + side * side_dot + down * w_dot
        alpha_dot = (u * w_dot - w * u_dot) / (u * u + w * w)
        beta_dot = (side_dot - v_dot * side) / (v * math.cos(beta))
        return np.array([v_dot, alpha_dot, beta_dot])

    result = np.zeros((3, len(states)))
    for i, name in enumerate(names):
        step = np.zeros(len(names))
        step[i] = _DIFFERENCE
        result[:, states.index(name)] = (rates(point + step) - rates(point - step)) / (
            2.0 * _DIFFERENCE
        )
    return result
