import math

import pytest

from scenarios.simulation.sea_settling import Settling

PERIOD = 19.0
AXIS = 2.0


def make(crossings=0):
    return Settling(band=8.0, period=PERIOD, crossings=crossings)


def sample(settling, time, *, tracking=1.0, centre=1.0, along=200.0, across=5.0):
    """Hand over a sample ``along`` the plume's axis and ``across`` it to the right."""
    x = along * math.cos(AXIS) - across * math.sin(AXIS)
    y = along * math.sin(AXIS) + across * math.cos(AXIS)
    return settling.update(time, tracking_error=tracking, centre_error=centre, x=x, y=y, axis=AXIS)


def test_it_has_settled_after_a_whole_period_near_the_reference_with_the_orbit_in_place():
    settling = make()
    for step in range(100):
        sample(settling, 10.0 + 0.5 * step)
        if math.isfinite(settling.at):
            break
    assert settling.at == 10.0 + PERIOD


@pytest.mark.parametrize("far", [{"tracking": 8.0}, {"centre": 24.0}, {"centre": math.inf}])
def test_the_period_begins_again_after_either_was_too_far(far):
    settling = make()
    for step in range(200):
        time = 0.5 * step
        sample(settling, time, **(far if time == 15.0 else {}))
    # 15.5 s is the first good sample after it.
    assert settling.at == 15.5 + PERIOD


def test_it_stays_settled():
    settling = make()
    for step in range(50):
        sample(settling, 0.5 * step)
    at = settling.at
    for step in range(50, 100):
        sample(settling, 0.5 * step, tracking=500.0, centre=math.inf)
    assert settling.at == at == PERIOD


def test_crossings_count_from_settling_on_and_behind_the_vessel_only():
    settling = make(crossings=2)
    for step in range(39):
        sample(settling, 0.5 * step, across=(-1.0) ** step)
    assert settling.at == PERIOD
    assert settling.crossings == 0
    # 39 samples end on the right side.
    assert not sample(settling, 20.0, across=-3.0)
    assert settling.crossings == 1
    # The axis is a half-line: ahead of the vessel is no plume.
    assert not sample(settling, 20.5, along=-200.0, across=3.0)
    assert settling.crossings == 1
    assert not sample(settling, 21.0, across=-3.0)
    assert settling.crossings == 2
    # One sample after the last wanted one the record holds it.
    assert sample(settling, 21.5, across=-4.0)


def test_without_a_number_of_crossings_there_is_no_end():
    settling = make()
    for step in range(400):
        assert not sample(settling, 0.5 * step, across=(-1.0) ** step)
    assert settling.crossings > 300
