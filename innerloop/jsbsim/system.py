"""The autopilot written out as a JSBSim ``<system>``.

The commands are ``AIRSPEED_COMMAND`` [m/s], ``ALTITUDE_COMMAND`` [m] and ``HEADING_RATE_COMMAND``
[rad/s].

A component costs JSBSim more than a table does, and some forty of them were a third of its time
step. So a value has one of its own only if it is read from outside, a state, looked up in a table,
or expensive to compute twice.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable

from aircraft.spec import ControlInput
from common.physics.units import METRES_PER_FOOT, STANDARD_GRAVITY
from innerloop.jsbsim.properties import (
    AIRSPEED_COMMAND,
    ALTITUDE_COMMAND,
    BANK_COMMAND,
    CONTROL_COMMAND,
    ELEVATOR_HELD,
    HEADING_RATE,
    HEADING_RATE_COMMAND,
    HELD_ELEVATOR,
    PERIOD,
    RESET,
    commanded_property,
    system_name,
)
from innerloop.jsbsim.xml import (
    channel,
    clipped,
    function,
    integrator,
    minus,
    number,
    operation,
    read,
    table_1d,
    table_2d,
    times,
    total,
    within,
)
from innerloop.law.control_law import bank_slopes
from innerloop.synthesis.gains import LATERAL, LONGITUDINAL, Gains
from innerloop.synthesis.schedule import Schedule

_AIRSPEED = "autopilot/airspeed-mps"
_SIDESLIP = "aero/beta-rad"
_CLIMB_RATE = "autopilot/climb-rate-mps"
_SCHEDULE = "autopilot/schedule-mps"
_MODEL_RATE = "autopilot/model-rate"
_MODEL_ACCELERATION = "autopilot/model-acceleration"
_MODEL_JERK = "autopilot/model-jerk"
_BANK_RATE = "autopilot/bank-rate-per-acceleration"
_ROLL = "attitude/phi-rad"


def system_xml(schedule: Schedule) -> str:
    """Return the autopilot as a JSBSim ``<system>`` document."""
    parts = {
        "Measurements": _measurements,
        "Airspeed and altitude": _longitudinal,
        "Heading rate": _lateral,
    }
    commands = "\n".join(
        f'<property value="{value:.9g}">{name}</property>'
        for name, value in (
            (AIRSPEED_COMMAND, schedule.airspeeds[schedule.middle]),
            (ALTITUDE_COMMAND, schedule.altitude),
            (HEADING_RATE_COMMAND, 0.0),
            (RESET, 0.0),
            (ELEVATOR_HELD, 0.0),
            (HELD_ELEVATOR, 0.0),
            (PERIOD, schedule.period),
        )
    )
    # The integrators of a channel that runs every few time steps integrate over as many.
    body = "\n".join(
        channel(name, schedule.period, components(schedule)) for name, components in parts.items()
    )
    document = ET.fromstring(
        f'<system name="{system_name(schedule.spec)}">\n{commands}\n{body}\n</system>'
    )
    ET.indent(document)
    note = "<!-- Written by innerloop.jsbsim.system; design it again rather than editing. -->"
    return f'<?xml version="1.0"?>\n{note}\n{ET.tostring(document, encoding="unicode")}\n'


def _by_point(schedule: Schedule, gain: Callable[[Gains], float]) -> str:
    """Return a gain over bank and commanded airspeed."""
    values = schedule.gain_over_bank([[float(gain(g)) for g in row] for row in schedule.gains])
    return table_2d(_ROLL, _SCHEDULE, schedule.gain_banks, schedule.airspeeds, values)


def _by_bank(schedule: Schedule, quantity: str, bank: str = _ROLL) -> str:
    """Turn compensation: a trim quantity over bank, by default the actual one, and commanded
    airspeed.
    """
    return table_2d(
        bank, _SCHEDULE, schedule.banks, schedule.airspeeds, schedule.over_bank(quantity)
    )


def _commanded(control_input: ControlInput, demand: str) -> list[str]:
    """Return components that keep a control within its range and pass it to JSBSim."""
    name = CONTROL_COMMAND.format(control_input.name)
    value = clipped(demand, control_input.lower, control_input.upper)
    if not control_input.effectiveness:
        return [function(name, value, control_input.commands)]
    effects, commands = zip(*control_input.effectiveness, strict=True)
    return [
        function(name, value),
        function(
            commanded_property(control_input),
            table_1d(name, effects, commands),
            control_input.commands,
        ),
    ]


def _measurements(schedule: Schedule) -> list[str]:
    envelope = schedule.envelope
    foot = number(METRES_PER_FOOT)
    sin_roll, cos_roll = (operation(f, read("attitude/phi-rad")) for f in ("sin", "cos"))
    sin_pitch, cos_pitch = (operation(f, read("attitude/theta-rad")) for f in ("sin", "cos"))

    def ahead(x: str, y: str, z: str) -> str:
        return total(
            times(x, cos_pitch), times(sin_pitch, total(times(y, sin_roll), times(z, cos_roll)))
        )

    def right(y: str, z: str) -> str:
        return minus(times(y, cos_roll), times(z, sin_roll))

    velocity = [read(f"velocities/{c}-aero-fps") for c in "uvw"]
    force = [read(f"forces/fb{c}-total-lbs") for c in "xyz"]
    speed_ahead, speed_right = read("autopilot/speed-ahead-fps"), read("autopilot/speed-right-fps")
    moment = minus(times(speed_ahead, right(*force[1:])), times(speed_right, ahead(*force)))
    inertia = times(
        read("inertia/mass-slugs"),
        operation(
            "max",
            total(times(speed_ahead, speed_ahead), times(speed_right, speed_right)),
            number(1.0),
        ),
    )
    return [
        # At least 1 m/s: JSBSim runs the system once without a speed, and integrators keep what a
        # division by zero gives.
        function(_AIRSPEED, operation("max", times(read("velocities/vt-fps"), foot), number(1.0))),
        function(_CLIMB_RATE, times(read("velocities/h-dot-fps"), foot)),
        function(
            _SCHEDULE, clipped(read(AIRSPEED_COMMAND), envelope.airspeed_min, envelope.airspeed_max)
        ),
        function("autopilot/speed-ahead-fps", ahead(*velocity)),
        function("autopilot/speed-right-fps", right(*velocity[1:])),
        # Rate of the horizontal air-relative course, from accelerometers and attitude
        # (state.course_rate).
        function(HEADING_RATE, operation("quotient", moment, inertia)),
    ]


def _longitudinal(schedule: Schedule) -> list[str]:
    weights = schedule.weights
    airspeed_error, altitude_error = "autopilot/airspeed-error-mps", "autopilot/altitude-error-m"
    altitude = times(read("position/h-sl-ft"), number(METRES_PER_FOOT))
    parts = [
        function(airspeed_error, minus(read(_SCHEDULE), read(_AIRSPEED))),
        function(altitude_error, minus(read(ALTITUDE_COMMAND), altitude)),
        function(
            "autopilot/pitch-error-rad",
            minus(_by_bank(schedule, "pitch"), read("attitude/theta-rad")),
        ),
        function(
            "autopilot/pitch-rate-error",
            minus(_by_bank(schedule, "q"), read("velocities/q-rad_sec")),
        ),
    ]
    errors = dict(
        zip(
            LONGITUDINAL,
            (
                clipped(
                    read(airspeed_error), -weights.airspeed_error_max, weights.airspeed_error_max
                ),
                times(number(-1.0), read(_CLIMB_RATE)),
                read("autopilot/pitch-rate-error"),
                read("autopilot/pitch-error-rad"),
                clipped(
                    read(altitude_error), -weights.altitude_error_max, weights.altitude_error_max
                ),
            ),
            strict=True,
        )
    )
    # A larger error demands a steady climb or acceleration; integrated on the way there, it would
    # overshoot by as much again. An altitude that still moves away is integrated beyond the limit,
    # too: its integral may be what takes it there, for ever.
    near = within(read(altitude_error), weights.altitude_error_max)
    leaving = operation("lt", times(read(altitude_error), read(_CLIMB_RATE)), number(0.0))
    integrated = (
        times(read(airspeed_error), within(read(airspeed_error), weights.airspeed_error_max)),
        times(errors["altitude"], operation("max", near, leaving)),
    )
    for row, name in ((0, "elevator"), (1, "throttle")):
        unlimited, integral, growth = (
            f"autopilot/{name}-{part}" for part in ("unlimited", "integral", "integral-rate")
        )
        feedback = [
            times(_by_point(schedule, lambda g, at=(row, j): g.longitudinal[at]), errors[state])  # type: ignore[misc]
            for j, state in enumerate(LONGITUDINAL)
        ]
        held = operation("ifthen", read(ELEVATOR_HELD), read(HELD_ELEVATOR), read(unlimited))
        parts += [
            # The integral of the last step enters here; back-calculation then holds it to what the
            # control can give.
            function(unlimited, total(_by_bank(schedule, name), read(integral), *feedback)),
            *_commanded(schedule.spec.input(name), held if name == "elevator" else read(unlimited)),
            function(
                growth,
                total(
                    *(
                        times(
                            _by_point(schedule, lambda g, at=(row, j): g.longitudinal_integral[at]),  # type: ignore[misc]
                            error,
                        )
                        for j, error in enumerate(integrated)
                    ),
                    times(
                        number(weights.anti_windup_rate),
                        minus(read(f"autopilot/{name}-command"), read(unlimited)),
                    ),
                ),
            ),
            integrator(integral, growth, RESET),
        ]
    return parts


def _lateral(schedule: Schedule) -> list[str]:
    parts = [*_heading_rate_model(schedule), *_bank_command(schedule)]
    roll_rate = times(read(_BANK_RATE), read(_MODEL_ACCELERATION))
    errors = {
        "p": minus(roll_rate, read("velocities/p-rad_sec")),
        "r": minus(_by_bank(schedule, "r"), read("velocities/r-rad_sec")),
        "roll": minus(read(BANK_COMMAND), read(_ROLL)),
    }
    rudder = "rudder" in schedule.controls
    if rudder:
        errors["beta"] = times(number(-1.0), read(_SIDESLIP))
    for row, name in enumerate(("aileron", "rudder") if rudder else ("aileron",)):
        feedback = [
            times(_by_point(schedule, lambda g, at=(row, j): g.lateral[at]), errors[state])  # type: ignore[misc]
            for j, state in enumerate(LATERAL)
            if state in errors
        ]
        ahead = [
            times(
                _by_point(schedule, lambda g, row=row: g.roll_rate_feedforward[row]),  # type: ignore[misc]
                roll_rate,
            ),
            times(
                _by_point(schedule, lambda g, row=row: g.roll_acceleration_feedforward[row]),  # type: ignore[misc]
                read(_BANK_RATE),
                read(_MODEL_JERK),
            ),
        ]
        integral = [read("autopilot/rudder-integral")] if name == "rudder" else []
        unlimited = f"autopilot/{name}-unlimited"
        parts += [
            function(
                unlimited,
                total(_by_bank(schedule, name, BANK_COMMAND), *integral, *feedback, *ahead),
            ),
            *_commanded(schedule.spec.input(name), read(unlimited)),
        ]
    return parts + (_rudder_integral(schedule) if rudder else [])


def _rudder_integral(schedule: Schedule) -> list[str]:
    """Return components that remove the remaining sideslip, within the limits of the rudder."""
    held = minus(read("autopilot/rudder-command"), read("autopilot/rudder-unlimited"))
    growth = total(
        times(_by_point(schedule, lambda g: g.sideslip_integral), read(_SIDESLIP)),
        times(number(schedule.weights.anti_windup_rate), held),
    )
    return [
        function("autopilot/rudder-integral-rate", growth),
        integrator("autopilot/rudder-integral", "autopilot/rudder-integral-rate", RESET),
    ]


def _heading_rate_model(schedule: Schedule) -> list[str]:
    """Return the heading-rate model that the aircraft follows."""
    frequency, damping = schedule.weights.model_frequency, schedule.weights.model_damping
    turn_max = math.tan(schedule.envelope.bank_max) * STANDARD_GRAVITY
    limited = operation(
        "max",
        operation(
            "min",
            read(HEADING_RATE_COMMAND),
            operation("quotient", number(turn_max), read(_AIRSPEED)),
        ),
        operation("quotient", number(-turn_max), read(_AIRSPEED)),
    )
    return [
        function(
            _MODEL_JERK,
            minus(
                times(number(frequency**2), minus(limited, read(_MODEL_RATE))),
                times(number(2.0 * damping * frequency), read(_MODEL_ACCELERATION)),
            ),
        ),
        integrator(_MODEL_ACCELERATION, _MODEL_JERK, RESET),
        integrator(_MODEL_RATE, _MODEL_ACCELERATION, RESET),
    ]


def _bank_command(schedule: Schedule) -> list[str]:
    """Return the bank of the model's turn, corrected by the integral of the heading-rate error."""
    bank_max = schedule.envelope.bank_max
    turns = schedule.turns()
    rate_to_bank_rate = times(
        operation("pow", operation("cos", read("autopilot/model-bank-rad")), number(2.0)),
        table_1d(_SCHEDULE, schedule.airspeeds, bank_slopes(schedule)),
        read(_AIRSPEED),
        number(1.0 / STANDARD_GRAVITY),
    )
    return [
        function(
            "autopilot/model-turn",
            times(read(_MODEL_RATE), read(_AIRSPEED), number(1.0 / STANDARD_GRAVITY)),
        ),
        function(
            "autopilot/model-bank-rad",
            table_2d(
                "autopilot/model-turn",
                _SCHEDULE,
                list(turns),
                schedule.airspeeds,
                schedule.bank_for_turn(turns),
            ),
        ),
        function(_BANK_RATE, rate_to_bank_rate),
        function(
            "autopilot/bank-unlimited-rad",
            total(read("autopilot/model-bank-rad"), read("autopilot/bank-integral")),
        ),
        function(BANK_COMMAND, clipped(read("autopilot/bank-unlimited-rad"), -bank_max, bank_max)),
        function(
            "autopilot/bank-integral-rate",
            total(
                times(
                    _by_point(schedule, lambda g: g.heading_integral),
                    minus(read(_MODEL_RATE), read(HEADING_RATE)),
                ),
                times(
                    number(schedule.weights.anti_windup_rate),
                    minus(read(BANK_COMMAND), read("autopilot/bank-unlimited-rad")),
                ),
            ),
        ),
        integrator("autopilot/bank-integral", "autopilot/bank-integral-rate", RESET),
    ]
