import pytest

from gnc.airspeed.along_track import AlongTrackTrim


@pytest.mark.parametrize(
    ("along", "guarding", "expected"),
    [
        # 0.15/s of the way that the reference is ahead, and 1 m/s at most.
        (4.0, False, 20.6),
        (-4.0, False, 19.4),
        (50.0, False, 21.0),
        (-50.0, False, 19.0),
        # A turn away from the keep-out area is flown at V_r.
        (50.0, True, 20.0),
    ],
)
def test_the_airspeed_is_trimmed_by_the_way_that_the_reference_is_ahead(along, guarding, expected):
    trim = AlongTrackTrim(speed=20.0, gain=0.15, change_max=1.0)
    assert trim.command(along, None, guarding) == pytest.approx(expected, abs=1e-12)


def test_without_a_gain_the_airspeed_is_that_of_the_reference():
    assert AlongTrackTrim(speed=20.0, gain=0.0, change_max=1.0).command(50.0, None, False) == 20.0
