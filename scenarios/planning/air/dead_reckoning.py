"""How far dead reckoning goes wrong in air that changes: while satellites are lost, the wind is taken to be as it was before.

By how much it may go wrong in steady air, by errors of sensors and of the estimated wind, is declared. Here is what the scenario's
own air adds: of its mean wind, of its gusts, and of its turbulence. Noise, which is another at each step, counts beside.
"""

import math

import numpy as np
import numpy.typing as npt

from aircraft.atmosphere.turbulence import TURBULENCE, intensities, scale_lengths
from aircraft.atmosphere.wind import WindField
from scenarios.planning.air.estimated_wind import WIND_FOLLOWED, largest_wind_change, wind_followed
from scenarios.schema.scenario import Scenario
from scenarios.world.faults import SATELLITES

Array = npt.NDArray[np.float64]

_NOISE_DEVIATIONS = 3.0
"""Standard deviations of the noise of velocities that are allowed for [-]."""

_NOISE_OF_WIND = 0.12
"""What the wind's filter leaves of the noise of a single measurement [-]: sqrt(k/2) of its gain k = 0.028 in still air."""

_DEVIATIONS = 3.0
"""Standard deviations of what turbulence displaces that are allowed for [-]."""

_AGES = 200
"""Ages of an outage at which that is looked at [-]."""


def drift_rate(scenario: Scenario, wind: WindField, turn: float) -> float:
    """Return how fast dead reckoning may go wrong [m/s]; 0 where satellite navigation is not lost.

    Parameters
    ----------
    wind : mean wind of the flight
    turn : time of a turn away, over which the guard reckons with an error of the velocity as large [s]
    """
    if not scenario.follows or SATELLITES not in scenario.declared_faults:
        return 0.0
    outage, duration = scenario.fault.satellite_navigation_s, scenario.flight.duration_max_s
    # The wind may have changed before the loss, too, and its estimate not have followed.
    changed = largest_wind_change(scenario, wind, outage + wind_followed(scenario))
    age = np.linspace(0.0, min(outage, duration), _AGES)
    covered = float(np.max((_by_gusts(scenario, age) + _by_turbulence(scenario, age)) / (age + turn)))
    return scenario.following.drift_rate_mps + changed + _gust_taken_for_wind(scenario) + covered


def velocity_noise(scenario: Scenario, drift: float) -> float:
    """Return by how much the noise of its sensors may make the vehicle's own velocity wrong at a step [m/s].

    The guard is asked at each step, and goes by the one at which the noise makes a command look safe. Dead reckoning goes by
    airspeed and heading as they are read; the guard reckons with its drift beside.

    Parameters
    ----------
    drift : how fast dead reckoning may go wrong, by ``drift_rate`` [m/s]
    """
    sensors = scenario.sensors
    by_wind = math.hypot(sensors.airspeed_sigma_mps, scenario.guidance.airspeed_mps * math.radians(sensors.heading_sigma_deg))
    noise = _NOISE_DEVIATIONS * math.hypot(sensors.velocity_sigma_mps, _NOISE_OF_WIND * by_wind)
    return max(noise, _NOISE_DEVIATIONS * by_wind - drift) if drift else noise


def _gust_taken_for_wind(scenario: Scenario) -> float:
    """Return how much of a gust may be in the estimated wind when it is over [m/s]: it has the area of its peak for its rise."""
    air = scenario.turbulence
    return air.gust_speed_mps * -float(np.expm1(-air.gust_length_s / WIND_FOLLOWED))


def _by_gusts(scenario: Scenario, age: Array) -> Array:
    """Return how far gusts displace at most in an outage of some age [m]: one about its peak, and one after the other."""
    air = scenario.turbulence
    about_the_peak = np.sin(np.minimum(0.5 * np.pi, 0.5 * np.pi * age / air.gust_length_s))
    return 0.5 * air.gust_speed_mps * (age + 2.0 * air.gust_length_s / np.pi * about_the_peak)


def _by_turbulence(scenario: Scenario, age: Array) -> Array:
    """Return what turbulence displaces by in an outage of some age [m].

    A component of an exponential correlation, of deviation sigma and time T = L/V, displaces by a deviation of
    sigma sqrt(2 T (t - T (1 - exp(-t/T)))) in a time t (Taylor, "Diffusion by Continuous Movements", 1922).
    """
    if scenario.turbulence.level == "none":
        return np.zeros_like(age)
    sigma = intensities(scenario.altitude, TURBULENCE[scenario.turbulence.level].wind_at_20ft)[0]
    correlated = scale_lengths(scenario.altitude)[0] / scenario.guidance.airspeed_mps
    lasting = np.maximum(0.0, age + correlated * np.expm1(-age / correlated))
    displaced: Array = _DEVIATIONS * sigma * np.sqrt(2.0 * correlated * lasting)
    return displaced
