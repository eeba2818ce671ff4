"""The error budget of a flight beside a vessel, from the declarations of its scenario.

The error of dead reckoning in steady air, by errors of sensors and of the estimated wind, is
declared, or follows from the sensors and the airspeed if that is more. The scenario's air adds to
it: mean wind, gusts, and turbulence.
"""

import math

import numpy as np
import numpy.typing as npt

from aircraft.wind import WindField
from gnc.estimation.error_budget import Bias, ErrorBudget, Growth, Process, TurnDeviation
from gnc.estimation.navigation import NOISE_DEVIATIONS
from scenarios.planning.air.wind import (
    WIND_FOLLOWED,
    largest_wind_change,
    turbulence_met,
    wind_bias,
    wind_change,
    wind_error_in_weaves,
    wind_followed,
    wind_noise,
    wind_noise_left,
)
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.sensors import NAVIGATION_TIME
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.faults import SATELLITES

Array = npt.NDArray[np.float64]

_CHANGING_TURNS = 0.02
"""Share of the airspeed by which dead reckoning goes wrong by itself [-]: its table of crab angles
is that of steady turns.

It is twice the largest of five aircraft that weave with periods of 3 to 40 s: 0.8 % for the X8, 1.0
% for the Aerosonde, 0.3 % for others.
"""

_AGES = 200
"""Number of ages of an outage at which the error is evaluated [-]."""


def error_budget(
    scenario: Scenario,
    setup: VehicleSetup,
    wind: WindField,
    *,
    turn: float,
    turning: TurnDeviation,
    slowest: float,
    failed_part: float,
) -> ErrorBudget:
    """Return the errors of a flight beside a vessel.

    Parameters
    ----------
    scenario, setup : the flight, and its vehicle
    wind : mean wind of the flight
    turn : time of a turn away [s]
    turning : deviation of a turn from its commands by turbulence
    slowest : airspeed that the vehicle may fall to in a turn [m/s]
    failed_part : deviation of a turn from its commands by the failure of a part [m]
    """
    f, altitude_error = scenario.following, setup.altitude_error
    drift = drift_rate(scenario, wind, turn, altitude_error)
    by_sensors, in_turns = velocity_error(scenario, drift), wind_error_in_weaves(scenario, setup)
    own_velocity = Bias(
        size=by_sensors + in_turns, key="sensors" if by_sensors >= in_turns else "aircraft"
    )
    if f.speed_error_mps >= own_velocity.size:
        own_velocity = Bias(size=f.speed_error_mps, key="following.speed_error_mps")
    return ErrorBudget(
        own_position=Process(
            sigma=scenario.sensors.position_sigma_m,
            correlation_time=NAVIGATION_TIME,
            key="sensors.position_sigma_m",
        ),
        own_velocity=own_velocity,
        gusts=Bias(size=scenario.turbulence.gust_speed_mps, key="turbulence.gust_speed_mps"),
        wind_change=Bias(size=wind_change(scenario, wind, altitude_error), key="wind.table"),
        turbulence=turbulence_met(scenario),
        turning=turning,
        response=Bias(
            size=max(setup.response_error, f.turn_deviation_m), key="following.turn_deviation_m"
        ),
        failed_part=Bias(size=failed_part, key="fault.kind"),
        drift=Growth(rate=drift, key="following.drift_rate_mps"),
        slowest=slowest,
    )


def drift_rate(
    scenario: Scenario, wind: WindField, turn: float, altitude_error: float = 0.0
) -> float:
    """Return the largest drift of dead reckoning without turbulence [m/s]; 0 where satellite
    navigation is not lost.

    Parameters
    ----------
    wind : mean wind of the flight
    turn : time of a turn away, for which the guard allows for an equal error of the velocity [s]
    altitude_error : by which the altitude may differ from its command [m]
    """
    if not scenario.follows or SATELLITES not in scenario.declared_faults:
        return 0.0
    outage, duration = _longest_outage(scenario), scenario.flight.duration_max_s
    # The wind may have changed before the loss, too, without the estimate following.
    changed = largest_wind_change(scenario, wind, outage + wind_followed(scenario), altitude_error)
    age = np.linspace(0.0, min(outage, duration), _AGES)
    covered = float(np.max(_by_gusts(scenario, age) / (age + turn)))
    # Biases of airspeed and heading are in the estimated wind, and count with the opposite sign
    # after the vehicle has turned.
    sensed = (
        _by_noise(scenario, age, turn)
        + 2.0 * wind_bias(scenario)
        + _CHANGING_TURNS * scenario.guidance.airspeed_mps
    )
    steady = max(scenario.following.drift_rate_mps, sensed)
    return steady + changed + _gust_taken_for_wind(scenario) + covered


def _longest_outage(scenario: Scenario) -> float:
    """Return the longest outage of satellite navigation among the faults that flights may have or
    that are declared [s].
    """
    return max(
        fault.satellite_navigation_s
        for number, fault in enumerate(scenario.faults)
        if SATELLITES in {*scenario.kinds_of_fault(number), *fault.declared}
    )


def _by_noise(scenario: Scenario, age: Array, turn: float) -> float:
    """Return the drift of dead reckoning by the noise of the sensors, after the estimate of the
    wind has converged [m/s].

    The wind has the error that its filter leaves. Independent errors of the readings add up to a
    random walk. And a noisy compass makes the mean velocity over the mean air too low by V (1 -
    exp(-sigma^2/2)): once in the wind, and once more, after half a turn, in dead reckoning with
    that wind.
    """
    noise, g = wind_noise(scenario), scenario.guidance
    walked = NOISE_DEVIATIONS * noise * np.sqrt(age / g.rate_hz)
    lowered = -g.airspeed_mps * math.expm1(
        -0.5 * math.radians(scenario.sensors.heading_sigma_deg) ** 2
    )
    return (
        NOISE_DEVIATIONS * wind_noise_left(scenario)
        + 2.0 * lowered
        + float(np.max(walked / (age + turn)))
    )


def velocity_error(scenario: Scenario, drift: float) -> float:
    """Return the largest error of the vehicle's own velocity at a step, by noise or bias of its
    sensors [m/s].

    The guard acts at each step, so that the step counts at which the noise makes a command look
    safe. Dead reckoning uses the readings of airspeed and heading; the guard allows for its drift
    separately.

    Parameters
    ----------
    drift : largest drift of dead reckoning, by ``drift_rate`` [m/s]
    """
    noise = NOISE_DEVIATIONS * math.hypot(
        scenario.sensors.velocity_sigma_mps, wind_noise_left(scenario)
    )
    read = NOISE_DEVIATIONS * wind_noise(scenario) - drift if drift else 0.0
    return max(noise, read, wind_bias(scenario))


def _gust_taken_for_wind(scenario: Scenario) -> float:
    """Return the largest part of a gust in the estimated wind at the gust's end [m/s]: its area is
    that of its peak over the time of its rise.
    """
    air = scenario.turbulence
    return air.gust_speed_mps * -float(np.expm1(-air.gust_length_s / WIND_FOLLOWED))


def _by_gusts(scenario: Scenario, age: Array) -> Array:
    """Return the largest displacement by gusts in an outage of some age [m]: by one about its peak,
    and by the gusts that follow one another.
    """
    air = scenario.turbulence
    about_the_peak = np.sin(np.minimum(0.5 * np.pi, 0.5 * np.pi * age / air.gust_length_s))
    return 0.5 * air.gust_speed_mps * (age + 2.0 * air.gust_length_s / np.pi * about_the_peak)
