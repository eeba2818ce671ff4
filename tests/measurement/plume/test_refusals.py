import numpy as np
import pytest
from plume_cases import HEIGHT, plume_behind

from measurement.errors import MeasurementError
from measurement.plume.spread import MarineAir, PlumeSettings

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


@pytest.mark.parametrize(
    ("refused", "said"),
    [
        (lambda: plume().axis(50.0, np.array([-1.0])), "at 50 s there are 0 to 50"),
        (lambda: plume().axis(50.0, np.array([60.0])), "at 50 s there are 0 to 50"),
        (lambda: plume().axis(200.0, np.array([1.0])), "time in the plume is 200"),
        (lambda: PlumeSettings(richardson=0.0), "richardson is"),
        (lambda: PlumeSettings(structure_intensity=1.1), "structure_intensity is"),
        (lambda: PlumeSettings(age_max=1e4), "age_max is"),
        (lambda: PlumeSettings(parcel_interval=0.0), "parcel_interval is"),
        (lambda: MarineAir(wind_speed=-1.0), "true wind is -1 m/s"),
        (lambda: MarineAir(wind_speed=41.0), "true wind is 41 m/s"),
        (lambda: MarineAir(wind_speed=7.0, temperature=15.0), "air temperature is 15 K"),
        (lambda: MarineAir(wind_speed=7.0, pressure=1013.0), "air pressure is 1013 Pa"),
        (lambda: MarineAir(wind_speed=7.0, brunt_vaisala=1.0), "stability N is 1 1/s"),
        (lambda: MarineAir(wind_speed=7.0, charnock=0.5), "Charnock's constant is 0.5"),
    ],
)
def test_parcels_air_and_settings_out_of_range_are_refused(refused, said):
    with pytest.raises(MeasurementError, match=said):
        refused()
