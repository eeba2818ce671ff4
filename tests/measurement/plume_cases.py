"""Plumes for tests: the ship of the worked example, straight and turning tracks, and a sum of
puffs.
"""

from dataclasses import replace

import numpy as np

from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.parcels import Parcels
from measurement.plume.spread import MarineAir, PlumeSettings, SpreadTable

# The worked example of the specification, section 2: 10 MW, 20 m/s, 1.5 m, 250 degC, F = 49.6
# m4/s3, Fm = 124 m4/s2.
EMISSION = replace(
    emission_of(ship_of("container"), fuel_preset("mgo"), power=10e6),
    buoyancy_flux=49.6,
    momentum_flux=124.0,
    exhaust_speed=20.0,
)
HEIGHT = 35.0
TEMPERATURE = 288.0


def air(wind_speed, **options):
    return MarineAir(wind_speed=wind_speed, temperature=TEMPERATURE, **options)


def plume_behind(track, true_wind=7.0, *, height=HEIGHT, seed=3, **settings):
    time, north, east = (np.array(values) for values in track)
    return FluctuatingPlume(
        EMISSION,
        air(true_wind),
        time=time,
        north=north,
        east=east,
        source_height=height,
        settings=PlumeSettings(**settings),
        seed=seed,
    )


def straight(wind, true_wind, *, since=-150.0, until=100.0, course=0.0, seed=1, **settings):
    """A plume in a constant apparent wind: the stack leaves the air mass behind on ``course``,
    from the origin at time 0.
    """
    time = np.array([since, until])
    track = time, wind * time * np.cos(course), wind * time * np.sin(course)
    return plume_behind(track, true_wind, seed=seed, **settings)


def turning(speed, wind, wind_to, *, rate=0.02, turn=np.pi, until=250.0):
    """Times and places in the air mass of a ship that steams north until time 0 and then turns to
    the right, as a hull does.

    A quarter of the turn goes by until it has its rate, and another until it has lost it.
    """
    time = np.arange(-350.0, until + 0.25, 0.5)
    phase = np.clip(rate * time / (1.5 * turn), 0.0, 1.0)
    course = turn * (phase - np.sin(2.0 * np.pi * phase) / (2.0 * np.pi))
    velocity = speed * np.array([np.cos(course), np.sin(course)]) - wind * np.array(
        [[np.cos(wind_to)], [np.sin(wind_to)]]
    )
    moved = 0.5 * np.diff(time) * (velocity[:, 1:] + velocity[:, :-1])
    north, east = np.concatenate([np.zeros((2, 1)), np.cumsum(moved, axis=1)], axis=1)
    return time, north, east


def puffs(track, true_wind, when, places, *, interval=0.1, **settings):
    """Dilution [s/mol] of a sum of puffs, each with the axis and spreads of its age and isotropic
    in the plane.

    Krause et al., AMT 16:1767 (2023), take puffs along the track of a ship; the spreads are those
    of the parcels.
    """
    chosen = PlumeSettings(**settings)
    parcels = Parcels(*track, chosen.parcel_interval)
    table = SpreadTable(
        EMISSION,
        air(true_wind),
        HEIGHT,
        (parcels.wind_min, parcels.wind_max),
        chosen.age_max,
        chosen,
    )
    emitted = np.arange(max(parcels.start, when - chosen.age_max), when, interval) + 0.5 * interval
    north, east, wind = parcels.at(emitted)
    height, spread, spread_up, *_ = table.at(wind, when - emitted)
    square = (places[0][:, None] - north) ** 2 + (places[1][:, None] - east) ** 2
    up = places[2][:, None]
    column = np.exp(-((up - height) ** 2) / (2.0 * spread_up**2)) + np.exp(
        -((up + height) ** 2) / (2.0 * spread_up**2)
    )
    each = (
        np.exp(-square / (2.0 * spread**2))
        * column
        / ((2.0 * np.pi) ** 1.5 * spread**2 * spread_up)
    )
    return interval * each.sum(axis=1) / air(true_wind).molar_density
