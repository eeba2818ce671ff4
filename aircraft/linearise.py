"""Linear model about an equilibrium, by central differences on JSBSim itself.

JSBSim's own linearisation bypasses servo lags and leaves the simulation unusable. Here the rigid
body is held still (``Fdm.frozen``), one quantity at a time is moved both ways, and the
accelerations are read once everything else has settled. A servo or propeller cannot be set
directly: its input is held off trim, and its pole follows from the return to trim. A second reading
after one step separates the direct effect of an input, such as a motor's torque on the airframe,
from the effect of the moved servo or propeller.

For an input without a driven state in the spec, as in stock aircraft, the lag is measured from a
step response. The area and the first moment in time of the remaining change give the coefficients
of a lag of first or second order, such as a piston engine's manifold pressure followed by its
speed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.spec import AircraftError, ControlInput
from aircraft.state import body_velocity, course_rate, euler_rates, level
from aircraft.trim import Trim

Matrix = npt.NDArray[np.float64]

BODY_STATES = ("airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch", "altitude")
"""Rigid-body states [m/s, rad, rad, rad/s, rad/s, rad/s, rad, rad, m].

Position and yaw do not influence them.
"""

EXTRA_OUTPUTS = ("heading_rate", "climb_rate")
"""Outputs besides the states: rate of the air-relative course [rad/s], and climb rate [m/s]."""

_AIRSPEED_STEP = 0.0025
_ALTITUDE_STEP = 5.0
_STEP = 0.002
_INPUT_STEP = 0.01
"""Steps of relative airspeed [-], altitude [m], angles and rates [rad, rad/s], and inputs [-].

Their effects are large against the error of settling, ``_SETTLED``, and the steps are small against
the curvature of a model's tables.
"""

_LAG_STEP = {"throttle": 0.05}
"""Larger input steps for lags [-]: a turbine spools at a constant rate and hides a small step."""

_SETTLED = 3e-8
"""Change of acceleration in a step below which engines count as settled [m/s^2, rad/s^2].

With an engine lag of one second, an error of 4e-6 remains in differences of at least 5e-3.
"""

_LAG_STEPS_MAX = 2400
"""Largest number of time steps in which a lag is measured: 20 s."""

_LAG_SETTLED = 0.002
"""Remaining fraction of the effect at which the measurement of a lag ends [-]."""

_SECOND_ORDER = 0.05
"""Least product of two time constants over their squared sum in a second-order lag [-]."""

_AT_ONCE = 1e-6
"""Least remaining fraction of a driven state's change one step after its input moved [-].

A smaller remainder is rounding: the quantity follows its input at once and is not a state.
"""

_NO_LAG = 0.6
"""Time constant below which there is no lag, in time steps [-]: holding an input takes half."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearModel:
    """A linear system x' = A x + B u, y = C x + D u, with python-control's attribute names.

    The class needs numpy alone, so a flight with a stored design does not import python-control.

    Attributes
    ----------
    A, B, C, D : shapes (n, n), (n, m), (p, n) and (p, m)
    state_labels, input_labels, output_labels : names of the n states, m inputs and p outputs
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    state_labels: tuple[str, ...]
    input_labels: tuple[str, ...]
    output_labels: tuple[str, ...]

    def poles(self) -> npt.NDArray[np.complex128]:
        """Eigenvalues of A [1/s]."""
        return np.linalg.eigvals(self.A).astype(np.complex128)

    def pick(
        self, states: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]
    ) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """A, B, C and D for the named states, inputs and outputs, with all others at 0."""
        rows = [self.state_labels.index(name) for name in states]
        columns = [self.input_labels.index(name) for name in inputs]
        reads = [self.output_labels.index(name) for name in outputs]
        return (
            self.A[np.ix_(rows, rows)],
            self.B[np.ix_(rows, columns)],
            self.C[np.ix_(reads, rows)],
            self.D[np.ix_(reads, columns)],
        )


def linearise(fdm: Fdm, trim: Trim) -> LinearModel:
    """Linear model about ``trim``, with named states, inputs and outputs.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    trim : the equilibrium, straight or turning

    Returns
    -------
    LinearModel
        States: ``BODY_STATES``, then the aircraft's driven states, then ``INPUT_effect`` for each
        measured lag, with ``INPUT_effect_rate`` if it is of second order. Inputs: the aircraft's
        control inputs [-]. Outputs: every state, then ``EXTRA_OUTPUTS``. All are deviations from
        trim, in SI and radians.

    Raises
    ------
    AircraftError : a driven state does not follow its input, or follows it without delay
    """
    with fdm.frozen():
        differences = _Differences(fdm, trim)
        model = differences.with_driven_states()
        states = [*BODY_STATES, *(s.name for s in fdm.spec.driven_states)]
        driving = [s.input for s in fdm.spec.driven_states]
        for j, control_input in enumerate(fdm.spec.inputs):
            if control_input.name in driving:
                continue
            lag = differences.measured_lag(control_input)
            if lag.total <= _NO_LAG * fdm.time_step:
                continue
            # A second time constant below a time step only shows how JSBSim holds and averages
            # inputs.
            second_order = lag.product > max(_SECOND_ORDER * lag.total, fdm.time_step) * lag.total
            model = model.with_lag(j, lag if second_order else lag._replace(product=0.0))
            states.append(f"{control_input.name}_effect")
            if second_order:
                states.append(f"{control_input.name}_effect_rate")
    return LinearModel(
        A=model.a,
        B=model.b,
        C=np.vstack([np.eye(len(states)), model.c]),
        D=np.vstack([np.zeros((len(states), len(fdm.spec.inputs))), model.d]),
        state_labels=tuple(states),
        input_labels=tuple(i.name for i in fdm.spec.inputs),
        output_labels=(*states, *EXTRA_OUTPUTS),
    )


class _Lag(NamedTuple):
    """Sum [s] and product [s^2] of a lag's two time constants; the product is 0 for first order."""

    total: float
    product: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Matrices:
    """Matrices a, b of the states and c, d of the extra outputs."""

    a: Matrix
    b: Matrix
    c: Matrix
    d: Matrix

    def with_lag(self, j: int, lag: _Lag) -> "_Matrices":
        """The model in which input j acts through a lag of one or two further states."""
        n, m = self.b.shape
        if lag.product:
            follow = np.array([[0.0, 1.0], [-1.0 / lag.product, -lag.total / lag.product]])
            driven = np.array([[0.0], [1.0 / lag.product]])
        else:
            follow = np.array([[-1.0 / lag.total]])
            driven = np.array([[1.0 / lag.total]])
        order = len(follow)
        selected = np.eye(m)[[j]]
        without = 1.0 - selected[0]
        padding = np.zeros((len(self.c), order - 1))
        return _Matrices(
            a=np.block(
                [[self.a, self.b[:, [j]], np.zeros((n, order - 1))], [np.zeros((order, n)), follow]]
            ),
            b=np.vstack([self.b * without, driven @ selected]),
            c=np.hstack([self.c, self.d[:, [j]], padding]),
            d=self.d * without,
        )


class _Differences:
    """Central differences about a trim, with the rigid body held still.

    A reading has the rates of the body states, the extra outputs and the driven states. It is taken
    after settling, so a change of a body state also moves a propeller that depends on it; that part
    is subtracted.
    """

    def __init__(self, fdm: Fdm, trim: Trim) -> None:
        self._fdm = fdm
        self._spec = fdm.spec
        self._trim = trim
        self._driven_nodes = [fdm.node(s.position) for s in self._spec.driven_states]
        # Within a step JSBSim moves servos, then computes forces, then moves propellers.
        self._moves_first = np.array(
            [not s.position.startswith("propulsion/") for s in self._spec.driven_states]
        )
        self._scales = np.array([s.scale for s in self._spec.driven_states])
        self._body = np.array(
            [
                trim.airspeed,
                trim.alpha,
                trim.beta,
                *trim.rates_body,
                trim.roll,
                trim.pitch,
                trim.altitude,
            ]
        )
        self._inputs = np.array([trim.inputs[i.name] for i in self._spec.inputs])

    def with_driven_states(self) -> _Matrices:
        """Matrices of body and driven states; inputs without a driven state act without lag."""
        n_body = len(BODY_STATES)
        n_read = n_body + len(EXTRA_OUTPUTS)
        n_driven = len(self._spec.driven_states)
        n_inputs = len(self._inputs)
        steps = {"airspeed": _AIRSPEED_STEP * self._trim.airspeed, "altitude": _ALTITUDE_STEP}
        body_steps = np.array([steps.get(name, _STEP) for name in BODY_STATES])
        by_body = np.column_stack(
            [self._difference(body=j, step=step) for j, step in enumerate(body_steps)]
        )
        by_input = np.column_stack(
            [self._difference(control_input=j, step=_INPUT_STEP) for j in range(n_inputs)]
        )
        at_once = np.column_stack([self._difference_after_one_step(j) for j in range(n_inputs)])
        driven_by_body = by_body[n_read:]
        driven_by_input = by_input[n_read:]
        by_driven = np.zeros((n_read, n_driven))
        direct = by_input[:n_read].copy()
        poles = np.zeros(n_driven)
        forcing = np.zeros((n_driven, n_inputs))
        names = [i.name for i in self._spec.inputs]
        for i, state in enumerate(self._spec.driven_states):
            j = names.index(state.input)
            if driven_by_input[i, j] == 0.0:
                raise AircraftError(
                    f"aircraft '{self._spec.name}': '{state.position}' does not follow input"
                    f" '{state.input}'; check its spec"
                )
            # Settled: driven * change + direct. After one step: driven * change until then +
            # direct.
            left = by_input[:, j] - at_once[:, j]
            if abs(left[n_read + i]) <= _AT_ONCE * abs(driven_by_input[i, j]):
                raise self._follows_at_once(i)
            by_driven[:, i] = left[:n_read] / left[n_read + i]
            direct[:, j] -= by_driven[:, i] * driven_by_input[i, j]
            poles[i] = self._pole(i, j)
            forcing[i, j] = -poles[i] * driven_by_input[i, j]
        read_by_body = by_body[:n_read] - by_driven @ driven_by_body
        rates = [read_by_body[:n_body], by_driven[:n_body]]
        driven_rates = [-poles[:, None] * driven_by_body, np.diag(poles)]
        return _Matrices(
            a=np.block([rates, driven_rates]),
            b=np.vstack([direct[:n_body], forcing]),
            c=np.hstack([read_by_body[n_body:], by_driven[n_body:]]),
            d=direct[n_body:],
        )

    def measured_lag(self, control_input: ControlInput) -> _Lag:
        """Lag between an input and the accelerations, from a step response.

        With two lags, the difference from the final value has the area T1 + T2 and the first moment
        T1^2 + T1 T2 + T2^2.
        """
        name = control_input.name
        j = self._spec.inputs.index(control_input)
        step = _LAG_STEP.get(name, _INPUT_STEP)
        inputs = self._inputs.copy()
        inputs[j] += step if inputs[j] + step <= control_input.upper else -step
        self._hold(self._body, inputs)
        end = self._accelerations()
        self._hold(self._body, self._inputs)
        whole = self._accelerations() - end
        size = float(whole @ whole)
        if size == 0.0:
            raise AircraftError(
                f"aircraft '{self._spec.name}': input '{name}' has no effect; it cannot control the"
                " aircraft"
            )
        self._fdm.command({name: float(inputs[j])})
        area, moment = 0.5, 0.0
        for i in range(1, _LAG_STEPS_MAX):
            self._fdm.step()
            left = float((self._accelerations() - end) @ whole) / size
            area += left
            moment += i * left
            if abs(left) < _LAG_SETTLED:
                break
        time_step = self._fdm.time_step
        return _Lag(total=max(0.0, area) * time_step, product=(area**2 - moment) * time_step**2)

    def _accelerations(self) -> Matrix:
        return np.array([*self._fdm.acceleration_body(), *self._fdm.angular_acceleration()])

    def _difference(
        self, *, body: int | None = None, control_input: int | None = None, step: float
    ) -> Matrix:
        """Derivative of the reading with respect to one body state or input."""
        high, low = (self._read(body, control_input, sign * step) for sign in (1.0, -1.0))
        return (high - low) / (2.0 * step)

    def _read(self, body: int | None, control_input: int | None, step: float) -> Matrix:
        """Reading with one quantity moved, after settling."""
        point, inputs = self._body.copy(), self._inputs.copy()
        if body is not None:
            point[body] += step
        if control_input is not None:
            inputs[control_input] += step
        self._hold(point, inputs)
        return np.concatenate([self._rates_and_extras(point), self._driven()])

    def _difference_after_one_step(self, j: int) -> Matrix:
        """Derivative of the reading one step after input j is moved, with respect to that input."""
        reads = []
        for sign in (1.0, -1.0):
            self._hold(self._body, self._inputs)
            self._fdm.command(
                {self._spec.inputs[j].name: float(self._inputs[j]) + sign * _INPUT_STEP}
            )
            before = self._driven()
            self._fdm.step()
            acted = np.where(self._moves_first, self._driven(), before)
            reads.append(np.concatenate([self._rates_and_extras(self._body), acted]))
        return np.asarray((reads[0] - reads[1]) / (2.0 * _INPUT_STEP))

    def _hold(self, point: Matrix, inputs: Matrix) -> None:
        """Hold the body at a point of ``BODY_STATES`` with given inputs until all else settles."""
        v, alpha, beta, p, q, r, roll, pitch, altitude = (float(x) for x in point)
        self._fdm.command(
            {i.name: float(u) for i, u in zip(self._spec.inputs, inputs, strict=True)}
        )
        self._fdm.place(
            replace(
                self._trim.state(),
                altitude=altitude,
                roll=roll,
                pitch=pitch,
                velocity_body=body_velocity(v, alpha, beta),
                rates_body=(p, q, r),
            )
        )
        if not self._fdm.settle(_SETTLED):
            raise AircraftError(
                f"aircraft '{self._spec.name}': servos and propeller do not settle near the trim;"
                " check its spec"
            )

    def _driven(self) -> Matrix:
        positions = np.array([node.get_double_value() for node in self._driven_nodes])
        return np.asarray(positions * self._scales)

    def _rates_and_extras(self, point: Matrix) -> Matrix:
        v, alpha, beta, p, q, r, roll, pitch, _ = (float(x) for x in point)
        velocity = body_velocity(v, alpha, beta)
        u, side, w = velocity
        u_dot, side_dot, w_dot = self._fdm.acceleration_body()
        v_dot = (u * u_dot + side * side_dot + w * w_dot) / v
        alpha_dot = (u * w_dot - w * u_dot) / (u * u + w * w)
        beta_dot = (side_dot - v_dot * math.sin(beta)) / (v * math.cos(beta))
        roll_dot, pitch_dot, _ = euler_rates((p, q, r), roll, pitch)
        climb_rate = -level(velocity, roll, pitch)[2]
        # The body frame rotates relative to the earth, which adds rates x velocity.
        acceleration = (
            u_dot + q * w - r * side,
            side_dot + r * u - p * w,
            w_dot + p * side - q * u,
        )
        return np.array(
            [
                v_dot,
                alpha_dot,
                beta_dot,
                *self._fdm.angular_acceleration(),
                roll_dot,
                pitch_dot,
                climb_rate,
                course_rate(velocity, acceleration, roll, pitch),
                climb_rate,
            ]
        )

    def _pole(self, i: int, j: int) -> float:
        """Pole [1/s] of driven state i, from its return to rest after input j has moved.

        The first step is left out, because JSBSim averages the input over it.
        """
        self._hold(self._body, self._inputs)
        rest = self._driven()[i]
        self._read(None, j, _INPUT_STEP)
        self._fdm.command({self._spec.inputs[j].name: float(self._inputs[j])})
        self._fdm.step()
        first = self._driven()[i] - rest
        self._fdm.step()
        second = self._driven()[i] - rest
        if not 0.0 < second * first < first * first:
            raise self._follows_at_once(i)
        return math.log(second / first) / self._fdm.time_step

    def _follows_at_once(self, i: int) -> AircraftError:
        """Error for a driven state that reaches or passes its input within one or two steps."""
        state = self._spec.driven_states[i]
        return AircraftError(
            f"aircraft '{self._spec.name}': '{state.position}' follows input '{state.input}' within"
            f" a time step of {self._fdm.time_step:.4g} s, so it is not a state; leave"
            f" '{state.name}' out of the driven states of its spec"
        )
