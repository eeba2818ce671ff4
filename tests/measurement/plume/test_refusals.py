import numpy as np
import pytest
from plume_cases import HEIGHT, plume_behind

from measurement.errors import MeasurementError
from measurement.plume.spread import PlumeSettings

TIME = np.array([0.0, 50.0, 100.0])


def plume(time=TIME, north=5.0 * TIME, east=0.0 * TIME, height=HEIGHT, seed=0):
    return plume_behind((time, north, east), height=height, seed=seed)


@pytest.mark.parametrize(
    ("track", "said"),
    [
        (
            {"north": 0.9 * TIME},
            r"apparent wind is 0\.90 m/s at \d+ s; below 1 m/s a plume has no direction",
        ),
        ({"north": [0.0, 250.0, 250.0]}, r"apparent wind is 0\.00 m/s at \d+ s"),
        ({"time": [0.0, 50.0, 50.0]}, "do not increase after 50 s"),
        ({"time": [0.0, 100.0, 50.0]}, "do not increase after 100 s"),
        ({"north": [0.0, np.nan, 500.0]}, "missing or infinite"),
        ({"time": TIME[:2]}, "have shapes"),
        ({"time": [0.0], "north": [0.0], "east": [0.0]}, "2 or more"),
        ({"height": 0.0}, "height of the source is 0 m"),
        ({"height": 500.0}, "height of the source is 500 m"),
        ({"seed": -1}, "seed of the plume is -1"),
    ],
)
def test_a_track_without_a_plume_is_refused_in_one_line(track, said):
    with pytest.raises(MeasurementError, match=said) as refusal:
        plume(**track)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("places", "said"),
    [
        (
            [[101.0], [0.0], [0.0], [50.0]],
            "time in the plume is 101 to 101 s; the ship's track has 0 to 100",
        ),
        ([[-0.5], [0.0], [0.0], [50.0]], "time in the plume is -0.5"),
        ([[50.0], [0.0], [0.0], [-1.0]], "height above the sea is -1 m"),
        ([[50.0], [np.nan], [0.0], [50.0]], "missing or infinite"),
        ([[np.nan], [0.0], [0.0], [50.0]], "missing or infinite"),
        ([[50.0, 60.0], [0.0], [0.0], [50.0]], "have shapes"),
    ],
)
def test_places_that_are_not_in_the_air_are_refused_in_one_line(places, said):
    with pytest.raises(MeasurementError, match=said) as refusal:
        plume().sample(*(np.array(values) for values in places))
    assert "\n" not in str(refusal.value)


def test_no_places_are_no_samples():
    assert plume().sample(*np.empty((4, 0))).dilution.shape == (0,)


@pytest.mark.parametrize("age", [-1.0, 60.0])
def test_parcels_that_were_not_emitted_have_no_axis(age):
    with pytest.raises(MeasurementError, match="at 50 s there are 0 to 50"):
        plume().axis(50.0, np.array([age]))


def test_an_axis_without_a_track_there_is_refused():
    with pytest.raises(MeasurementError, match="time in the plume is 200"):
        plume().axis(200.0, np.array([1.0]))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("richardson", 0.0),
        ("structure_intensity", 1.1),
        ("structure_intensity", float("nan")),
        ("age_max", 1e4),
        ("parcel_interval", 0.0),
    ],
)
def test_settings_out_of_range_are_refused(name, value):
    with pytest.raises(MeasurementError, match=f"^{name} is"):
        PlumeSettings(**{name: value})
