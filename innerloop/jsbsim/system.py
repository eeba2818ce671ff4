"""The autopilot written out as a JSBSim ``<system>``, and a JSBSim root that flies it.

The commands are ``AIRSPEED_COMMAND`` [m/s], ``ALTITUDE_COMMAND`` [m] and ``HEADING_RATE_COMMAND``
[rad/s].

A component costs JSBSim more than a table does: some forty components were a third of its time
step. So a value is a component only if it is read from outside, a state, looked up in a table, or
expensive to compute twice.
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
"""Pattern of the properties with the command of a control [-], by its name in the linear model."""

RESET = "autopilot/reset"
"""Negative to hold every integrator at 0, otherwise 0."""

PERIOD = "autopilot/period-steps"
"""Time steps from one computation of the autopilot to the next."""

ELEVATOR_HELD = "autopilot/elevator-held"
"""1 to hold the elevator instead of controlling it, otherwise 0."""

HELD_ELEVATOR = "autopilot/held-elevator"
"""Command at which the elevator is held [-]."""

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
    """Return how many time steps a body is held before its release while servos and engines settle.

    These are whole periods [time steps] of the autopilot, so that it computes in the last of them.
    Guidance and record read a whole number of periods later, and so what it computed then.
    """
    settle = round(spec.settle_time / TIME_STEP)
    return settle + -settle % period


def system_name(spec: AircraftSpec) -> str:
    """Return the name of the aircraft's autopilot system."""
    return f"{spec.name}_autopilot"


def commanded_property(control_input: ControlInput) -> str:
    """Return the property of the command that JSBSim gets from the autopilot for a control [-]."""
    if control_input.effectiveness:
        return f"autopilot/{control_input.name}-surface-command"
    return CONTROL_COMMAND.format(control_input.name)


def write_root(schedule: Schedule, directory: Path) -> Path:
    """Write a JSBSim root with a copy of the aircraft, its engines and the autopilot; return it.

    Any JSBSim started on this root flies the aircraft under the autopilot. The model's own outputs
    and autopilot are left out (``aircraft.model``); its servos keep their play.
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
    # The integrators of a channel that runs every few time steps integrate over as many.
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
    # At least 1 m/s: JSBSim runs the system once without a speed, and integrators keep the result
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
    # A larger error demands a steady climb or acceleration; integrated on the way there, it would
    # overshoot by as much again. An altitude error that still grows is integrated beyond the limit
    # as well: its integral may be what makes it grow, and would do so for ever.
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
            # The integral of the last step enters here.
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
            # It removes the remaining sideslip.
            growth = [times(_gain_table(schedule, "sideslip_integral"), read(_SIDESLIP))]
            command = CONTROL_COMMAND.format(name)
            components += _integral(schedule, name, command, unlimited, growth)
    return components


def _integral(
    schedule: Schedule, name: str, command: str, unlimited: str, growth: Sequence[str]
) -> list[str]:
    """Return an integral that back-calculation holds to what the ``command`` can be."""
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
    """Return the bank of the model's turn, corrected by the integral of the heading-rate error."""
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
    """Return components that keep a control within its range and pass it to JSBSim."""
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
    """Return an entry of one of the ``Gains`` over bank and commanded airspeed."""
    values = [
        [float(np.asarray(getattr(gains, name))[index]) for gains in row] for row in schedule.gains
    ]
    return table_2d(_ROLL, _SCHEDULE, schedule.gain_banks, schedule.airspeeds, np.array(values).T)


def _trim_table(schedule: Schedule, quantity: str, bank: str = _ROLL) -> str:
    """Return a trim quantity over bank, by default the actual one, and commanded airspeed."""
    values = schedule.over_bank(quantity)
    return table_2d(bank, _SCHEDULE, schedule.banks, schedule.airspeeds, values)


# JSBSim's XML as far as the autopilot needs it: expressions, tables and components.


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
    """Return the sum."""
    return operation("sum", *operands)


def times(*operands: str) -> str:
    """Return the product."""
    return operation("product", *operands)


def minus(first: str, *others: str) -> str:
    """Return the first less the others."""
    return operation("difference", first, *others)


def clipped(value: str, low: float, high: float) -> str:
    """Return ``value`` kept within ``low`` and ``high``."""
    return operation("min", operation("max", value, number(low)), number(high))


def within(value: str, limit: float) -> str:
    """Return 1 while ``value`` lies within plus and minus ``limit``, otherwise 0."""
    return operation("le", operation("abs", value), number(limit))


def table_1d(at: str, rows: Sequence[float], values: Sequence[float]) -> str:
    """Return linear interpolation of ``values`` over property ``at``, constant past the ends."""
    data = "\n".join(f"{row:.9g} {value:.9g}" for row, value in zip(rows, values, strict=True))
    return (
        f'<table><independentVar lookup="row">{at}</independentVar>'
        f"<tableData>\n{data}\n</tableData></table>"
    )


def table_2d(
    row_at: str, column_at: str, rows: Sequence[float], columns: Sequence[float], values: Array
) -> str:
    """Return bilinear interpolation of ``values`` (rows, columns), constant past the edges."""
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

    It is held at 0 while ``RESET`` is negative. JSBSim's ``<integrator>`` can be held but
    not reset, so this is a ``<pid>`` with its integral alone.
    """
    gains = '<kp>0</kp><ki type="trap">1</ki><kd>0</kd>'
    return f'<pid name="{name}"><input>{source}</input>{gains}<trigger>{RESET}</trigger></pid>'
