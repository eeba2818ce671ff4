"""JSBSim's properties that place, hold, start and read an aircraft, and what is written to them."""

import functools
from dataclasses import replace

from aircraft.simulation.state import RigidBodyState
from common.physics.units import METRES_PER_FOOT

CLOCK = "simulation/sim-time-sec"
"""Time since the aircraft was placed last [s]."""

EARTH_RATE = 7.292115e-5
"""Rotation rate of the earth, as in JSBSim's default planet [rad/s]."""

INTEGRATORS = tuple(
    f"simulation/integrator/{kind}/{motion}"
    for kind in ("rate", "position")
    for motion in ("rotational", "translational")
)
"""Properties that choose how the rigid body is integrated; 0 in all four holds it still."""

INITIAL_STATE = (
    "ic/lat-geod-rad", "ic/long-gc-rad", "ic/h-sl-ft", "ic/phi-rad", "ic/theta-rad", "ic/psi-true-rad", "ic/u-fps", "ic/v-fps",
    "ic/w-fps", "ic/p-rad_sec", "ic/q-rad_sec", "ic/r-rad_sec",
)  # fmt: skip
"""JSBSim's initial conditions, in the order in which they must be set: each may change others."""

ACCELERATION = "accelerations/{}dot-ft_sec2"
ANGULAR_ACCELERATION = "accelerations/{}dot-rad_sec2"

WIND = ("atmosphere/wind-north-fps", "atmosphere/wind-east-fps", "atmosphere/wind-down-fps")
"""Properties of the steady wind: the velocity of the air."""

NORTH_WIND_MIN = 1e-6
"""Least wind northward [ft/s]: JSBSim does not turn its turbulence into the wind if the wind is 0.
"""

RESET_ONLY = 2
"""Resets every model of JSBSim to how it was loaded, without running it."""

START_ENGINES = (("propulsion/set-running", -1.0),)
"""Property that starts every engine at once, where JSBSim can."""

CRANK = (("propulsion/magneto_cmd", 3.0), ("propulsion/starter_cmd", 1.0))

STOP_CRANKING = (("propulsion/starter_cmd", 0.0),)
"""Properties that start an engine as a pilot does: both magnetos, and the starter."""

RUN_UP_STEPS = 1200
"""Time steps for cranking, where that is needed, and as many for running up before an aircraft is
placed.
"""


def initial_conditions(state: RigidBodyState) -> list[tuple[str, float]]:
    """Return the properties, and their values in JSBSim's units, that set an initial state.

    The order matters to the last digit: JSBSim works each one into those before it.
    """
    u, v, w = (speed / METRES_PER_FOOT for speed in state.velocity_body)
    values = (
        state.latitude,
        state.longitude,
        state.altitude / METRES_PER_FOOT,
        state.roll,
        state.pitch,
        state.yaw,
        u,
        v,
        w,
        *state.rates_body,
    )
    return list(zip(INITIAL_STATE, values, strict=True))


def before_hold(state: RigidBodyState, duration: float) -> RigidBodyState:
    """Return where to place a body that is to be in ``state`` after it was held for ``duration``
    [s].

    A held body stays fixed in inertial space while the earth turns under it, so it is placed as far
    east as it will drift west.
    """
    return replace(state, longitude=state.longitude + EARTH_RATE * duration)


@functools.cache
def component_names(pattern: str, components: str) -> tuple[str, ...]:
    """Return a vector's properties: ``pattern`` with each of its components, as in "uvw", put in."""
    return tuple(pattern.format(component) for component in components)
