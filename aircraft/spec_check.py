"""Whether an autopilot can be designed for what the spec of an aircraft says."""

import math
import re
from collections.abc import Iterator

from aircraft.errors import AircraftError
from aircraft.field_types import type_fault
from aircraft.spec import NAME, SETTLE_TIMES, AircraftSpec

_ACTUATOR_NAME = re.compile(
    r"(?!(engine|none|vessel_data|satellite_navigation|sniffer_(dead|saturated))$)[A-Za-z_][A-Za-z0-9_.\-]*"
)
"""What an actuator may be called: the name becomes part of a JSBSim property, and may not be that
of another fault.
"""

_INPUTS, _MORE_INPUTS = ("elevator", "aileron", "throttle"), ("rudder",)
"""Control inputs that the autopilot needs, and those that it uses if there are any."""


def check_spec(spec: AircraftSpec) -> None:
    """See that an autopilot can be designed for what the spec says.

    Raises
    ------
    AircraftError : a field is of another type; the name has other letters than ``NAME``; an input
        is missing, unknown, or there twice; a driven state follows no input, or one that has a
        state; a range, an actuator, the settle time or the envelope cannot be
    """
    if fault := type_fault(spec):
        raise AircraftError(f"aircraft '{spec.name}': {fault}; correct its spec")
    if not NAME.fullmatch(spec.name):
        raise AircraftError(
            f"'{spec.name}' is no name of an aircraft; use letters, digits, '_', '-' and '.': correct its spec"
        )
    names = [i.name for i in spec.inputs]
    if not set(_INPUTS) <= set(names) <= {*_INPUTS, *_MORE_INPUTS} or len(names) > len(set(names)):
        raise AircraftError(
            f"aircraft '{spec.name}' has the inputs {', '.join(names) or '(none)'}; it needs {', '.join(_INPUTS)}, may have"
            f" {', '.join(_MORE_INPUTS)}, and no others: correct its spec"
        )
    if reason := next(filter(None, _faults(spec)), ""):
        raise AircraftError(f"aircraft '{spec.name}': {reason}; correct its spec")


def _faults(spec: AircraftSpec) -> Iterator[str]:
    """Yield what is wrong with states, ranges, actuators, the settle time and the envelope; perhaps
    an empty text.
    """
    names, driven = [i.name for i in spec.inputs], [state.input for state in spec.driven_states]
    for i, state in enumerate(spec.driven_states):
        if state.input not in names or state.input in driven[:i]:
            why = (
                "as another one does"
                if state.input in names
                else f"which is none of {', '.join(names)}"
            )
            yield f"driven state '{state.name}' follows input '{state.input}', {why}"
    for control in spec.inputs:
        if not control.commands:
            yield f"input '{control.name}' has no commands; name the JSBSim properties that take it"
        lower, upper = control.lower, control.upper
        if not -math.inf < lower < upper < math.inf:
            yield f"input '{control.name}' ranges from {lower:g} to {upper:g}; lower must be below upper, and both finite"
        elif control.name != "throttle" and not lower < 0.0 < upper:
            yield f"input '{control.name}' ranges from {lower:g} to {upper:g}; lower must be below 0, and upper above it"
    taken = [actuator.name for actuator in spec.own_actuators]
    for i, actuator in enumerate(spec.own_actuators):
        if not _ACTUATOR_NAME.fullmatch(actuator.name) or actuator.name in taken[:i]:
            yield f"'{actuator.name}' is no name of an actuator, or taken; use letters, digits, '_', '-' and '.'"
        if not actuator.commands:
            yield f"actuator '{actuator.name}' has no commands; name the JSBSim properties that command it"
        elif actuator.feedback is None and not any(
            set(actuator.commands) <= set(i.commands) for i in spec.inputs
        ):
            yield f"actuator '{actuator.name}' has commands of its own and no feedback; name what reads command and position"
    least, most = SETTLE_TIMES
    if not least <= spec.settle_time <= most:
        yield f"settle_time is {spec.settle_time:g} s; it must lie between {least:g} and {most:g} s"
    if spec.envelope is not None:
        yield spec.envelope.fault
