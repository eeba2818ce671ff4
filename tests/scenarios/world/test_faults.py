import numpy as np
import pytest

from scenarios.scenario.sections.equipment import FaultConfig
from scenarios.world.faults import (
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
