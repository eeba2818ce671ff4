"""JSBSim properties of the autopilot, and its name there."""

from aircraft.fdm import TIME_STEP
from aircraft.spec import AircraftSpec, ControlInput

AIRSPEED_COMMAND = "autopilot/airspeed-command-mps"
ALTITUDE_COMMAND = "autopilot/altitude-command-m"
HEADING_RATE_COMMAND = "autopilot/heading-rate-command-rad_sec"
HEADING_RATE = "autopilot/heading-rate-rad_sec"
BANK_COMMAND = "autopilot/bank-command-rad"
CONTROL_COMMAND = "autopilot/{}-command"
"""Pattern of the properties that hold the command of a control [-], by its name in the linear
model.
"""

RESET = "autopilot/reset"
"""Negative to hold every integrator at 0, otherwise 0."""

PERIOD = "autopilot/period-steps"
"""Time steps from one computation of the autopilot to the next."""

ELEVATOR_HELD, HELD_ELEVATOR = "autopilot/elevator-held", "autopilot/held-elevator"
"""1 to hold the elevator instead of flying with it, otherwise 0; and where to hold it [-]."""


def hold_steps(spec: AircraftSpec, period: int) -> int:
    """Return for how many time steps a body is held before its release, while servos and engines
    settle.

    These are whole periods of the autopilot, so that it computes in the last of them: what guidance
    and record read a whole number of periods later is of that very moment.

    Parameters
    ----------
    spec : the aircraft
    period : time steps from one computation of the autopilot to the next
    """
    settle = round(spec.settle_time / TIME_STEP)
    return settle + -settle % period


def system_name(spec: AircraftSpec) -> str:
    """Return the name of the aircraft's autopilot system."""
    return f"{spec.name}_autopilot"


def commanded_property(control_input: ControlInput) -> str:
    """Return the property of the command that the autopilot gives to JSBSim for a control input
    [-].
    """
    return (
        f"autopilot/{control_input.name}-surface-command"
        if control_input.effectiveness
        else CONTROL_COMMAND.format(control_input.name)
    )
