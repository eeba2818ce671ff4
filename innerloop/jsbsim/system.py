"""Write the autopilot as a JSBSim ``<system>``, and a JSBSim root that flies it.

The commands are ``AIRSPEED_COMMAND`` [m/s], ``ALTITUDE_COMMAND`` [m] and ``HEADING_RATE_COMMAND``
[rad/s].

Components take JSBSim more time than tables: forty components take a third of a time step. A value
is a component only if it is read from outside, is a state, is looked up in a table, or is expensive
to compute twice.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP
from aircraft.model import copy_model, insert_before_flight_control, read_xml, write_xml
from aircraft.spec import AircraftSpec, ControlInput
from common.physics import METRES_PER_FOOT, STANDARD_GRAVITY
from innerloop.law import bank_slopes
from innerloop.schedule import LATERAL, LONGITUDINAL, Schedule

AIRSPEED_COMMAND = "autopilot/airspeed-command-mps"
ALTITUDE_COMMAND = "autopilot/altitude-command-m"
HEADING_RATE_COMMAND = "autopilot/heading-rate-command-rad_sec"
HEADING_RATE = "autopilot/heading-rate-rad_sec"
BANK_COMMAND = "autopilot/bank-command-rad"
CONTROL_COMMAND = "autopilot/{}-command"
"""Pattern of the property with the command of a control [-]; the name is the linear model's."""

RESET = "autopilot/reset"
"""Property that is negative to hold every integrator at 0, otherwise 0."""

PERIOD = "autopilot/period-steps"
"""Property with the number of time steps between computations of the autopilot."""

ELEVATOR_HELD = "autopilot/elevator-held"
"""Property that is 1 to hold the elevator instead of controlling it, otherwise 0."""

HELD_ELEVATOR = "autopilot/held-elevator"
"""Property with the command at which the elevator is held [-]."""

_AIRSPEED = "autopilot/airspeed-mps"
_SIDESLIP = "aero/beta-rad"
_CLIMB_RATE = "autopilot/climb-rate-mps"
_SCHEDULE = "autopilot/schedule-mps"
_MODEL_RATE = "autopilot/model-rate"
_MODEL_ACCELERATION = "autopilot/model-acceleration"
_MODEL_JERK = "autopilot/model-jerk"
_BANK_RATE = "autopilot/bank-rate-per-acceleration"
_ROLL = "attitude/phi-rad"
_PITCH = "attitude/theta-rad"
_SPEED_AHEAD = "autopilot/speed-ahead-fps"
_SPEED_RIGHT = "autopilot/speed-right-fps"

Array = npt.NDArray[np.float64]


def hold_steps(spec: AircraftSpec, period: int) -> int:
    """Return the number of time steps for which a body is held before its release.

    Servos and engines settle in this time. It is a whole number of the autopilot's periods [time
    steps], so the autopilot computes in the last step. Guidance and record then read new values,
    because they follow whole periods later.
    """
    settle = round(spec.settle_time / TIME_STEP)
    return settle + -settle % period


def system_name(spec: AircraftSpec) -> str:
    """Return the name of the aircraft's autopilot system."""
    return f"{spec.name}_autopilot"


def commanded_property(control_input: ControlInput) -> str:
    """Return the property with the command that the autopilot gives JSBSim for a control [-]."""
    if control_input.effectiveness:
        return f"autopilot/{control_input.name}-surface-command"
    return CONTROL_COMMAND.format(control_input.name)


def write_root(schedule: Schedule, directory: Path) -> Path:
    """Write a JSBSim root with a copy of the aircraft, its engines and the autopilot; return it.

    Every JSBSim program flies the aircraft under the autopilot from this root. The model's own
    outputs and autopilot are left out (``aircraft.model``); its servos keep their play.
    """
    spec = schedule.spec
    model_file = copy_model(spec.files, directory)
    model = read_xml(model_file)
    systems = directory / "systems"
    systems.mkdir(exist_ok=True)
    (systems / f"{system_name(spec)}.xml").write_text(system_xml(schedule), encoding="utf-8")
    insert_before_flight_control(model.getroot(), ET.Element("system", file=system_name(spec)))
    write_xml(model, model_file)
    return directory


def system_xml(schedule: Schedule) -> str:
    """Return the autopilot as a JSBSim ``<system>`` document."""
    initial = {
        AIRSPEED_COMMAND: schedule.airspeeds[schedule.middle],
        ALTITUDE_COMMAND: schedule.altitude,
        HEADING_RATE_COMMAND: 0.0,
        RESET: 0.0,
        ELEVATOR_HELD: 0.0,
        HELD_ELEVATOR: 0.0,
        PERIOD: schedule.period,
    }
    properties = "\n".join(
        f'<property value="{value:.9g}">{name}</property>' for name, value in initial.items()
    )
    channels = {
        "Measurements": _measurements(schedule),
        "Airspeed and altitude": _longitudinal(schedule),
        "Heading rate": _lateral(schedule),
    }
    # In a channel that runs every few time steps, integrators use that longer step.
    body = "\n".join(
        channel(name, schedule.period, components) for name, components in channels.items()
    )
    document = ET.fromstring(
        f'<system name="{system_name(schedule.spec)}">\n{properties}\n{body}\n</system>'
    )
    ET.indent(document)
    note = "<!-- Written by innerloop.jsbsim.system; design it again rather than editing. -->"
    return f'<?xml version="1.0"?>\n{note}\n{ET.tostring(document, encoding="unicode")}\n'


def _measurements(schedule: Schedule) -> list[str]:
    envelope = schedule.envelope
    foot = number(METRES_PER_FOOT)
    sin_roll, cos_roll = (operation(f, read(_ROLL)) for f in ("sin", "cos"))
    sin_pitch, cos_pitch = (operation(f, read(_PITCH)) for f in ("sin", "cos"))

    def ahead(x: str, y: str, z: str) -> str:
        return total(
            times(x, cos_pitch), times(sin_pitch, total(times(y, sin_roll), times(z, cos_roll)))
        )

    def right(y: str, z: str) -> str:
        return minus(times(y, cos_roll), times(z, sin_roll))

    velocity = [read(f"velocities/{c}-aero-fps") for c in "uvw"]
    force = [read(f"forces/fb{c}-total-lbs") for c in "xyz"]
    speed_ahead, speed_right = read(_SPEED_AHEAD), read(_SPEED_RIGHT)
    moment = minus(times(speed_ahead, right(*force[1:])), times(speed_right, ahead(*force)))
    speed_squared = total(times(speed_ahead, speed_ahead), times(speed_right, speed_right))
    inertia = times(read("inertia/mass-slugs"), operation("max", speed_squared, number(1.0)))
    # At least 1 m/s: JSBSim runs the system once at speed 0, and integrators would keep the result
    # of a division by zero.
    airspeed = operation("max", times(read("velocities/vt-fps"), foot), number(1.0))
    return [
        function(_AIRSPEED, airspeed),
        function(_CLIMB_RATE, times(read("velocities/h-dot-fps"), foot)),
        function(
            _SCHEDULE, clipped(read(AIRSPEED_COMMAND), envelope.airspeed_min, envelope.airspeed_max)
        ),
        function(_SPEED_AHEAD, ahead(*velocity)),
        function(_SPEED_RIGHT, right(*velocity[1:])),
        # Rate of the horizontal air-relative course, from accelerometers and attitude
        # (aircraft.state.course_rate).
        function(HEADING_RATE, operation("quotient", moment, inertia)),
    ]


def _longitudinal(schedule: Schedule) -> list[str]:
    weights = schedule.weights
    airspeed_error = "autopilot/airspeed-error-mps"
    altitude_error = "autopilot/altitude-error-m"
    pitch_error = "autopilot/pitch-error-rad"
    pitch_rate_error = "autopilot/pitch-rate-error"
    altitude = times(read("position/h-sl-ft"), number(METRES_PER_FOOT))
    components = [
        function(airspeed_error, minus(read(_SCHEDULE), read(_AIRSPEED))),
        function(altitude_error, minus(read(ALTITUDE_COMMAND), altitude)),
        function(pitch_error, minus(_trim_table(schedule, "pitch"), read(_PITCH))),
        function(pitch_rate_error, minus(_trim_table(schedule, "q"), read("velocities/q-rad_sec"))),
    ]
    errors = {
        "airspeed": clipped(
            read(airspeed_error), -weights.airspeed_error_max, weights.airspeed_error_max
        ),
        "climb_rate": times(number(-1.0), read(_CLIMB_RATE)),
        "q": read(pitch_rate_error),
        "pitch": read(pitch_error),
        "altitude": clipped(
            read(altitude_error), -weights.altitude_error_max, weights.altitude_error_max
        ),
    }
    # A larger error demands a steady climb or acceleration; integrating it meanwhile would cause an
    # overshoot. A growing altitude error is integrated beyond the limit as well, because the
    # integral itself may be the cause of its growth.
    near = within(read(altitude_error), weights.altitude_error_max)
    leaving = operation("lt", times(read(altitude_error), read(_CLIMB_RATE)), number(0.0))
    integrated = (
        times(read(airspeed_error), within(read(airspeed_error), weights.airspeed_error_max)),
        times(errors["altitude"], operation("max", near, leaving)),
    )
    for row, name in enumerate(("elevator", "throttle")):
        unlimited = f"autopilot/{name}-unlimited"
        feedback = [
            times(_gain_table(schedule, "longitudinal", row, j), errors[state])
            for j, state in enumerate(LONGITUDINAL)
        ]
        growth = [
            times(_gain_table(schedule, "longitudinal_integral", row, j), error)
            for j, error in enumerate(integrated)
        ]
        demand = read(unlimited)
        if name == "elevator":
            demand = operation("ifthen", read(ELEVATOR_HELD), read(HELD_ELEVATOR), demand)
        components += [
            # This uses the integral of the last step.
            function(
                unlimited,
                total(_trim_table(schedule, name), read(f"autopilot/{name}-integral"), *feedback),
            ),
            *_control(schedule.spec.input(name), demand),
            *_integral(schedule, name, CONTROL_COMMAND.format(name), unlimited, growth),
        ]
    return components


def _lateral(schedule: Schedule) -> list[str]:
    components = [*_heading_rate_model(schedule), *_bank_command(schedule)]
    roll_rate = times(read(_BANK_RATE), read(_MODEL_ACCELERATION))
    errors = {
        "p": minus(roll_rate, read("velocities/p-rad_sec")),
        "r": minus(_trim_table(schedule, "r"), read("velocities/r-rad_sec")),
        "roll": minus(read(BANK_COMMAND), read(_ROLL)),
    }
    controls = ["aileron"]
    if "rudder" in schedule.controls:
        controls.append("rudder")
        errors["beta"] = times(number(-1.0), read(_SIDESLIP))
    for row, name in enumerate(controls):
        feedback = [
            times(_gain_table(schedule, "lateral", row, j), errors[state])
            for j, state in enumerate(LATERAL)
            if state in errors
        ]
        ahead = [
            times(_gain_table(schedule, "roll_rate_feedforward", row), roll_rate),
            times(
                _gain_table(schedule, "roll_acceleration_feedforward", row),
                read(_BANK_RATE),
                read(_MODEL_JERK),
            ),
        ]
        integral = [read("autopilot/rudder-integral")] if name == "rudder" else []
        trim = _trim_table(schedule, name, BANK_COMMAND)
        unlimited = f"autopilot/{name}-unlimited"
        components += [
            function(unlimited, total(trim, *integral, *feedback, *ahead)),
            *_control(schedule.spec.input(name), read(unlimited)),
        ]
        if name == "rudder":
            # The integral removes the remaining sideslip.
            growth = [times(_gain_table(schedule, "sideslip_integral"), read(_SIDESLIP))]
            command = CONTROL_COMMAND.format(name)
            components += _integral(schedule, name, command, unlimited, growth)
    return components


def _integral(
    schedule: Schedule, name: str, command: str, unlimited: str, growth: Sequence[str]
) -> list[str]:
    """Return an integral with back-calculation, which limits it while the command saturates."""
    rate = f"autopilot/{name}-integral-rate"
    held = times(number(schedule.weights.anti_windup_rate), minus(read(command), read(unlimited)))
    return [function(rate, total(*growth, held)), integrator(f"autopilot/{name}-integral", rate)]


def _heading_rate_model(schedule: Schedule) -> list[str]:
    """Return the heading-rate model that the aircraft follows."""
    frequency, damping = schedule.weights.model_frequency, schedule.weights.model_damping
    turn_max = math.tan(schedule.envelope.bank_max) * STANDARD_GRAVITY
    rate_max = operation("quotient", number(turn_max), read(_AIRSPEED))
    rate_min = operation("quotient", number(-turn_max), read(_AIRSPEED))
    limited = operation("max", operation("min", read(HEADING_RATE_COMMAND), rate_max), rate_min)
    jerk = minus(
        times(number(frequency**2), minus(limited, read(_MODEL_RATE))),
        times(number(2.0 * damping * frequency), read(_MODEL_ACCELERATION)),
    )
    return [
        function(_MODEL_JERK, jerk),
        integrator(_MODEL_ACCELERATION, _MODEL_JERK),
        integrator(_MODEL_RATE, _MODEL_ACCELERATION),
    ]


def _bank_command(schedule: Schedule) -> list[str]:
    """Return the bank of the model's turn plus the integral of the heading-rate error."""
    bank_max = schedule.envelope.bank_max
    turns = schedule.turns()
    model_turn, model_bank = "autopilot/model-turn", "autopilot/model-bank-rad"
    unlimited = "autopilot/bank-unlimited-rad"
    by_gravity = number(1.0 / STANDARD_GRAVITY)
    banks = schedule.bank_for_turn(turns)
    rate_to_bank_rate = times(
        operation("pow", operation("cos", read(model_bank)), number(2.0)),
        table_1d(_SCHEDULE, schedule.airspeeds, bank_slopes(schedule)),
        read(_AIRSPEED),
        by_gravity,
    )
    error = minus(read(_MODEL_RATE), read(HEADING_RATE))
    growth = [times(_gain_table(schedule, "heading_integral"), error)]
    return [
        function(model_turn, times(read(_MODEL_RATE), read(_AIRSPEED), by_gravity)),
        function(
            model_bank, table_2d(model_turn, _SCHEDULE, list(turns), schedule.airspeeds, banks)
        ),
        function(_BANK_RATE, rate_to_bank_rate),
        function(unlimited, total(read(model_bank), read("autopilot/bank-integral"))),
        function(BANK_COMMAND, clipped(read(unlimited), -bank_max, bank_max)),
        *_integral(schedule, "bank", BANK_COMMAND, unlimited, growth),
    ]


def _control(control_input: ControlInput, demand: str) -> list[str]:
    """Return components that limit a control to its range and pass the command to JSBSim."""
    name = CONTROL_COMMAND.format(control_input.name)
    value = clipped(demand, control_input.lower, control_input.upper)
    if not control_input.effectiveness:
        return [function(name, value, control_input.commands)]
    effects, commands = zip(*control_input.effectiveness, strict=True)
    surface = commanded_property(control_input)
    return [
        function(name, value),
        function(surface, table_1d(name, effects, commands), control_input.commands),
    ]


def _gain_table(schedule: Schedule, name: str, *index: int) -> str:
    """Return the table of one entry of the ``Gains`` over bank and commanded airspeed."""
    values = [
        [float(np.asarray(getattr(gains, name))[index]) for gains in row] for row in schedule.gains
    ]
    return table_2d(_ROLL, _SCHEDULE, schedule.gain_banks, schedule.airspeeds, np.array(values).T)


def _trim_table(schedule: Schedule, quantity: str, bank: str = _ROLL) -> str:
    """Return the table of a trim quantity over bank (by default actual) and commanded airspeed."""
    values = schedule.over_bank(quantity)
    return table_2d(bank, _SCHEDULE, schedule.banks, schedule.airspeeds, values)


# Helpers that write JSBSim's XML: expressions, tables and components.


def number(value: float) -> str:
    """Return a constant."""
    return f"<v>{value:.9g}</v>"


def read(name: str) -> str:
    """Return the value of a property."""
    return f"<p>{name}</p>"


def operation(tag: str, *operands: str) -> str:
    """Return a JSBSim operation such as ``sum`` or ``product`` over operands."""
    return f"<{tag}>{''.join(operands)}</{tag}>"


def total(*operands: str) -> str:
    """Return the sum of operands."""
    return operation("sum", *operands)


def times(*operands: str) -> str:
    """Return the product of operands."""
    return operation("product", *operands)


def minus(first: str, *others: str) -> str:
    """Return the first operand minus the others."""
    return operation("difference", first, *others)


def clipped(value: str, low: float, high: float) -> str:
    """Return ``value`` limited to the range from ``low`` to ``high``."""
    return operation("min", operation("max", value, number(low)), number(high))


def within(value: str, limit: float) -> str:
    """Return 1 if the absolute value is at most ``limit``, otherwise 0."""
    return operation("le", operation("abs", value), number(limit))


def table_1d(at: str, rows: Sequence[float], values: Sequence[float]) -> str:
    """Return a linear interpolation of ``values`` over property ``at``, constant past the ends."""
    data = "\n".join(f"{row:.9g} {value:.9g}" for row, value in zip(rows, values, strict=True))
    return (
        f'<table><independentVar lookup="row">{at}</independentVar>'
        f"<tableData>\n{data}\n</tableData></table>"
    )


def table_2d(
    row_at: str, column_at: str, rows: Sequence[float], columns: Sequence[float], values: Array
) -> str:
    """Return a bilinear interpolation of ``values`` (rows, columns), constant past the edges."""
    head = " ".join(f"{column:.9g}" for column in columns)
    body = "\n".join(
        f"{row:.9g} " + " ".join(f"{x:.9g}" for x in line)
        for row, line in zip(rows, values, strict=True)
    )
    return (
        f'<table><independentVar lookup="row">{row_at}</independentVar>'
        f'<independentVar lookup="column">{column_at}</independentVar>'
        f"<tableData>\n{head}\n{body}\n</tableData></table>"
    )


def function(name: str, expression: str, outputs: Sequence[str] = ()) -> str:
    """Return a component that writes an expression to property ``name`` and to ``outputs``."""
    extra = "".join(f"<output>{output}</output>" for output in outputs)
    return f'<fcs_function name="{name}"><function>{expression}</function>{extra}</fcs_function>'


def channel(name: str, period: int, components: Sequence[str]) -> str:
    """Return a channel whose components run every ``period`` time steps."""
    return f'<channel name="{name}" execrate="{period}">\n' + "\n".join(components) + "\n</channel>"


def integrator(name: str, source: str) -> str:
    """Return a component that integrates ``source`` by the trapezoidal rule.

    The output is 0 while ``RESET`` is negative. JSBSim's ``<integrator>`` cannot be reset, so this
    is a ``<pid>`` with an integral only.
    """
    gains = '<kp>0</kp><ki type="trap">1</ki><kd>0</kd>'
    return f'<pid name="{name}"><input>{source}</input>{gains}<trigger>{RESET}</trigger></pid>'
