import pytest

from gnc.airspeed.along_track import AlongTrackTrim


@pytest.mark.parametrize(
    ("along", "expected"),
    # 0.15/s of the way that the reference is ahead, and 1 m/s at most.
    [(4.0, 20.6), (-4.0, 19.4), (50.0, 21.0), (-50.0, 19.0)],
)
def test_the_pace_is_trimmed_by_the_way_that_the_reference_is_ahead(along, expected):
    trim = AlongTrackTrim(speed=20.0, gain=0.15, change_max=1.0)
    assert trim.pace(along) == pytest.approx(expected, abs=1e-12)


def test_no_pace_is_asked_for_that_the_vehicle_cannot_fly():
    trim = AlongTrackTrim(
        speed=20.0, gain=0.15, change_max=30.0, airspeed_min=14.0, airspeed_max=26.0
    )
    assert [trim.pace(along) for along in (-1000.0, 0.0, 1000.0)] == [14.0, 20.0, 26.0]
    # Nor, where nothing is known of the vehicle, that it flies backwards.
    assert AlongTrackTrim(speed=20.0, gain=0.15, change_max=30.0).pace(-1000.0) == 0.0


@pytest.mark.parametrize("guarding", [False, True])
def test_in_still_air_a_pace_is_an_airspeed(guarding):
    assert (
        AlongTrackTrim(speed=20.0, gain=0.15, change_max=1.0).airspeed(20.3, None, guarding) == 20.3
    )


def test_without_a_gain_the_airspeed_is_that_of_the_reference():
    assert AlongTrackTrim(speed=20.0, gain=0.0, change_max=1.0).pace(50.0) == 20.0
