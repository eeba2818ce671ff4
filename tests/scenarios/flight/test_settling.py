import math

import pytest

from scenarios.flight.ending import Settling

PERIOD = 19.0
AXIS = 2.0


def make(crossings=0, **more):
    return Settling(band=8.0, period=PERIOD, crossings=crossings, **more)


def sample(settling, time, *, tracking=1.0, centre=1.0, along=200.0, across=5.0):
    """Hand over a sample ``along`` the plume's axis and ``across`` it to the right."""
    x = along * math.cos(AXIS) - across * math.sin(AXIS)
    y = along * math.sin(AXIS) + across * math.cos(AXIS)
    return settling.update(time, tracking, centre, x, y, AXIS)


def test_it_has_settled_from_the_first_moment_from_which_it_stays_near_for_a_period():
    settling = make()
    sample(settling, 9.5, tracking=8.0)
    for step in range(39):
        # Before the period is over that does not show.
        assert math.isnan(settling.at)
        sample(settling, 10.0 + 0.5 * step)
    assert settling.at == 10.0


def test_crossings_count_from_the_first_moment_on_and_begin_again_after_it_was_too_far():
    settling = make(crossings=40)
    for step in range(5):
        sample(settling, 0.5 * step, across=(-1.0) ** step)
    # The first sample has none before it.
    assert settling.crossings == 4
    sample(settling, 2.5, across=-1.0, tracking=8.0)
    assert settling.crossings == 0
    for step in range(6, 46):
        sample(settling, 0.5 * step, across=(-1.0) ** step)
    assert (settling.at, settling.crossings) == (3.0, 39)


def test_it_is_complete_one_sample_after_the_last_crossing_and_no_earlier_than_settled():
    settling = make(crossings=2)
    done = [sample(settling, 0.5 * step, across=(-1.0) ** step) for step in range(41)]
    # Both crossings are flown after 1 s; that it has settled shows after 19 s, in the sample before
    # the last but one.
    assert done == [False] * 39 + [True] * 2
    settling = make(crossings=1)
    for step in range(50):
        assert not sample(settling, 0.5 * step)
    assert not sample(settling, 25.0, across=-3.0)
    # One sample after it the record holds it.
    assert sample(settling, 25.5, across=-4.0)


@pytest.mark.parametrize(("crossings", "end"), [(0, 60.5), (20, 60.5), (40, 100.5)])
def test_a_flight_that_goes_on_after_settling_ends_when_both_its_time_and_its_crossings_are_flown(
    crossings, end
):
    settling = make(crossings=crossings, after=60.0)
    # It settles with the first sample, and crosses every 2.5 s from then on.
    done = [sample(settling, 0.5 * step, across=5.0 * (-1.0) ** (step // 5)) for step in range(300)]
    assert settling.at == 0.0
    assert 0.5 * done.index(True) == end
