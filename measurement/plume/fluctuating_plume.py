"""The plume of one flight: one realisation, the same for a seed, at any time and place."""

import math
from dataclasses import dataclass, fields

import numpy as np

from measurement.emission.emission import Emission
from measurement.errors import MeasurementError
from measurement.plume.air import MarineAir
from measurement.plume.arrays import Array
from measurement.plume.meander import Meander
from measurement.plume.parcels import Nearest, Parcels
from measurement.plume.settings import SOURCE_HEIGHT_MAX, SOURCE_HEIGHT_MIN, PlumeSettings
from measurement.plume.spread_table import SpreadTable
from measurement.plume.structure import Structure

_CHUNK = 4096
"""Places that are computed at a time: their arrays stay in the processor's cache."""

_EDGE = 4.0
"""Spreads from the centre within which there are fluctuations of the plume's own [-]; beyond is
3e-4 of the axis.
"""

_FOLD = 0.5
"""Least share of a parcel's length that a bend leaves on its inner side [-]: nearer to the centre
of curvature the line folds.

Against a sum of puffs this one is the best of 0.1 to 1.
"""


@dataclass(frozen=True)
class PlumeSample:
    """The plume at places and times, arrays of shape (m,).

    Where no parcel's cross-section goes through a place (upwind of the funnel, beyond the oldest
    parcel) the dilution is 0 and what belongs to a parcel is NaN. Where several do, as behind a
    ship that has turned, their dilutions are added, and the other values are those of the parcel
    that is nearest in its spreads.

    Attributes
    ----------
    dilution : mole fraction of a gas over its emission [s/mol]: times ``emission.rates[j]`` it is
        the excess of gas j
    axis_dilution : the same in the centre of this realisation's cross-section, without fluctuations
        within the plume
    age, distance : of the parcel [s], and along the line of parcels back to the funnel [m]
    across : place relative to the mean axis, along the apparent wind turned +90 degrees north to
        east [m]
    axis_height : of the mean axis above the sea [m]
    centre_across, centre_height : of this realisation's centre, relative to the mean axis and above
        the sea [m]
    sigma_y, sigma_z : spreads about the centre [m]; of the ensemble mean they are those about the
        axis
    """

    dilution: Array
    axis_dilution: Array
    age: Array
    distance: Array
    across: Array
    axis_height: Array
    centre_across: Array
    centre_height: Array
    sigma_y: Array
    sigma_z: Array


class FluctuatingPlume:
    """Gifford's fluctuating plume: a Gaussian about a centre that leaves the mean axis, with
    deviations frozen at emission.

    In the frame of the air mass a parcel stays where the funnel left it, so that wind that changes,
    a ship that turns, and a velocity that is common to all need nothing of their own. It rises and
    spreads with its age, in the turbulence of the true wind and the apparent wind at its emission;
    its centre is off the axis by the standard deviation of the meander at its age, times a process
    of the air that had passed the funnel before it. A place has the concentration of the nearest
    parcel of the line,

        chi = Q/(2 pi U sigma_y sigma_z n) exp(-(y - y_c)^2/2 sigma_y^2)
              [exp(-(z - z_c)^2/2 sigma_z^2) + exp(-(z + z_c)^2/2 sigma_z^2)]

    with n = p/RT, reflected at the sea; a centre below the sea is its mirror image. Where the line
    bends with a curvature k, U is that of the place, U sqrt((1 - k y)(1 - k y_c)), as a sum of
    puffs has it.

    More than 100 m behind a ship that turns about it differs from that sum by at most 1 to 5 % of
    the largest concentration where the apparent wind is 4 m/s or more, and by up to 20 % where the
    line folds with a radius of little more than the spread. The ratio of gases is exact everywhere.

    Parameters
    ----------
    emission : source; the concentration is per its rates
    air : turbulence, from the true wind
    time : [s], increasing, shape (n,); from before the flight, because the plume ends with the
        first
    north, east : place of the funnel in the frame of the air mass [m], shape (n,): place over
        ground minus the integral of the wind
    source_height : of the funnel's mouth above the sea [m]
    settings : constants and options
    seed : of the realisation, at least 0; one seed, one plume

    Raises
    ------
    MeasurementError : the track cannot be used, or the apparent wind is below 1 m/s anywhere on it,
        where a plume has no direction. The spreads hold from 2 m/s on: see ``wind_min``

    Sources: F. A. Gifford, Advances in Geophysics 6:117 (1959); the modules of this package name
    those of rise and spreads.
    """

    def __init__(
        self,
        emission: Emission,
        air: MarineAir,
        *,
        time: Array,
        north: Array,
        east: Array,
        source_height: float,
        settings: PlumeSettings | None = None,
        seed: int = 0,
    ) -> None:
        settings = settings or PlumeSettings()
        if not SOURCE_HEIGHT_MIN <= source_height <= SOURCE_HEIGHT_MAX:
            raise MeasurementError(
                f"height of the source is {source_height:g} m above the sea; give {SOURCE_HEIGHT_MIN:g} to {SOURCE_HEIGHT_MAX:g}"
            )
        if seed < 0:
            raise MeasurementError(f"seed of the plume is {seed}; give 0 or more")
        self._parcels = Parcels(time, north, east, settings.parcel_interval)
        self._molar_density = air.molar_density
        self._age_max = min(settings.age_max, self._parcels.end - self._parcels.start)
        winds = (self._parcels.wind_min, self._parcels.wind_max)
        self._table = SpreadTable(emission, air, source_height, winds, self._age_max, settings)
        across, up, within = np.random.SeedSequence(seed).spawn(3)
        path_end = self._parcels.path_end
        self._across = self._up = None
        if settings.meander and not settings.mean:
            self._across = Meander(
                0.0,
                path_end,
                settings.meander_length_across * source_height,
                np.random.default_rng(across),
            )
            self._up = Meander(
                0.0, path_end, settings.meander_length_up * source_height, np.random.default_rng(up)
            )
        self._structure = None
        if settings.structure_intensity > 0.0 and not settings.mean:
            length = settings.structure_length
            along = length * self._table.typical_spread
            self._structure = Structure(
                settings.structure_intensity, along, length, np.random.default_rng(within)
            )

    @property
    def wind_min(self) -> float:
        """Least apparent wind on the track [m/s]; below 2 m/s the spreads are beyond their range."""
        return self._parcels.wind_min

    def sample(self, time: Array, north: Array, east: Array, up: Array) -> PlumeSample:
        """Return the plume at times and places in any order; each place's result is its own,
        whatever the others are.

        Parameters
        ----------
        time : [s], within the track's, shape (m,)
        north, east : in the frame of the air mass [m], shape (m,)
        up : above the sea [m], at least 0, shape (m,)

        Raises
        ------
        MeasurementError : shapes differ, values are missing, a time is not within the track's, or a
            place is below the sea
        """
        given = [np.asarray(values, dtype=np.float64) for values in (time, north, east, up)]
        self._check(*given)
        values = np.empty((len(fields(PlumeSample)), len(given[0])))
        for start in range(0, len(given[0]), _CHUNK):
            part = slice(start, start + _CHUNK)
            values[:, part] = self._chunk(*(each[part] for each in given))
        return PlumeSample(*values)

    def axis(self, time: float, age: Array) -> tuple[Array, Array, Array]:
        """Return north and east in the frame of the air mass, and height above the sea, of the mean
        axis at a time [m].

        Parameters
        ----------
        time : [s], within the track's
        age : of the parcels [s], at least 0 and at most the time since the track's start, and the
            settings' ``age_max``

        Raises
        ------
        MeasurementError : time or age out of range
        """
        age = np.asarray(age, dtype=np.float64)
        self._check_times(np.array([time]))
        oldest = min(self._age_max, time - self._parcels.start)
        if age.size and not (age.min() >= 0.0 and age.max() <= oldest):
            raise MeasurementError(
                f"age on the plume's axis is {age.min():g} to {age.max():g} s; at {time:g} s there are 0 to {oldest:g}: "
                "begin the ship's track earlier"
            )
        north, east, wind = self._parcels.at(time - age)
        return north, east, self._table.at(wind, age)[0]

    def _chunk(self, time: Array, north: Array, east: Array, up: Array) -> Array:
        """Fields of the sample, in their order, shape (fields, m)."""
        parcels = self._parcels.nearest(
            north, east, float(time.min()) - self._age_max, float(time.max())
        )
        age = time[parcels.place] - parcels.emitted
        alive = (age >= 0.0) & (age <= self._age_max)
        parcels = parcels if alive.all() else parcels.of(alive)
        time, up, place = time[parcels.place], up[parcels.place], parcels.place
        values, distance = self._concentration(
            parcels, time - parcels.emitted, self._parcels.path(time), up
        )
        result = np.full((len(values), len(north)), np.nan)
        total = np.bincount(place, values[0], len(north))
        if len(place) > np.count_nonzero(np.bincount(place)):
            # The nearest of several parcels is written last, and stays.
            order = np.argsort(-distance, kind="stable")
            place, values = place[order], values[:, order]
        result[:, place] = values
        result[0] = total
        return result

    def _concentration(
        self, parcels: Nearest, age: Array, passed: Array, up: Array
    ) -> tuple[Array, Array]:
        """Fields of the sample for pairs of a place and a parcel, and the distance to the parcel's
        centre in spreads.
        """
        height, sigma_y, sigma_z, meander_y, meander_z = self._table.at(parcels.wind, age)
        centre, centre_height = np.zeros(len(age)), height
        if self._across is not None and self._up is not None:
            centre = meander_y * self._across.at(parcels.path)
            # Below the sea the centre is its own mirror image.
            centre_height = np.abs(height + meander_z * self._up.at(parcels.path))
        off_y = (parcels.across - centre) / sigma_y
        off_z = (up - centre_height) / sigma_z
        inner = np.maximum(_FOLD, 1.0 - parcels.curvature * parcels.across) * np.maximum(
            _FOLD, 1.0 - parcels.curvature * centre
        )
        middle = 1.0 / (
            2.0 * math.pi * self._molar_density * parcels.wind * np.sqrt(inner) * sigma_y * sigma_z
        )
        square = off_y**2 + off_z**2
        image = np.exp(-2.0 * up * centre_height / sigma_z**2)
        dilution = middle * np.exp(-0.5 * square) * (1.0 + image)
        if self._structure is not None:
            inside = np.flatnonzero(square < _EDGE**2)
            dilution[inside] *= self._structure.factor(
                parcels.path[inside], off_y[inside], off_z[inside]
            )
        axis = middle * (1.0 + np.exp(-2.0 * (centre_height / sigma_z) ** 2))
        sample = (
            dilution,
            axis,
            age,
            passed - parcels.path,
            parcels.across,
            height,
            centre,
            centre_height,
            sigma_y,
            sigma_z,
        )
        return np.stack(sample), square

    def _check(self, time: Array, north: Array, east: Array, up: Array) -> None:
        if not (time.ndim == 1 and time.shape == north.shape == east.shape == up.shape):
            shapes = ", ".join(str(values.shape) for values in (time, north, east, up))
            raise MeasurementError(
                f"time, north, east and up have shapes {shapes}; give four of one length"
            )
        if not all(np.isfinite(values).all() for values in (time, north, east, up)):
            raise MeasurementError(
                "times or places in the plume are missing or infinite; remove or fill them"
            )
        self._check_times(time)
        if time.size and up.min() < 0.0:
            raise MeasurementError(f"height above the sea is {up.min():g} m; give 0 or more")

    def _check_times(self, time: Array) -> None:
        if time.size and not (
            time.min() >= self._parcels.start and time.max() <= self._parcels.end
        ):
            raise MeasurementError(
                f"time in the plume is {time.min():g} to {time.max():g} s; the ship's track has {self._parcels.start:g} to "
                f"{self._parcels.end:g}: extend the track"
            )
