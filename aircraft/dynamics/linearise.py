"""Linear model about an equilibrium, by central differences on JSBSim itself, servos and propeller
included.

JSBSim's own linearisation bypasses servo lags and leaves the simulation unusable, so the rigid body
is held still (``Fdm.frozen``), one quantity at a time is moved both ways, and the accelerations are
read once all else has settled. A servo or propeller cannot be set directly; it is moved by holding
its input off trim, and its own pole is read from how it returns. The direct effect of an input,
before servo or propeller has moved (a motor's torque on the airframe), is separated by reading
after one step as well.

Where the spec names no property that follows an input (for stock aircraft it is unknown), the
input's lag is measured: the difference of the accelerations from their final value after a step has
an area and a first moment in time, and those are the coefficients of a lag of first or second order
(a piston engine's manifold pressure, then its speed).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from aircraft.dynamics.equilibrium import Trim
from aircraft.dynamics.linear_model import LinearModel
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.state import body_velocity, course_rate, euler_rates, level

BODY_STATES = ("airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch", "altitude")
"""Rigid-body states: [m/s, rad, rad, rad/s, rad/s, rad/s, rad, rad, m]. Position and yaw do not act
back.
"""

EXTRA_OUTPUTS = ("heading_rate", "climb_rate")
"""Outputs beside the states: rate of the air-relative course [rad/s] and climb rate [m/s]."""

_AIRSPEED_STEP = 0.0025
_ALTITUDE_STEP = 5.0
_STEP = 0.002
_INPUT_STEP = 0.01
"""Steps of the differences: airspeed over itself [-], altitude [m], angles and body rates
[rad, rad/s], inputs [-]. They are large against what is left of settling, ``_SETTLED``, and small
against the curvature of a model's tables.
"""

_LAG_STEP = {"throttle": 0.05}
"""Input steps for measuring lags: a turbine spools at a steady rate, so a small step would show no
lag [-].
"""

_SETTLED = 3e-8
"""Change of acceleration a step below which engines count as settled: behind one as slow as a
second, 4e-6 from the end, where the differences are 5e-3 and more."""

_LAG_STEPS_MAX = 2400
_LAG_SETTLED = 0.002
"""A lag is measured for this many time steps at most, 20 s, or until this fraction of the effect is
left [-].
"""

_SECOND_ORDER = 0.05
"""Product of two time constants over the square of their sum below which the lag counts as of first
order [-].
"""

_AT_ONCE = 1e-6
"""A driven state that has no more than this of its way left one step after its input follows at
once [-]; rounding leaves less.
"""

_NO_LAG = 0.6
"""A time constant below this many steps is the half step of holding an input, not a lag [-]."""


def linearise(fdm: Fdm, trim: Trim) -> LinearModel:
    """Return the linear model about ``trim``, with named states, inputs and outputs.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    trim : the equilibrium, straight or turning

    Returns
    -------
    LinearModel
        States: ``BODY_STATES`` followed by the aircraft's driven states, then ``INPUT_effect`` for
        each measured lag, followed by ``INPUT_effect_rate`` where it is of second order. Inputs:
        the aircraft's control inputs [-]. Outputs: every state followed by ``EXTRA_OUTPUTS``. All
        are deviations from trim, in SI and radians.

    Raises
    ------
    AircraftError : a driven state does not follow its input, or follows it at once
    """
    with fdm.frozen():
        return _Differences(fdm, trim).model()


class _Differences:
    """Everything is read settled, so a body state also moves a propeller that follows it; that part
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

    def model(self) -> LinearModel:
        n_body, n_driven, n_inputs = (
            len(BODY_STATES),
            len(self._spec.driven_states),
            len(self._inputs),
        )
        steps = {"airspeed": _AIRSPEED_STEP * self._trim.airspeed, "altitude": _ALTITUDE_STEP}
        body_steps = np.array([steps.get(name, _STEP) for name in BODY_STATES])
        by_body = np.column_stack(
            [self._difference(body=j, step=step) for j, step in enumerate(body_steps)]
        )
        by_input = np.column_stack(
            [self._difference(control_input=j, step=_INPUT_STEP) for j in range(n_inputs)]
        )
        driver = [
            [i.name for i in self._spec.inputs].index(s.input) for s in self._spec.driven_states
        ]
        n_read = len(by_body) - n_driven
        driven_by_body, driven_by_input = by_body[n_read:], by_input[n_read:]
        at_once = np.column_stack([self._first_step(j) for j in range(n_inputs)])
        by_driven, direct = np.zeros((n_read, n_driven)), by_input[:n_read].copy()
        poles = np.zeros(n_driven)
        for i, j in enumerate(driver):
            if driven_by_input[i, j] == 0.0:
                state = self._spec.driven_states[i]
                raise AircraftError(
                    f"aircraft '{self._spec.name}': '{state.position}' does not follow input '{state.input}'; check its spec"
                )
            # Settled: driven * moved + direct. After one step: driven * moved by then + direct.
            left = by_input[:, j] - at_once[:, j]
            if abs(left[n_read + i]) <= _AT_ONCE * abs(driven_by_input[i, j]):
                raise self._follows_at_once(i)
            by_driven[:, i] = left[:n_read] / left[n_read + i]
            direct[:, j] -= by_driven[:, i] * driven_by_input[i, j]
            poles[i] = self._pole(i, j)
        read_by_body = by_body[:n_read] - by_driven @ driven_by_body
        a = np.block([
            [read_by_body[:n_body], by_driven[:n_body]],
            [-poles[:, None] * driven_by_body, np.diag(poles)],
        ])  # fmt: skip
        driven_forcing = np.zeros((n_driven, n_inputs))
        for i, j in enumerate(driver):
            driven_forcing[i, j] = -poles[i] * driven_by_input[i, j]
        extras = np.hstack([read_by_body[n_body:], by_driven[n_body:]])
        model = _Model(
            a=a, b=np.vstack([direct[:n_body], driven_forcing]), c=extras, d=direct[n_body:]
        )
        states = [*BODY_STATES, *(s.name for s in self._spec.driven_states)]
        for j, control_input in enumerate(self._spec.inputs):
            if j in driver:
                continue
            lag, product = self._measured_lag(j)
            if lag <= _NO_LAG * self._fdm.time_step:
                continue
            # A smaller lag of less than a step is how JSBSim holds and averages an input, not a lag
            # of the aircraft.
            second = product > max(_SECOND_ORDER * lag, self._fdm.time_step) * lag
            model = model.with_lag(j, lag, product if second else 0.0)
            states += [f"{control_input.name}_effect", f"{control_input.name}_effect_rate"][
                : 1 + second
            ]
        return LinearModel(
            A=model.a,
            B=model.b,
            C=np.vstack([np.eye(len(states)), model.c]),
            D=np.vstack([np.zeros((len(states), n_inputs)), model.d]),
            state_labels=tuple(states),
            input_labels=tuple(i.name for i in self._spec.inputs),
            output_labels=(*states, *EXTRA_OUTPUTS),
        )

    def _measured_lag(self, j: int) -> tuple[float, float]:
        """Return sum and product of the time constants between input j and the accelerations
        [s, s^2].

        Behind two lags, the difference from the final value has the area T1 + T2 and the first
        moment T1^2 + T1 T2 + T2^2.
        """
        name, step = (
            self._spec.inputs[j].name,
            _LAG_STEP.get(self._spec.inputs[j].name, _INPUT_STEP),
        )
        inputs = self._inputs.copy()
        inputs[j] += step if inputs[j] + step <= self._spec.inputs[j].upper else -step
        self._hold(self._body, inputs)
        end = self._accelerations()
        self._hold(self._body, self._inputs)
        whole = self._accelerations() - end
        size = float(whole @ whole)
        if size == 0.0:
            raise AircraftError(
                f"aircraft '{self._spec.name}': input '{name}' has no effect; it cannot control the aircraft"
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
        return max(0.0, area) * self._fdm.time_step, (area**2 - moment) * self._fdm.time_step**2

    def _accelerations(self) -> npt.NDArray[np.float64]:
        return np.array([*self._fdm.acceleration_body(), *self._fdm.angular_acceleration()])

    def _difference(
        self, *, body: int | None = None, control_input: int | None = None, step: float
    ) -> npt.NDArray[np.float64]:
        high, low = (self._read(body, control_input, sign * step) for sign in (1.0, -1.0))
        return (high - low) / (2.0 * step)

    def _read(
        self, body: int | None, control_input: int | None, step: float
    ) -> npt.NDArray[np.float64]:
        """Return rates of body states, extra outputs and driven states, one quantity moved and all
        settled.
        """
        point, inputs = self._body.copy(), self._inputs.copy()
        if body is not None:
            point[body] += step
        if control_input is not None:
            inputs[control_input] += step
        self._hold(point, inputs)
        return np.concatenate([self._rates_and_extras(point), self._driven()])

    def _first_step(self, j: int) -> npt.NDArray[np.float64]:
        """Difference by control input j of what is read one step after it is moved."""
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

    def _hold(self, point: npt.NDArray[np.float64], inputs: npt.NDArray[np.float64]) -> None:
        v, alpha, beta, p, q, r, roll, pitch, altitude = (float(x) for x in point)
        self._fdm.command(
            {i.name: float(u) for i, u in zip(self._spec.inputs, inputs, strict=True)}
        )
        velocity = body_velocity(v, alpha, beta)
        self._fdm.place(
            replace(
                self._trim.state(),
                altitude=altitude,
                roll=roll,
                pitch=pitch,
                velocity_body=velocity,
                rates_body=(p, q, r),
            )
        )
        if not self._fdm.settle(_SETTLED):
            raise AircraftError(
                f"aircraft '{self._spec.name}': servos and propeller do not settle near the trim; check its spec"
            )

    def _driven(self) -> npt.NDArray[np.float64]:
        return np.asarray(
            np.array([node.get_double_value() for node in self._driven_nodes]) * self._scales
        )

    def _rates_and_extras(self, point: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        v, alpha, beta, p, q, r, roll, pitch, _ = (float(x) for x in point)
        velocity = body_velocity(v, alpha, beta)
        u, side, w = velocity
        u_dot, side_dot, w_dot = self._fdm.acceleration_body()
        v_dot = (u * u_dot + side * side_dot + w * w_dot) / v
        alpha_dot = (u * w_dot - w * u_dot) / (u * u + w * w)
        beta_dot = (side_dot - v_dot * math.sin(beta)) / (v * math.cos(beta))
        roll_dot, pitch_dot, _ = euler_rates((p, q, r), roll, pitch)
        climb_rate = -level(velocity, roll, pitch)[2]
        # Against the earth the body's frame turns, which adds rates x velocity.
        acceleration = (
            u_dot + q * w - r * side,
            side_dot + r * u - p * w,
            w_dot + p * side - q * u,
        )
        rates = [
            v_dot,
            alpha_dot,
            beta_dot,
            *self._fdm.angular_acceleration(),
            roll_dot,
            pitch_dot,
            climb_rate,
        ]
        return np.array([*rates, course_rate(velocity, acceleration, roll, pitch), climb_rate])

    def _pole(self, i: int, j: int) -> float:
        """Return the pole of driven state i from its return to rest, after the first step, which
        averages inputs.
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
        """Return the error of a driven state whose way to its input is over, or beyond it, within a
        time step or two.
        """
        state = self._spec.driven_states[i]
        return AircraftError(
            f"aircraft '{self._spec.name}': '{state.position}' follows input '{state.input}' within a time step of"
            f" {self._fdm.time_step:.4g} s, so that it is no state; leave '{state.name}' out of the driven states of its spec"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Model:
    """Matrices of states and of extra outputs."""

    a: npt.NDArray[np.float64]
    b: npt.NDArray[np.float64]
    c: npt.NDArray[np.float64]
    d: npt.NDArray[np.float64]

    def with_lag(self, j: int, lag: float, product: float) -> "_Model":
        """Return the model in which input j acts through one or two states of its own.

        The sum of their time constants is ``lag`` [s], their product ``product`` [s^2]; 0 for a
        single one.
        """
        n, m = self.b.shape
        if product:
            follow, driven = (
                np.array([[0.0, 1.0], [-1.0 / product, -lag / product]]),
                np.array([[0.0], [1.0 / product]]),
            )
        else:
            follow, driven = np.array([[-1.0 / lag]]), np.array([[1.0 / lag]])
        order = len(follow)
        selected = np.eye(m)[[j]]
        without = 1.0 - selected[0]
        padding = np.zeros((len(self.c), order - 1))
        return _Model(
            a=np.block(
                [[self.a, self.b[:, [j]], np.zeros((n, order - 1))], [np.zeros((order, n)), follow]]
            ),
            b=np.vstack([self.b * without, driven @ selected]),
            c=np.hstack([self.c, self.d[:, [j]], padding]),
            d=self.d * without,
        )
