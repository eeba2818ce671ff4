"""Limits of the guidance's commands to an aircraft, checks that these can be flown and recorded,
and the interval of its plans.
"""

import math

from aircraft.spec import Envelope
from common.physics import bank_for_heading_rate, heading_rate_for_bank
from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig

PLAN_PERIOD = 0.5
"""Time between plans, and between measurements of the wind, to the nearest step of the guidance
[s].
"""

_PATH_ERROR_MAX = 0.05
"""Error of the recorded path between two samples above which a flight is refused [m]."""


def omega_max(guidance: GuidanceConfig) -> float:
    """Return omega_max, the largest heading rate that the guidance may command [rad/s]."""
    return guidance.heading_rate_max_rad_s or heading_rate_for_bank(
        math.radians(guidance.bank_deg), guidance.airspeed_mps
    )


def plan_interval(guidance: GuidanceConfig) -> int:
    """Return the guidance steps between plans."""
    return max(1, round(PLAN_PERIOD * guidance.rate_hz))


def plan_period(guidance: GuidanceConfig) -> float:
    """Return the time between plans, and between measurements of the wind, in whole steps of the
    guidance [s].
    """
    return plan_interval(guidance) / guidance.rate_hz


def check_flyable(guidance: GuidanceConfig, title: str, envelope: Envelope) -> None:
    """Raise an InputError for an airspeed or a bank that the aircraft called ``title`` cannot
    fly.
    """
    airspeed = guidance.airspeed_mps
    if not envelope.airspeed_min <= airspeed <= envelope.airspeed_max:
        raise InputError(
            f"guidance.airspeed_mps is {airspeed:g}; {title} flies {envelope.airspeed_min:.1f} to"
            f" {envelope.airspeed_max:.1f} m/s: choose an airspeed in between, or leave it out"
        )
    bank = bank_for_heading_rate(omega_max(guidance), airspeed)
    if bank > envelope.bank_max:
        raise InputError(
            f"guidance demands {math.degrees(bank):.1f} deg of bank; the autopilot of {title}"
            f" stops at {math.degrees(envelope.bank_max):.0f}: lower guidance.bank_deg or"
            " guidance.heading_rate_max_rad_s"
        )


def path_error_max(scenario: Scenario, log_rate: float) -> float:
    """Return the largest error of the cubic between two samples of a kinematic vehicle's path [m].

    The error of a cubic through positions and velocities is at most dt^2/16 times the change of the
    acceleration (the integral of the kernel of its error); a constant acceleration is reproduced.
    Here the acceleration is the centripetal one, V omega_max. It turns by omega_max dt, and a
    command reverses it: at once without a lag, but not within a step of the guidance.

    Parameters
    ----------
    scenario : of the vehicle, with V, omega_max, its lag and the rate of its guidance
    log_rate : of the samples [Hz]
    """
    g, lag, interval = scenario.guidance, scenario.kinematic.heading_rate_lag_s, 1.0 / log_rate
    fastest = omega_max(g)
    at_once = float(round(g.rate_hz / log_rate) > 1)
    reversal = interval / lag if lag > 0.0 else at_once
    change = min(1.0, 0.5 * fastest * interval + reversal)
    return g.airspeed_mps * fastest * change * interval**2 / 16.0


def check_recorded(scenario: Scenario) -> None:
    """Raise an InfeasibleError for kinematic flights that turn too fast for keep-out figures at the
    rate of their record.

    An aircraft has to roll first: at 5 Hz and 60 degrees of bank the error would be 4.2 cm even for
    an immediate reversal.
    """
    g, rate = scenario.guidance, scenario.flight.log_rate_hz
    error = path_error_max(scenario, rate)
    if scenario.fidelity != "kinematic" or scenario.circles or error <= _PATH_ERROR_MAX:
        return
    raise InfeasibleError(
        f"flight.log_rate_hz is {rate:g} Hz; at {omega_max(g):.3g} rad/s and {g.airspeed_mps:.4g}"
        " m/s the path between two samples, and with it keep-out figures, may be wrong by"
        f" {error:.2g} m, and the limit is {_PATH_ERROR_MAX:g} m: record and guide more often"
        " (flight.log_rate_hz, guidance.rate_hz), or lower guidance.heading_rate_max_rad_s"
    )
