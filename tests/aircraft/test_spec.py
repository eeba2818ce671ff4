"""Specs for which no autopilot can be designed are refused, with the field and the limit."""

from dataclasses import replace

import pytest

from aircraft.fleet.x8 import X8
from aircraft.spec import (
    Actuator,
    AircraftError,
    DrivenState,
    check_spec,
    servo_position,
    surface,
    throttle,
)

THREE = (surface("elevator"), surface("aileron"), throttle(1))
TWO_DRIVERS = DrivenState(name="rpm", position="a/b", input="throttle")

# Each with what the message has to name.
IMPOSSIBLE = [
    ({"name": "A&B/C"}, "'A&B/C'"),
    ({"inputs": (*THREE, surface("flap"))}, "elevator, aileron, throttle, flap"),
    ({"inputs": (THREE[0], THREE[2], surface("rudder"))}, "elevator, throttle, rudder"),
    ({"inputs": ()}, "(none)"),
    ({"inputs": (replace(THREE[0], commands=()), *THREE[1:])}, "input 'elevator' has no commands"),
    (
        {"inputs": (replace(THREE[0], lower=1.0, upper=-1.0), *THREE[1:])},
        "input 'elevator' ranges from 1 to -1",
    ),
    (
        {"inputs": (replace(THREE[0], lower=0.1), *THREE[1:])},
        "input 'elevator' ranges from 0.1 to 1",
    ),
    ({"driven_states": (servo_position("rudder"),)}, "'rudder_position' follows input 'rudder'"),
    ({"driven_states": (*X8.driven_states, TWO_DRIVERS)}, "'rpm' follows input 'throttle'"),
    ({"own_actuators": (Actuator(name="left elevon", commands=("a/b",)),)}, "'left elevon'"),
    ({"own_actuators": (*X8.own_actuators, X8.own_actuators[0])}, "'left_elevon'"),
    ({"own_actuators": (Actuator(name="engine", commands=THREE[2].commands),)}, "'engine'"),
    ({"own_actuators": (Actuator(name="flap", commands=("fcs/flap",)),)}, "no feedback"),
    ({"settle_time": -1.0}, "settle_time is -1 s; it must lie between 0.1 and 120 s"),
    ({"envelope": replace(X8.envelope, airspeed_max=15.0)}, "airspeed is 19.42 m/s"),
    ({"envelope": replace(X8.envelope, airspeed_min=25.0, airspeed_max=15.0)}, "airspeed_min, 25,"),
    ({"envelope": replace(X8.envelope, airspeed_max=401.0)}, "airspeed_max, 401"),
    ({"envelope": replace(X8.envelope, bank=45.0)}, "bank is 2578.31 deg (45 rad)"),
]

OF_ANOTHER_TYPE = [
    ({"name": None}, "name is None, of type NoneType; it must be of type str"),
    ({"root": "models"}, "root is 'models', of type str; it must be of type Path"),
    ({"settle_time": "2"}, "settle_time is '2'"),
    ({"configuration": {"fcs/flap": 0.3}}, "configuration is {'fcs/flap': 0.3}, of type dict"),
    ({"configuration": (("fcs/flap", 0.3, 1.0),)}, "configuration[0] is ('fcs/flap', 0.3, 1.0)"),
    (
        {"inputs": (replace(THREE[0], commands="fcs/elevator-cmd-norm"), *THREE[1:])},
        "inputs[0].commands is 'fcs/elevator-cmd-norm', of type str; it must be of type tuple",
    ),
    ({"envelope": (15.0, 25.0)}, "envelope is (15.0, 25.0), of type tuple; it must be of type Env"),
    ({"envelope": replace(X8.envelope, bank="45")}, "envelope.bank is '45'"),
]


@pytest.mark.parametrize(("fields", "named"), [*IMPOSSIBLE, *OF_ANOTHER_TYPE])
def test_a_spec_that_no_autopilot_can_fly_is_refused_in_a_line_that_names_why(fields, named):
    with pytest.raises(AircraftError) as caught:
        check_spec(replace(X8, **{"name": "own", **fields}))
    assert named in str(caught.value)
    assert "\n" not in str(caught.value)
