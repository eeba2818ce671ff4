"""A scenario scaled to an aircraft: keys that it does not set follow from the aircraft's airspeed
and tightest turn.

The defaults of ``scenarios.scenario.sections`` are numbers for an aircraft that flies 19.42 m/s and
turns with 45 degrees of bank. One that flies V with omega_max = g tan(bank)/V has a unit of time,
1/omega_max, and one of length, V/omega_max; in these units every aircraft flies the same study. The
vessel and its keep-out area keep their sizes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from aircraft.spec import Envelope
from common.physics import heading_rate_for_bank
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import LAW_KEYS, GuidanceConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleFactors:
    """The ratios of an aircraft's units to those of the defaults [-]."""

    length: float
    time: float

    @property
    def speed(self) -> float:
        """Return the unit of speed."""
        return self.length / self.time


_SCALED: dict[str, Callable[[ScaleFactors], float]] = {
    "guidance.roll_rate_max_deg_s": lambda unit: 1.0 / unit.time,
    "guidance.tracking_allowance_m": lambda unit: unit.length,
    "guidance.bound_speed_margin_mps": lambda unit: unit.speed,
    "guidance.epsilon_per_m": lambda unit: 1.0 / unit.length,
    "guidance.look_ahead_m": lambda unit: unit.length,
    "guidance.gain_per_s": lambda unit: 1.0 / unit.time,
    "guidance.steering_max_rad_s": lambda unit: 1.0 / unit.time,
    "guidance.lyapunov_gain_per_m2": lambda unit: 1.0 / unit.length**2,
    "guidance.airspeed_gain_per_s": lambda unit: 1.0 / unit.time,
    "guidance.airspeed_trim_max_mps": lambda unit: unit.speed,
    "start.distance_m": lambda unit: unit.length,
    "flight.duration_max_s": lambda unit: unit.time,
    "flight.settling_band_m": lambda unit: unit.length,
    "following.margin_min_m": lambda unit: unit.length,
    "following.standoff_m": lambda unit: unit.length,
    "following.join_distance_m": lambda unit: unit.length,
    "following.tracked_m": lambda unit: unit.length,
    "criteria.tracking_error_rms_m": lambda unit: unit.length,
    "criteria.airspeed_error_rms_mps": lambda unit: unit.speed,
    "criteria.altitude_error_max_m": lambda unit: unit.speed,
}
"""Keys that are scaled, and the factors of their defaults. Altitude follows pitch at a given speed,
not the turn.
"""


def scaled(scenario: Scenario, envelope: Envelope) -> Scenario:
    """Return the scenario with every key that it does not set scaled to an aircraft.

    Parameters
    ----------
    scenario : as read from its file, so that the keys that it sets are known
    envelope : of the aircraft; the flight uses its airspeed and bank where the scenario sets
        neither

    Raises
    ------
    InputError : a scaled value is out of range
    """
    unit = units(envelope)
    flown: dict[str, object] = {
        "guidance.airspeed_mps": envelope.airspeed,
        "guidance.bank_deg": math.degrees(envelope.bank),
    }
    values = {key: value for key, value in flown.items() if not _is_set(scenario, key)}
    for key in scaled_keys(scenario):
        default, factor = _default(scenario, key), _SCALED[key](unit)
        values[key] = (
            tuple(x * factor for x in default) if isinstance(default, tuple) else default * factor
        )
    return with_values(scenario, values)


def scaled_keys(scenario: Scenario) -> list[str]:
    """Return the keys that ``scaled`` scales: lengths and times that the scenario does not set
    itself.
    """
    return [
        key for key in _SCALED if _default(scenario, key) is not None and not _is_set(scenario, key)
    ]


def scaled_law_defaults(envelope: Envelope) -> dict[str, float]:
    """Return the defaults of the project's own steering laws by their dotted keys, in SI units,
    scaled to an aircraft.
    """
    unit, defaults = units(envelope), GuidanceConfig()
    return {
        f"guidance.{name}": getattr(defaults, name) * _SCALED[f"guidance.{name}"](unit)
        for name in LAW_KEYS
    }


def units(envelope: Envelope) -> ScaleFactors:
    """Return an aircraft's units over those of the defaults."""
    default = GuidanceConfig()
    default_rate = heading_rate_for_bank(math.radians(default.bank_deg), default.airspeed_mps)
    rate = heading_rate_for_bank(envelope.bank, envelope.airspeed)
    time = default_rate / rate
    return ScaleFactors(time=time, length=envelope.airspeed / default.airspeed_mps * time)


def _default(scenario: Scenario, key: str) -> Any:
    section, name = key.split(".")
    return getattr(getattr(scenario, section, None), name, None)


def _is_set(scenario: Scenario, key: str) -> bool:
    section, name = key.split(".")
    return name in getattr(scenario, section).model_fields_set
