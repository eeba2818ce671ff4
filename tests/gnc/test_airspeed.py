import math
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gnc.airspeed import AlongTrackTrim, PaceHold, SpeedHold, design_speed_hold
from gnc.errors import InfeasibleError

HOLD = SpeedHold(gain=0.3, airspeed_min=15.0, airspeed_max=25.0)
LAW = PaceHold(speed=19.0, hold=HOLD)
X8 = {"bandwidth": 1.3, "speed": 19.42, "look_ahead": 60.0}
X8 |= {"airspeed_min": 15.0, "airspeed_max": 25.0}


def commanded(along, *, speed, airspeed):
    """Return the airspeed that the guidance commands while the guard does not act."""
    return LAW.airspeed(LAW.pace(along), SimpleNamespace(speed=speed, airspeed=airspeed), False)


@given(st.floats(-100.0, 100.0), st.floats(5.0, 40.0), st.floats(5.0, 40.0))
def test_the_commanded_airspeed_is_one_that_the_vehicle_can_fly(along, speed, airspeed):
    assert 15.0 <= commanded(along, speed=speed, airspeed=airspeed) <= 25.0


def test_a_slow_airspeed_is_given_a_gain_that_does_not_overshoot():
    bandwidth = 0.4
    gain = design_speed_hold(**(X8 | {"bandwidth": bandwidth})).gain
    # Position behind a first-order speed: s^2 + b s + b k has its poles together, where they are
    # fastest, at k = b/4.
    assert bandwidth**2 - 4.0 * bandwidth * gain == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "changed", [{"speed": 14.0}, {"speed": 25.0}, {"bandwidth": 0.0}, {"look_ahead": math.nan}]
)
def test_what_cannot_be_held_is_refused(changed):
    with pytest.raises(InfeasibleError):
        design_speed_hold(**(X8 | changed))


@pytest.mark.parametrize(("along", "expected"), [(2.0, 21.1), (-3.0, 19.6)])
def test_the_pace_is_held_over_the_mean_air(along, expected):
    # 19 m/s and 0.3 m/s for each metre ahead, over the mean air, to which a gust of 1.5 m/s adds.
    assert commanded(along, speed=18.5, airspeed=20.0) == pytest.approx(expected, rel=1e-14)


def test_while_the_guard_turns_away_the_vehicle_does_not_become_too_fast_for_its_turn():
    # A gust from ahead: the airspeed of the pace is 21.5 m/s.
    own = SimpleNamespace(speed=18.5, airspeed=21.0)
    law = PaceHold(speed=19.0, hold=HOLD, turn_speed=21.0)
    assert law.airspeed(19.0, own, False) == 21.5
    assert law.airspeed(19.0, own, True) == 21.0


@pytest.mark.parametrize(
    ("along", "expected"),
    # 0.15/s of the way that the reference is ahead, and 1 m/s at most.
    [(4.0, 20.6), (-4.0, 19.4), (50.0, 21.0), (-50.0, 19.0)],
)
def test_the_pace_is_trimmed_by_the_way_that_the_reference_is_ahead(along, expected):
    trim = AlongTrackTrim(speed=20.0, gain=0.15, change_max=1.0)
    assert trim.pace(along) == pytest.approx(expected, abs=1e-12)
