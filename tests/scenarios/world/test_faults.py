import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.faults import ENGINE
from aircraft.fleet.x8 import X8
from aircraft.spec import Actuator, AircraftError, check_spec
from scenarios.scenario.sections.equipment import FaultConfig
from scenarios.world.faults import (
    NO_FAULT,
    NOT_OF_AIRCRAFT,
    SATELLITES,
    VESSEL_DATA,
    in_order,
    sampled_fault,
)


def generator():
    return np.random.default_rng(9)


@pytest.mark.parametrize(("kind", "lasts"), [(VESSEL_DATA, 60.0), (SATELLITES, 10.0)])
def test_a_passing_fault_lasts_from_its_beginning_to_its_end(kind, lasts):
    fault = sampled_fault(FaultConfig(kind=kind, at_s=(100.0, 250.0)), generator())
    assert 100.0 <= fault.begins <= 250.0
    assert fault.ends == fault.begins + lasts
    assert not fault.of_aircraft()
    faults = in_order([fault])
    found = [
        faults.lasts(kind, t)
        for t in (fault.begins - 0.01, fault.begins, fault.ends - 0.01, fault.ends)
    ]
    assert found == [False, True, True, False]
    assert not faults.lasts(SATELLITES if kind == VESSEL_DATA else VESSEL_DATA, fault.begins)


def test_one_number_is_the_time_of_a_fault():
    assert FaultConfig.model_validate({"at_s": 120}).at_s == (120.0, 120.0)
    assert (
        sampled_fault(
            FaultConfig.model_validate({"kind": SATELLITES, "at_s": 120.5}), generator()
        ).begins
        == 120.5
    )


def test_a_part_fails_for_good():
    fault = sampled_fault(FaultConfig(kind="engine"), generator())
    assert fault.of_aircraft()
    assert fault.ends == math.inf
    assert not sampled_fault(FaultConfig(), generator()).of_aircraft()
    assert not NO_FAULT.of_aircraft()


def test_a_flight_without_a_fault_has_none_at_any_time_and_draws_what_others_do():
    # A time that was drawn for it stood in messages: "after the fault 'none' at 183.2 s".
    drawn, others = generator(), generator()
    assert sampled_fault(FaultConfig(), drawn) == NO_FAULT
    sampled_fault(FaultConfig(kind="engine"), others)
    assert drawn.random() == others.random()


@pytest.mark.parametrize("name", sorted({*NOT_OF_AIRCRAFT, ENGINE}))
def test_no_actuator_may_have_the_name_of_another_fault(name):
    with pytest.raises(AircraftError, match=f"'{name}' is not a valid name of an actuator"):
        check_spec(
            replace(
                X8, own_actuators=(Actuator(name=name, commands=X8.input("throttle").commands),)
            )
        )
    # Any other that an aircraft may have, a scenario can name.
    assert FaultConfig(kind="Left-elevon.1").kind == "Left-elevon.1"
