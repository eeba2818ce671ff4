import numpy as np
import pytest
from plume_cases import air, plume_behind, turning

from measurement.plume.fluctuating_plume import PlumeSample

NAMES = PlumeSample._fields
TRACK = turning(8.0, 4.0, 1.0)


def plume(track, seed=3, **settings):
    return plume_behind(track, seed=seed, age_max=200.0, **settings)


def flight(count=5000):
    """Times and places of a UAV that weaves about the plume's axis, some of them outside of it."""
    time = np.linspace(0.0, 240.0, count)
    of = plume(TRACK)
    place = np.array(
        [
            np.concatenate(of.axis(when, np.array([15.0 + 0.1 * when])))
            for when in time[:: count // 50]
        ]
    )
    north, east, up = (np.interp(time, time[:: count // 50], column) for column in place.T)
    return (
        time,
        north + 40.0 * np.sin(time),
        east + 40.0 * np.cos(1.3 * time),
        up + 10.0 * np.sin(0.7 * time),
    )


@pytest.mark.parametrize(
    ("turn", "shift", "later"),
    [(0.7, (0.0, 0.0), 0.0), (0.0, (5e4, -2e4), 0.0), (0.0, (0.0, 0.0), 1e4)],
)
def test_where_and_when_the_frame_begins_changes_nothing(turn, shift, later):
    def seen(north, east):
        return (
            north * np.cos(turn) - east * np.sin(turn) + shift[0],
            north * np.sin(turn) + east * np.cos(turn) + shift[1],
        )

    time, north, east = TRACK
    when, there_north, there_east, up = flight()
    one = plume(TRACK).sample(when, there_north, there_east, up)
    other = plume((time + later, *seen(north, east))).sample(
        when + later, *seen(there_north, there_east), up
    )
    # Rounding of 5e4 m and of 1e4 s is 1e-11, over spreads of 10 m and times 10 in the tails; ages
    # are differences of such times.
    for name in NAMES:
        np.testing.assert_allclose(
            getattr(one, name), getattr(other, name), rtol=1e-6, atol=1e-12, err_msg=name
        )


def test_any_order_and_any_chunks_give_the_same():
    of = plume(TRACK, structure_intensity=0.4)
    places = flight(9000)
    whole, same = of.sample(*places), plume(TRACK, structure_intensity=0.4).sample(*places)
    order = np.random.default_rng(1).permutation(9000)
    shuffled = of.sample(*(each[order] for each in places))
    parts = [of.sample(*(each[k : k + 1300] for each in places)) for k in range(0, 9000, 1300)]
    for name in NAMES:
        expected = getattr(whole, name)
        np.testing.assert_array_equal(getattr(same, name), expected, err_msg=name)
        np.testing.assert_array_equal(getattr(shuffled, name), expected[order], err_msg=name)
        np.testing.assert_array_equal(
            np.concatenate([getattr(part, name) for part in parts]), expected, err_msg=name
        )


def test_a_straight_line_of_parcels_is_the_slender_plume():
    # x = (r - p)·a, y across to the right, age = x/U (specification, section 1.2); the ship goes
    # north-west.
    wind, course = 6.0, np.deg2rad(-45.0)
    time = np.arange(-250.0, 30.5, 0.5)
    of = plume((time, wind * time * np.cos(course), wind * time * np.sin(course)))
    along, across = np.meshgrid(np.linspace(20.0, 1100.0, 60), np.linspace(-150.0, 150.0, 41))
    along, across = along.ravel(), across.ravel()
    axis = np.array([-np.cos(course), -np.sin(course)])
    north = along * axis[0] - across * axis[1]
    east = along * axis[1] + across * axis[0]
    sample = of.sample(np.zeros(len(along)), north, east, np.full(len(along), 70.0))
    np.testing.assert_allclose(sample.distance, along, rtol=1e-9)
    np.testing.assert_allclose(sample.age, along / wind, rtol=1e-9)
    np.testing.assert_allclose(sample.across, across, atol=1e-7)
    # Section 1.5, of the values that the sample itself gives.
    y, z, h = (sample.across - sample.centre_across) / sample.sigma_y, 70.0, sample.centre_height
    column = np.exp(-0.5 * ((z - h) / sample.sigma_z) ** 2) + np.exp(
        -0.5 * ((z + h) / sample.sigma_z) ** 2
    )
    expected = (
        np.exp(-0.5 * y**2)
        * column
        / (2.0 * np.pi * wind * sample.sigma_y * sample.sigma_z * air(7.0).molar_density)
    )
    np.testing.assert_allclose(sample.dilution, expected, rtol=1e-9, atol=1e-30)
