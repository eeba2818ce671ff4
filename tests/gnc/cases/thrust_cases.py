"""A simple aircraft for tests of its thrust."""

import math

from gnc.estimation.thrust import ThrustModel, ThrustParameters

AIRSPEED = 20.0
SPOOL_TIME = 2.0

MODEL = ThrustModel(
    airspeeds=(10.0, 30.0),
    throttles=(0.0, 1.0),
    thrust=((0.0, 0.5), (0.0, 0.3)),
    attack=(-0.03, 20.0),
    polar=(2e-4, 0.0, 8.0),
    spool_time=SPOOL_TIME,
)

LEVEL = MODEL.drag(AIRSPEED, 1.0)
"""Thrust of level flight over the weight: 0.08 + 0.02 [-]."""

PARAMETERS = ThrustParameters(
    model=MODEL, level=LEVEL, slow_airspeed=17.0, energy_height=AIRSPEED * 0.5 * LEVEL
)
"""Thrust of level flight counts as lost when it has been missing for a second."""


def accelerations(thrust, airspeed=AIRSPEED):
    """Return what accelerometers measure along and across the axis at a thrust, at an upward
    acceleration of 1 g.
    """
    attack = MODEL.angle_of_attack(airspeed, 1.0)
    along = thrust - MODEL.drag(airspeed, 1.0)
    return (along + math.sin(attack)) / math.cos(attack), 1.0
