"""The control law in Python, term by term as ``innerloop.jsbsim.system`` writes it for JSBSim.

Margins and predicted responses are computed from the linearised law. Limits and saturations exist
only in JSBSim, because the linear model has none.
"""

import bisect
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields

import numpy as np
import numpy.typing as npt

from aircraft.linearise import LinearModel
from aircraft.trim import Trim
from common.physics import STANDARD_GRAVITY
from innerloop.schedule import LATERAL, LONGITUDINAL, Gains, Schedule

COMMANDS = ("airspeed_command", "altitude_command", "heading_rate_command")
"""Commands [m/s, m, rad/s]."""

STATES = (
    "elevator_integral",
    "throttle_integral",
    "bank_integral",
    "rudder_integral",
    "model_rate",
    "model_acceleration",
)
"""States of the autopilot: integrals, and rate and acceleration of the heading-rate model [SI]."""

_STEP = 1e-4
"""Step of the differences that linearise the law [SI].

The law consists of products and piecewise linear tables, so only rounding limits the step.
"""

_LEVEL_TURN = 0.2
"""Turn V omega/g to either side that gives the slope near level flight [-]."""

Array = npt.NDArray[np.float64]


def measurements(schedule: Schedule) -> tuple[str, ...]:
    """Return the names of the measured quantities; sideslip is measured only with a rudder."""
    lateral = LATERAL if "rudder" in schedule.controls else LATERAL[:-1]
    return (*LONGITUDINAL, *lateral, "heading_rate")


class ControlLaw:
    """The autopilot without limits, as a function of commands, measurements and states."""

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule
        self._airspeeds = np.array(schedule.airspeeds)
        # All trim quantities share a table, and so do all gains, because a call of an interpolator
        # costs more than an additional value.
        self._quantities = ["pitch", "q", "r", *schedule.controls]
        tables = np.stack([schedule.over_bank(name) for name in self._quantities], axis=-1)
        self._over_bank = _table(schedule.banks, self._airspeeds, tables)
        self._banks = (schedule.banks[0], schedule.banks[-1])
        self._gain_banks = (schedule.gain_banks[0], schedule.gain_banks[-1])
        by_airspeed = np.stack([[gain_vector(g) for g in row] for row in schedule.gains])
        self._gains = _table(schedule.gain_banks, self._airspeeds, by_airspeed.transpose(1, 0, 2))
        self._slopes = bank_slopes(schedule)
        turns = schedule.turns()
        self._bank_for_turn = _scalar_table(turns, self._airspeeds, schedule.bank_for_turn(turns))

    def trim_tables(self, bank: float, airspeed: float) -> dict[str, float]:
        """Return the tabulated trim quantities at a bank [rad] and commanded airspeed [m/s]."""
        low, high = self._banks
        values = self._over_bank(min(max(bank, low), high), airspeed).tolist()
        return dict(zip(self._quantities, values, strict=True))

    def gains(self, bank: float, airspeed: float) -> Array:
        """Return the ``gain_vector`` at a bank [rad] and commanded airspeed [m/s]."""
        low, high = self._gain_banks
        return self._gains(min(max(bank, low), high), airspeed)

    def model_bank(self, heading_rate: float, measured_airspeed: float, airspeed: float) -> float:
        """Return the bank [rad] for a heading rate [rad/s], by measured and commanded airspeed."""
        turn = heading_rate * measured_airspeed / STANDARD_GRAVITY
        return self._bank_for_turn(turn, airspeed)

    def bank_slope(self, bank: float, measured_airspeed: float, airspeed: float) -> float:
        """Return the change of bank per heading rate [s]: cos^2(bank) V/g, or more in a slip."""
        slope = float(np.interp(airspeed, self._airspeeds, self._slopes))
        return math.cos(bank) ** 2 * slope * measured_airspeed / STANDARD_GRAVITY

    def evaluate(
        self,
        commands: Mapping[str, float],
        measured: Mapping[str, float],
        states: Mapping[str, float],
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Return the rates of ``STATES`` and the controls [-].

        Arguments are absolute values (not deviations) by the names of ``COMMANDS``,
        ``measurements`` and ``STATES``.
        """
        airspeed = commands["airspeed_command"]
        at_bank = self.trim_tables(measured["roll"], airspeed)
        gains = _split(self.gains(measured["roll"], airspeed))
        errors = {
            "airspeed": airspeed - measured["airspeed"],
            "climb_rate": -measured["climb_rate"],
            "q": at_bank["q"] - measured["q"],
            "pitch": at_bank["pitch"] - measured["pitch"],
            "altitude": commands["altitude_command"] - measured["altitude"],
        }
        rates: dict[str, float] = {}
        controls: dict[str, float] = {}
        for row, name in enumerate(("elevator", "throttle")):
            feedback = sum(
                gains.longitudinal[row, j] * errors[state] for j, state in enumerate(LONGITUDINAL)
            )
            controls[name] = at_bank[name] + states[f"{name}_integral"] + float(feedback)
            integral = gains.longitudinal_integral[row]
            rates[f"{name}_integral"] = float(
                integral[0] * errors["airspeed"] + integral[1] * errors["altitude"]
            )

        frequency = self.schedule.weights.model_frequency
        damping = self.schedule.weights.model_damping
        jerk = (
            frequency**2 * (commands["heading_rate_command"] - states["model_rate"])
            - 2.0 * damping * frequency * states["model_acceleration"]
        )
        model_bank = self.model_bank(states["model_rate"], measured["airspeed"], airspeed)
        bank_command = model_bank + states["bank_integral"]
        slope = self.bank_slope(model_bank, measured["airspeed"], airspeed)
        at_command = self.trim_tables(bank_command, airspeed)
        lateral_errors = {
            "p": slope * states["model_acceleration"] - measured["p"],
            "r": at_bank["r"] - measured["r"],
            "roll": bank_command - measured["roll"],
            "beta": -measured.get("beta", 0.0),
        }
        for row, name in enumerate(("aileron", "rudder")):
            if name not in self.schedule.controls:
                continue
            feedback = sum(
                gains.lateral[row, j] * lateral_errors[state] for j, state in enumerate(LATERAL)
            )
            ahead = slope * (
                gains.roll_rate_feedforward[row] * states["model_acceleration"]
                + gains.roll_acceleration_feedforward[row] * jerk
            )
            controls[name] = at_command[name] + float(feedback) + float(ahead)
        if "rudder" in controls:
            controls["rudder"] += states["rudder_integral"]
        rates["bank_integral"] = float(
            gains.heading_integral * (states["model_rate"] - measured["heading_rate"])
        )
        rates["rudder_integral"] = float(gains.sideslip_integral * measured.get("beta", 0.0))
        rates["model_rate"] = states["model_acceleration"]
        rates["model_acceleration"] = jerk
        return rates, controls


def linear_controller(law: ControlLaw, trim: Trim) -> LinearModel:
    """Return the autopilot, linearised about an equilibrium of the aircraft.

    Inputs are ``COMMANDS`` and the measurements, outputs are the control inputs, and states are
    ``STATES``, all as deviations from trim. At a node of a table the slope is the mean of both
    sides.
    """
    point = operating_point(law, trim)
    inputs = (*COMMANDS, *measurements(law.schedule))
    controls = law.schedule.controls

    def column(name: str) -> Array:
        """Return the derivatives of rates and controls by one entry of the operating point."""
        sides = []
        for sign in (1.0, -1.0):
            moved = {**point, name: point[name] + sign * _STEP}
            rates, outputs = law.evaluate(moved, moved, moved)
            sides.append(np.array([*(rates[s] for s in STATES), *(outputs[c] for c in controls)]))
        return np.asarray((sides[0] - sides[1]) / (2.0 * _STEP))

    by_state = np.column_stack([column(name) for name in STATES])
    by_input = np.column_stack([column(name) for name in inputs])
    n = len(STATES)
    kept = [i for i, name in enumerate(STATES) if name != "rudder_integral" or "rudder" in controls]
    return LinearModel(
        A=by_state[:n][np.ix_(kept, kept)],
        B=by_input[:n][kept],
        C=by_state[n:][:, kept],
        D=by_input[n:],
        state_labels=tuple(STATES[i] for i in kept),
        input_labels=inputs,
        output_labels=controls,
    )


def operating_point(law: ControlLaw, trim: Trim) -> dict[str, float]:
    """Return commands, measurements and states of the autopilot in an equilibrium, by name.

    Straight flight is taken at zero bank, the node between turns to the left and to the right,
    although propeller and ailerons bank the aircraft by about a tenth of a degree.
    """
    roll = trim.roll if trim.yaw_rate else 0.0
    model_bank = law.model_bank(trim.yaw_rate, trim.airspeed, trim.airspeed)
    return {
        "airspeed_command": trim.airspeed,
        "altitude_command": trim.altitude,
        "heading_rate_command": trim.yaw_rate,
        "airspeed": trim.airspeed,
        "altitude": trim.altitude,
        "climb_rate": 0.0,
        "pitch": trim.pitch,
        "roll": roll,
        "beta": trim.beta,
        "heading_rate": trim.yaw_rate,
        **dict(zip("pqr", trim.rates_body, strict=True)),
        **dict.fromkeys(STATES, 0.0),
        "bank_integral": roll - model_bank,
        "model_rate": trim.yaw_rate,
    }


def bank_slopes(schedule: Schedule) -> list[float]:
    """Return tan(bank) per dimensionless turn V omega/g near level flight, by airspeed [-].

    The slope is 1 in coordinated turns.
    """
    low, high = schedule.bank_for_turn(np.array([-_LEVEL_TURN, _LEVEL_TURN]))
    return [
        (math.tan(b) - math.tan(a)) / (2.0 * _LEVEL_TURN) for a, b in zip(low, high, strict=True)
    ]


def gain_vector(gains: Gains) -> Array:
    """Return all gains as a vector in the order of their fields, shape (28,)."""
    return np.concatenate([np.ravel(getattr(gains, field.name)) for field in fields(Gains)])


def _split(vector: Array) -> Gains:
    """Return the gains from a vector of ``gain_vector``."""
    return Gains(
        longitudinal=vector[:10].reshape(2, 5),
        longitudinal_integral=vector[10:14].reshape(2, 2),
        lateral=vector[14:22].reshape(2, 4),
        heading_integral=float(vector[22]),
        sideslip_integral=float(vector[23]),
        roll_rate_feedforward=vector[24:26],
        roll_acceleration_feedforward=vector[26:28],
    )


def _table(
    rows: Sequence[float] | Array, columns: Array, values: Array
) -> Callable[[float, float], Array]:
    """Return the bilinear interpolation of a table of vectors, extended past its edges.

    Values are cached, because linearisation looks up the same few points many times.
    """
    at_row, at_column = _cells(rows), _cells(columns)

    @functools.lru_cache(maxsize=32)
    def value(row: float, column: float) -> Array:
        i, y = at_row(row)
        j, x = at_column(column)
        found = values[i, j] * ((1.0 - y) * (1.0 - x)) + values[i, j + 1] * ((1.0 - y) * x)
        found = found + values[i + 1, j] * (y * (1.0 - x)) + values[i + 1, j + 1] * (y * x)
        found.flags.writeable = False
        return found

    return value


def _scalar_table(
    rows: Sequence[float] | Array, columns: Array, values: Array
) -> Callable[[float, float], float]:
    """Return the bilinear interpolation of a table of numbers, extended past its edges."""
    at_row, at_column, table = _cells(rows), _cells(columns), values.tolist()

    def value(row: float, column: float) -> float:
        i, y = at_row(row)
        j, x = at_column(column)
        low, high = table[i], table[i + 1]
        return float(
            low[j] * (1.0 - y) * (1.0 - x)
            + low[j + 1] * (1.0 - y) * x
            + high[j] * y * (1.0 - x)
            + high[j + 1] * y * x
        )

    return value


def _cells(points: Sequence[float] | Array) -> Callable[[float], tuple[int, float]]:
    """Return a function that finds a coordinate's cell among ascending points: index and fraction.

    Past the ends of the points the fraction is below 0 or above 1.
    """
    at = [float(point) for point in points]
    last = len(at) - 2

    def cell(coordinate: float) -> tuple[int, float]:
        i = min(max(bisect.bisect_right(at, coordinate) - 1, 0), last)
        return i, (coordinate - at[i]) / (at[i + 1] - at[i])

    return cell
