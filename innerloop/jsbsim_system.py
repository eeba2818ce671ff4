"""The autopilot written out as a JSBSim ``<system>``.

The commands are the properties ``AIRSPEED_COMMAND`` [m/s], ``ALTITUDE_COMMAND`` [m] and ``HEADING_RATE_COMMAND`` [rad/s].
"""

import math
import xml.etree.ElementTree as ET

import numpy as np

from aircraft.spec import AircraftSpec
from aircraft.units import METRES_PER_FOOT
from innerloop.controller import bank_slope
from innerloop.gains import LATERAL, LONGITUDINAL
from innerloop.jsbsim_xml import (
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
from innerloop.schedule import BANKS_DEG, STANDARD_GRAVITY, Schedule

AIRSPEED_COMMAND = "autopilot/airspeed-command-mps"
ALTITUDE_COMMAND = "autopilot/altitude-command-m"
HEADING_RATE_COMMAND = "autopilot/heading-rate-command-rad_sec"
HEADING_RATE = "autopilot/heading-rate-rad_sec"
BANK_COMMAND = "autopilot/bank-command-rad"
RESET = "autopilot/reset"
"""Negative to hold every integrator at 0, otherwise 0."""

_AIRSPEED = "autopilot/airspeed-mps"
_CLIMB_RATE = "autopilot/climb-rate-mps"
_SCHEDULE = "autopilot/schedule-mps"
_MODEL_RATE = "autopilot/model-rate"
_MODEL_ACCELERATION = "autopilot/model-acceleration"
_MODEL_JERK = "autopilot/model-jerk"
_TURNS_MAX = 1.4
_TURN_STEP = 0.1


def system_name(spec: AircraftSpec) -> str:
    """Return the name of the aircraft's autopilot system."""
    return f"{spec.name}_autopilot"


def system_xml(schedule: Schedule) -> str:
    """Return the autopilot as a JSBSim ``<system>`` document."""
    channels = {
        "Measurements": _measurements(schedule),
        "Airspeed and altitude": _longitudinal(schedule),
        "Heading rate": _lateral(schedule),
    }
    commands = "\n".join(
        f'<property value="{value:.9g}">{name}</property>'
        for name, value in (
            (AIRSPEED_COMMAND, schedule.airspeeds[len(schedule.airspeeds) // 2]),
            (ALTITUDE_COMMAND, schedule.altitude),
            (HEADING_RATE_COMMAND, 0.0),
            (RESET, 0.0),
        )
    )
    body = "\n".join(f'<channel name="{name}">\n' + "\n".join(components) + "\n</channel>" for name, components in channels.items())
    document = ET.fromstring(f'<system name="{system_name(schedule.spec)}">\n{commands}\n{body}\n</system>')
    ET.indent(document)
    note = "<!-- Written by innerloop.jsbsim_system; design it again rather than editing. -->"
    return f'<?xml version="1.0"?>\n{note}\n{ET.tostring(document, encoding="unicode")}\n'


def _by_airspeed(schedule: Schedule, values: list[float]) -> str:
    return table_1d(_SCHEDULE, schedule.airspeeds, values)


def _by_bank(schedule: Schedule, quantity: str) -> str:
    """Turn compensation: a trim quantity over the bank that is flown and the commanded airspeed."""
    rows = [math.radians(bank) for bank in BANKS_DEG]
    return table_2d("attitude/phi-rad", _SCHEDULE, rows, schedule.airspeeds, schedule.over_bank(quantity))


def _measurements(schedule: Schedule) -> list[str]:
    envelope = schedule.spec.envelope
    foot = number(METRES_PER_FOOT)
    sin_roll, cos_roll = (operation(f, read("attitude/phi-rad")) for f in ("sin", "cos"))
    sin_pitch, cos_pitch = (operation(f, read("attitude/theta-rad")) for f in ("sin", "cos"))

    def ahead(x: str, y: str, z: str) -> str:
        return total(times(x, cos_pitch), times(sin_pitch, total(times(y, sin_roll), times(z, cos_roll))))

    def right(y: str, z: str) -> str:
        return minus(times(y, cos_roll), times(z, sin_roll))

    velocity = [read(f"velocities/{c}-aero-fps") for c in "uvw"]
    force = [read(f"forces/fb{c}-total-lbs") for c in "xyz"]
    speed_ahead, speed_right = read("autopilot/speed-ahead-fps"), read("autopilot/speed-right-fps")
    moment = minus(times(speed_ahead, right(*force[1:])), times(speed_right, ahead(*force)))
    inertia = times(
        read("inertia/mass-slugs"),
        operation("max", total(times(speed_ahead, speed_ahead), times(speed_right, speed_right)), number(1.0)),
    )
    return [
        # At least 1 m/s: JSBSim runs the system once before it has a speed, and an integrator never forgets a division by zero.
        function(_AIRSPEED, operation("max", times(read("velocities/vt-fps"), foot), number(1.0))),
        function(_CLIMB_RATE, times(read("velocities/h-dot-fps"), foot)),
        function(_SCHEDULE, clipped(read(AIRSPEED_COMMAND), envelope.airspeed_min, envelope.airspeed_max)),
        function("autopilot/speed-ahead-fps", ahead(*velocity)),
        function("autopilot/speed-right-fps", right(*velocity[1:])),
        # Rate of the horizontal air-relative course, from accelerometers and attitude (aircraft.state.course_rate).
        function(HEADING_RATE, operation("quotient", moment, inertia)),
    ]


def _longitudinal(schedule: Schedule) -> list[str]:
    weights = schedule.weights
    airspeed_error, altitude_error = "autopilot/airspeed-error-mps", "autopilot/altitude-error-m"
    altitude = times(read("position/h-sl-ft"), number(METRES_PER_FOOT))
    parts = [
        *_limited_error(airspeed_error, minus(read(_SCHEDULE), read(_AIRSPEED)), weights.airspeed_error_max),
        *_limited_error(altitude_error, minus(read(ALTITUDE_COMMAND), altitude), weights.altitude_error_max),
        function("autopilot/pitch-error-rad", minus(_by_bank(schedule, "pitch"), read("attitude/theta-rad"))),
        function("autopilot/pitch-rate-error", minus(_by_bank(schedule, "q"), read("velocities/q-rad_sec"))),
    ]
    errors = dict(
        zip(
            LONGITUDINAL,
            (
                read(airspeed_error),
                times(number(-1.0), read(_CLIMB_RATE)),
                read("autopilot/pitch-rate-error"),
                read("autopilot/pitch-error-rad"),
                read(altitude_error),
            ),
            strict=True,
        )
    )
    for row, name in ((0, "elevator"), (1, "throttle")):
        limits = schedule.spec.input(name)
        unlimited, integral, growth = (f"autopilot/{name}-{part}" for part in ("unlimited", "integral", "integral-rate"))
        feedback = [
            times(_by_airspeed(schedule, [float(g.longitudinal[row, j]) for g in schedule.gains]), errors[state])
            for j, state in enumerate(LONGITUDINAL)
        ]
        parts += [
            # The integral of the last step enters here; back-calculation then holds it to what the control can give.
            function(unlimited, total(_by_bank(schedule, name), read(integral), *feedback)),
            function(f"autopilot/{name}-command", clipped(read(unlimited), limits.lower, limits.upper), output=limits.command),
            function(
                growth,
                total(
                    times(
                        _by_airspeed(schedule, [float(g.longitudinal_integral[row, 0]) for g in schedule.gains]),
                        read(f"{airspeed_error}-integrated"),
                    ),
                    times(
                        _by_airspeed(schedule, [float(g.longitudinal_integral[row, 1]) for g in schedule.gains]),
                        read(f"{altitude_error}-integrated"),
                    ),
                    times(number(weights.anti_windup_rate), minus(read(f"autopilot/{name}-command"), read(unlimited))),
                ),
            ),
            integrator(integral, growth, RESET),
        ]
    return parts


def _limited_error(name: str, error: str, limit: float) -> list[str]:
    """Return components for an error kept within ``limit``, and for the error that is integrated: none beyond the limit.

    A larger error asks for a steady climb or acceleration; integrated on the way there, it would overshoot by as much again.
    """
    return [
        function(f"{name}-whole", error),
        function(name, clipped(read(f"{name}-whole"), -limit, limit)),
        function(f"{name}-integrated", times(read(f"{name}-whole"), within(read(f"{name}-whole"), limit))),
    ]


def _lateral(schedule: Schedule) -> list[str]:
    weights, spec = schedule.weights, schedule.spec
    frequency, damping = weights.model_frequency, weights.model_damping
    bank_max = spec.envelope.bank_max
    turns = np.arange(-_TURNS_MAX, _TURNS_MAX + 0.5 * _TURN_STEP, _TURN_STEP)
    slopes = [bank_slope(schedule, i) for i in range(len(schedule.airspeeds))]
    gains = schedule.gains
    aileron = spec.input("aileron")
    errors = dict(
        zip(
            LATERAL,
            (
                minus(read("autopilot/model-roll-rate"), read("velocities/p-rad_sec")),
                minus(_by_bank(schedule, "r"), read("velocities/r-rad_sec")),
                minus(read(BANK_COMMAND), read("attitude/phi-rad")),
            ),
            strict=True,
        )
    )
    rate_to_bank_rate = times(
        operation("pow", operation("cos", read("autopilot/model-bank-rad")), number(2.0)),
        _by_airspeed(schedule, slopes),
        read(_AIRSPEED),
        number(1.0 / STANDARD_GRAVITY),
    )
    turn_max = math.tan(bank_max) * STANDARD_GRAVITY
    return [
        # The heading-rate response that the aircraft is made to follow.
        function(
            "autopilot/heading-rate-limited",
            operation(
                "max",
                operation("min", read(HEADING_RATE_COMMAND), operation("quotient", number(turn_max), read(_AIRSPEED))),
                operation("quotient", number(-turn_max), read(_AIRSPEED)),
            ),
        ),
        function(
            _MODEL_JERK,
            minus(
                times(number(frequency**2), minus(read("autopilot/heading-rate-limited"), read(_MODEL_RATE))),
                times(number(2.0 * damping * frequency), read(_MODEL_ACCELERATION)),
            ),
        ),
        integrator(_MODEL_ACCELERATION, _MODEL_JERK, RESET),
        integrator(_MODEL_RATE, _MODEL_ACCELERATION, RESET),
        function("autopilot/model-turn", times(read(_MODEL_RATE), read(_AIRSPEED), number(1.0 / STANDARD_GRAVITY))),
        function(
            "autopilot/model-bank-rad",
            table_2d("autopilot/model-turn", _SCHEDULE, list(turns), schedule.airspeeds, schedule.bank_for_turn(turns)),
        ),
        function("autopilot/bank-rate-per-acceleration", rate_to_bank_rate),
        function("autopilot/model-roll-rate", times(read("autopilot/bank-rate-per-acceleration"), read(_MODEL_ACCELERATION))),
        function("autopilot/bank-unlimited-rad", total(read("autopilot/model-bank-rad"), read("autopilot/bank-integral"))),
        function(BANK_COMMAND, clipped(read("autopilot/bank-unlimited-rad"), -bank_max, bank_max)),
        function(
            "autopilot/bank-integral-rate",
            total(
                times(_by_airspeed(schedule, [g.heading_integral for g in gains]), minus(read(_MODEL_RATE), read(HEADING_RATE))),
                times(number(weights.anti_windup_rate), minus(read(BANK_COMMAND), read("autopilot/bank-unlimited-rad"))),
            ),
        ),
        integrator("autopilot/bank-integral", "autopilot/bank-integral-rate", RESET),
        function(
            "autopilot/aileron-command",
            clipped(
                total(
                    table_2d(
                        BANK_COMMAND,
                        _SCHEDULE,
                        [math.radians(bank) for bank in BANKS_DEG],
                        schedule.airspeeds,
                        schedule.over_bank("aileron"),
                    ),
                    *(
                        times(_by_airspeed(schedule, [float(g.lateral[j]) for g in gains]), errors[state])
                        for j, state in enumerate(LATERAL)
                    ),
                    times(_by_airspeed(schedule, [g.roll_rate_feedforward for g in gains]), read("autopilot/model-roll-rate")),
                    times(
                        _by_airspeed(schedule, [g.roll_acceleration_feedforward for g in gains]),
                        read("autopilot/bank-rate-per-acceleration"),
                        read(_MODEL_JERK),
                    ),
                ),
                aileron.lower,
                aileron.upper,
            ),
            output=aileron.command,
        ),
    ]
