"""The smoke of a vessel over the ground: it bends with her own track, and a velocity that all share
changes nothing.
"""

import math

import numpy as np
import pytest

from aircraft.wind import constant_wind
from measurement.plume.spread import MarineAir
from scenarios.scenario.files import load_study
from scenarios.world.plume import Exhaust, emission, exhaust_of, fuel_of
from scenarios.world.vessel import SteadyVessel
from scenarios.world.world import mean_wind, plume_of, vessel_of

TIME = np.linspace(10.0, 110.0, 41)


def smoke(wind, vessel, *overrides):
    scenario = load_study("sulphur", overrides)
    plume = plume_of(scenario, vessel)
    return exhaust_of(
        scenario, vessel, plume, wind, duration=200.0, generator=np.random.default_rng(5)
    )


def behind(exhaust, vessel, wind, *, distance, across=0.0):
    """Return the dilution at places behind the vessel's motion through the air, on the plume's mean
    height.
    """
    places = np.array([vessel.motion(t) for t in TIME])
    through_air = places[:, 2:] - wind
    ahead = through_air / np.linalg.norm(through_air, axis=1)[:, None]
    north = places[:, 0] - distance * ahead[:, 0] - across * ahead[:, 1]
    east = places[:, 1] - distance * ahead[:, 1] + across * ahead[:, 0]
    return exhaust.sample(TIME, north, east, np.full_like(TIME, 55.0)).dilution


def test_smoke_leaves_the_funnel_of_its_ship_unless_a_height_is_given():
    vessel, wind = SteadyVessel(6.0, 0.0), constant_wind(0.0, 7.0)
    through_air = np.array([6.0, -7.0]) / math.hypot(6.0, 7.0)
    aft = -40.0 * through_air
    # The coaster's funnel is 16 m high (measurement/ships.toml): 40 m behind it her smoke
    # is near that height, and that of one of 35 m is not.
    means = {}
    for given in ("emission.load=0.5", "plume.source_height_m=35"):
        exhaust = smoke(
            wind, vessel, "emission.ship=coaster", "vessel.speed_mps=6", "plume.mean=true", given
        )
        means[given] = [
            float(
                exhaust.sample(
                    TIME, 6.0 * TIME + aft[0], np.full_like(TIME, aft[1]), np.full_like(TIME, up)
                ).dilution.mean()
            )
            for up in (20.0, 39.0)
        ]
    (own_low, own_high), (given_low, given_high) = means.values()
    assert own_low > 100.0 * own_high
    assert given_high > 100.0 * given_low


def test_a_plume_trails_by_the_wind_at_the_funnel_of_its_ship():
    # In wind with a profile the apparent wind turns with height.
    keys = ("emission.ship=coaster", "vessel.speed_mps=6", "wind.roughness_m=0.0002")
    own, same, other = (
        plume_of(scenario, vessel_of(scenario)).axis(0.0)
        for scenario in (
            load_study("sulphur", [*keys, *more])
            for more in ((), ("plume.source_height_m=16",), ("plume.source_height_m=35",))
        )
    )
    assert own == same
    assert abs(own - other) > 0.01


@pytest.mark.parametrize("common", [(7.0, 0.0), (-3.0, 11.0)])
def test_a_velocity_that_ship_and_air_share_changes_nothing(common):
    vessel, wind = SteadyVessel(10.0, 0.3), np.array([0.0, 4.0])
    moved = Moved(vessel, common)
    scenario = load_study("sulphur")
    plume, height = plume_of(scenario, vessel), scenario.source_height

    def of(vessel, wind):
        # What is emitted follows from her own speed, and the turbulence from the true wind: they
        # have to be the same for the comparison to hold.
        emitted, air = emission(scenario, speed=10.0), MarineAir(wind_speed=4.0, temperature=288.15)
        settings = scenario.plume.settings(plume)
        dispersion = plume.dispersion(
            emitted,
            air,
            vessel=vessel,
            wind=wind,
            duration=200.0,
            source_height=height,
            settings=settings,
            seed=5,
        )
        return Exhaust(
            fuel=fuel_of(scenario),
            emission=emitted,
            dispersion=dispersion,
            displacement=lambda time: wind.displacement(time, height),
        )

    here = behind(of(vessel, constant_wind(*wind)), vessel, wind, distance=220.0, across=6.0)
    there = behind(
        of(moved, constant_wind(*(wind + common))), moved, wind + common, distance=220.0, across=6.0
    )
    # Within the smoke at all times: its axis has some 1e-5 s/mol there.
    assert here.min() > 1e-7
    # Rounding of places of a kilometre.
    np.testing.assert_allclose(there, here, rtol=1e-8)


def test_excess_of_a_gas_is_its_rate_times_the_dilution_whatever_the_gas():
    exhaust, dilution = (
        smoke(constant_wind(0.0, 4.0), SteadyVessel(10.0, 0.3)),
        np.array([1e-6, 3e-6]),
    )
    so2, co2, no, no2 = exhaust.emission.rates
    # Mole fractions in ppb, and that of CO2 in ppm.
    expected = np.outer(dilution, [1e9 * so2, 1e6 * co2, 1e9 * no, 1e9 * no2])
    np.testing.assert_allclose(exhaust.excess(dilution), expected, rtol=1e-12)


class Moved:
    """A vessel with a velocity more."""

    def __init__(self, vessel, velocity):
        self._vessel, self._velocity = vessel, velocity

    def motion(self, time):
        north, east, v_north, v_east = self._vessel.motion(time)
        return (
            north + self._velocity[0] * time,
            east + self._velocity[1] * time,
            v_north + self._velocity[0],
            v_east + self._velocity[1],
        )


def test_the_smoke_of_a_ship_that_turned_lies_along_her_own_track():
    overrides = (
        "vessel.manoeuvres=[{at_s=20,turn_deg=90,turn_rate_deg_s=1.0}]", "wind.speed_mps=2", "wind.from_deg=90",
        "plume.meander=false",
    )  # fmt: skip
    vessel = vessel_of(load_study("sulphur", overrides))
    exhaust = smoke(mean_wind(load_study("sulphur", overrides), vessel), vessel, *overrides)
    # At 125 s she sails east; what she emitted at 30 s, before half her turn, the wind has carried
    # 190 m west of there.
    north, east, _, _ = vessel.motion(30.0)
    at = np.array([125.0])
    old = exhaust.sample(at, np.array([north]), np.array([east - 2.0 * 95.0]), np.array([70.0]))
    assert old.dilution[0] > 0.0
    assert old.age[0] == pytest.approx(95.0, abs=1.0)
    assert abs(old.across[0]) < 1.0
    # Straight behind her, along the apparent wind of now, it would be 1,400 m away.
    now = vessel.motion(125.0)
    straight = exhaust.sample(at, np.array([now[0] - 300.0]), np.array([now[1]]), np.array([60.0]))
    assert straight.dilution[0] == 0.0
