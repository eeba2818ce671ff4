"""The control law in Python, term by term as ``innerloop.jsbsim.system`` writes it for JSBSim, to
be linearised.

Limits and saturations are left out: they are part of the autopilot in JSBSim, not of its linear
model.
"""

import bisect
import functools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from common.physics.units import STANDARD_GRAVITY
from innerloop.synthesis.gains import LATERAL, LONGITUDINAL, Gains
from innerloop.synthesis.schedule import Schedule

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
"""States of the autopilot: integrals, and the reference model's heading rate and its rate
[rad/s, rad/s^2].
"""

Array = npt.NDArray[np.float64]


def measurements(schedule: Schedule) -> tuple[str, ...]:
    """Return the measured quantities, named as in the linear model; sideslip only where a rudder
    acts on it.
    """
    lateral = LATERAL if "rudder" in schedule.controls else LATERAL[:-1]
    return (*LONGITUDINAL, *lateral, "heading_rate")


class ControlLaw:
    """The autopilot between its tables' edges, as a function of commands, measurements and its own
    states.
    """

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule
        self._airspeeds = np.array(schedule.airspeeds)
        # One table for all trim quantities and one for all gains: an interpolator's call costs more
        # than its values.
        self._quantities = ["pitch", "q", "r", *schedule.controls]
        tables = np.stack([schedule.over_bank(name) for name in self._quantities], axis=-1)
        self._over_bank = _table(schedule.banks, self._airspeeds, tables)
        self._banks, self._gain_banks = (
            (schedule.banks[0], schedule.banks[-1]),
            (schedule.gain_banks[0], schedule.gain_banks[-1]),
        )
        stacked = np.stack([[gain_vector(g) for g in row] for row in schedule.gains]).transpose(
            1, 0, 2
        )
        self._gains = _table(schedule.gain_banks, self._airspeeds, stacked)
        self._slopes = bank_slopes(schedule)
        turns = schedule.turns()
        self._bank_for_turn = _scalar_table(turns, self._airspeeds, schedule.bank_for_turn(turns))

    def trim_tables(self, bank: float, airspeed: float) -> dict[str, float]:
        """Return the tabled trim quantities at a bank [rad] and commanded airspeed [m/s]."""
        low, high = self._banks
        return dict(
            zip(
                self._quantities,
                self._over_bank(min(max(bank, low), high), airspeed).tolist(),
                strict=True,
            )
        )

    def gains(self, bank: float, airspeed: float) -> Array:
        """Return the gains at a bank [rad] and commanded airspeed [m/s], as ``gain_vector`` orders
        them.
        """
        low, high = self._gain_banks
        return self._gains(min(max(bank, low), high), airspeed)

    def model_bank(self, heading_rate: float, measured_airspeed: float, airspeed: float) -> float:
        """Return the bank that turns at a heading rate [rad/s] with a measured and a commanded
        airspeed [m/s].
        """
        turn = heading_rate * measured_airspeed / STANDARD_GRAVITY
        return self._bank_for_turn(turn, airspeed)

    def bank_slope(self, bank: float, measured_airspeed: float, airspeed: float) -> float:
        """Return the bank rate per rate of heading rate [s] about a bank: cos^2(bank) V/g, more if
        it slips.
        """
        slope = float(np.interp(airspeed, self._airspeeds, self._slopes))
        return math.cos(bank) ** 2 * slope * measured_airspeed / STANDARD_GRAVITY

    def evaluate(
        self,
        commands: Mapping[str, float],
        measured: Mapping[str, float],
        states: Mapping[str, float],
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Return the rates of ``STATES`` and the controls [-].

        Parameters
        ----------
        commands, measured, states : by the names of ``COMMANDS``, ``measurements`` and ``STATES``,
            absolute values
        """
        weights, airspeed = self.schedule.weights, commands["airspeed_command"]
        at_bank = self.trim_tables(measured["roll"], airspeed)
        gains = _Named(self.gains(measured["roll"], airspeed))
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

        frequency, damping = weights.model_frequency, weights.model_damping
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
                gains.by_rate[row] * states["model_acceleration"]
                + gains.by_acceleration[row] * jerk
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


def _table(
    rows: Sequence[float] | Array, columns: Array, values: Array
) -> Callable[[float, float], Array]:
    """Return the bilinear look-up of a table of vectors, extended past its edges.

    To linearise asks for the same point again and again, and moves it in few directions.
    """
    at_row, at_column = _cells(rows), _cells(columns)

    @functools.lru_cache(maxsize=32)
    def value(row: float, column: float) -> Array:
        (i, y), (j, x) = at_row(row), at_column(column)
        found = values[i, j] * ((1.0 - y) * (1.0 - x)) + values[i, j + 1] * ((1.0 - y) * x)
        found = found + values[i + 1, j] * (y * (1.0 - x)) + values[i + 1, j + 1] * (y * x)
        found.flags.writeable = False
        return found

    return value


def _scalar_table(
    rows: Sequence[float] | Array, columns: Array, values: Array
) -> Callable[[float, float], float]:
    """Return the bilinear look-up of a table of numbers, extended past its edges."""
    at_row, at_column, table = _cells(rows), _cells(columns), values.tolist()

    def value(row: float, column: float) -> float:
        (i, y), (j, x) = at_row(row), at_column(column)
        low, high = table[i], table[i + 1]
        return float(
            low[j] * (1.0 - y) * (1.0 - x)
            + low[j + 1] * (1.0 - y) * x
            + high[j] * y * (1.0 - x)
            + high[j + 1] * y * x
        )

    return value


def _cells(points: Sequence[float] | Array) -> Callable[[float], tuple[int, float]]:
    """Return a function from a coordinate to its cell among ascending ``points``: index, and share
    of the cell below it.
    """
    at = [float(point) for point in points]
    last = len(at) - 2

    def cell(coordinate: float) -> tuple[int, float]:
        i = min(max(bisect.bisect_right(at, coordinate) - 1, 0), last)
        return i, (coordinate - at[i]) / (at[i + 1] - at[i])

    return cell


def gain_vector(gains: Gains) -> Array:
    """Return every gain in one vector, which ``_Named`` splits again."""
    return np.concatenate(
        [
            gains.longitudinal.ravel(),
            gains.longitudinal_integral.ravel(),
            gains.lateral.ravel(),
            [gains.heading_integral, gains.sideslip_integral],
            gains.roll_rate_feedforward,
            gains.roll_acceleration_feedforward,
        ]
    )


class _Named:
    """The gains of a vector by name."""

    def __init__(self, vector: Array) -> None:
        self.longitudinal = vector[:10].reshape(2, 5)
        self.longitudinal_integral = vector[10:14].reshape(2, 2)
        self.lateral = vector[14:22].reshape(2, 4)
        self.heading_integral, self.sideslip_integral = vector[22:24]
        self.by_rate = vector[24:26]
        self.by_acceleration = vector[26:28]


def bank_slopes(schedule: Schedule) -> list[float]:
    """Return tan(bank) over dimensionless turn V omega/g near level flight, by airspeed: 1 in
    coordinated turns.
    """
    low, high = schedule.bank_for_turn(np.array([-0.2, 0.2]))
    return [(math.tan(b) - math.tan(a)) / 0.4 for a, b in zip(low, high, strict=True)]
