"""How often the autopilot computes, and by how much that delays its loops."""

from aircraft.fdm import TIME_STEP

PERIODS = (1, 2, 3)
"""Time steps from one computation of the autopilot to the next, of which a design takes the longest
that its margins allow. All of them divide the steps that JSBSim runs while engines are started, so
that those change nothing.
"""


def loop_delay(period: int, late: int = 0) -> float:
    """Return the delay between measurement and servo [s]: one time step of computing, and half a
    period of hold.

    The step is an allowance for a computer on board. In JSBSim airspeed, sideslip and heading rate
    are one step old, but body rates, attitude, altitude and climb rate are read in the step in
    which servos and forces act: loops on these have more margin there than this delay says.

    Parameters
    ----------
    period : of the autopilot, as in ``PERIODS``
    late : whole periods by which its commands come later than that
    """
    return (1.0 + (0.5 + late) * period) * TIME_STEP
