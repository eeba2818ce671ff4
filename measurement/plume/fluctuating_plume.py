"""The plume of one flight: one realisation, the same for a seed, at any time and place."""

import math
from collections.abc import Iterator
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from measurement.emission import Emission
from measurement.errors import MeasurementError, check_range
from measurement.plume.parcels import Nearest, Parcels, check_arrays, cubic_value, cubics
from measurement.plume.spread import (
    SOURCE_HEIGHT_MAX,
    SOURCE_HEIGHT_MIN,
    Array,
    MarineAir,
    PlumeSettings,
    SpreadTable,
)

HIT = 0.6
"""Least concentration at the peak of a pass that counts as a hit, over that on the axis [-]."""

FOUND_WITHIN = 300.0
"""Time on the orbit within which the plume has to be found [s]."""

_CHUNK = 4096
"""Number of places that are computed at a time: their arrays stay in the processor's cache."""

_EDGE = 4.0
"""Distance from the centre within which there are fluctuations, in spreads [-]; beyond it, 3e-4 of
the gas is left.
"""

_FOLD = 0.5
"""Least share of a parcel's length inside a bend [-]: agrees best with puffs, of 0.1 to 1."""

_STEPS_PER_LENGTH = 8.0
"""Steps of the meander per correlation length [-]: cubics are good to 1e-4 standard deviations."""

_WAVES = 64
"""Number of waves in the field of fluctuations: enough for a Gaussian sum."""

_WAVE_CHUNK = 512
"""Number of places whose waves are summed at a time: their phases stay in the processor's cache."""

_TURN = 2.0 * math.pi


class PlumeSample(NamedTuple):
    """The plume at times and places, arrays of shape (m,).

    Where no parcel's cross-section goes through a place (upwind of the stack, beyond the oldest
    parcel) the dilution is 0 and what belongs to a parcel is NaN. Where several do, as behind a
    ship that has turned, their dilutions are added, and the other values are those of the parcel
    that is nearest in its spreads.

    Attributes
    ----------
    dilution : mole fraction of a gas over its emission [s/mol]: times ``emission.rates[j]`` it is
        the excess of gas j
    axis_dilution : the same in the centre of this realisation's cross-section, without fluctuations
        within the plume
    age, distance : of the parcel [s], and along the line of parcels back to the stack [m]
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


class PlumeLine(NamedTuple):
    """Parcels of one realisation, arrays of shape (n,), and how any parcel grows with its age.

    A parcel stays where it was emitted in the frame of the air mass. At an age its centre is
    ``meander_y * across`` off the axis, along the apparent wind turned +90 degrees north to east,
    and ``abs(height + meander_z * up)`` above the sea.

    Attributes
    ----------
    emitted : time of emission, in even steps [s]
    step : between them [s]
    north, east : place in the frame of the air mass [m]
    wind : apparent wind at emission [m/s]
    across, up : deviation of the centre, in standard deviations of the meander [-]
    winds : apparent winds of the table, geometrically even [m/s], shape (w,)
    age_max : age of the table's last column; the first one is of age 0 [s]
    table : height of the axis, spreads across and up, and meander across and up [m],
        shape (w, ages, 5)
    """

    emitted: Array
    step: float
    north: Array
    east: Array
    wind: Array
    across: Array
    up: Array
    winds: Array
    age_max: float
    table: Array


class FluctuatingPlume:
    """Gifford's fluctuating plume: a Gaussian about a centre that leaves the mean axis.

    In the frame of the air mass a parcel stays where it was emitted, so that a wind that changes, a
    ship that turns, and a velocity common to all need no extra terms. It rises and spreads with its
    age, in the turbulence of the true wind and the apparent wind at its emission. Its deviation
    from the axis is frozen at emission: the standard deviation of the meander at its age, times a
    process along the air that had passed the stack before it. A place has the concentration of the
    nearest parcel of the line,

        chi = Q/(2 pi U sigma_y sigma_z n) exp(-(y - y_c)^2/2 sigma_y^2)
              [exp(-(z - z_c)^2/2 sigma_z^2) + exp(-(z + z_c)^2/2 sigma_z^2)]

    with n = p/RT, reflected at the sea; a centre below the sea is its mirror image. Where the line
    bends with a curvature k, U is replaced by U sqrt((1 - k y)(1 - k y_c)), same as in a sum of
    puffs.

    More than 100 m behind a ship that turns round, it differs from that sum by at most 1 to 5 % of
    the largest concentration where the apparent wind is 4 m/s or more, and by up to 20 % where the
    line folds with a radius of little more than the spread. The ratio of gases is exact everywhere.

    Parameters
    ----------
    emission : source; the concentration is per its rates
    air : turbulence, from the true wind
    time : [s], increasing, shape (n,); the plume ends with the parcel of the first time, so that it
        must be well before the flight
    north, east : place of the stack in the frame of the air mass [m], shape (n,): place over
        ground minus the integral of the wind
    source_height : of the stack's mouth above the sea [m]
    settings : constants and options
    seed : of the realisation, at least 0; one seed, one plume

    Raises
    ------
    MeasurementError : the track cannot be used, or the apparent wind is below 1 m/s anywhere on it,
        where a plume has no direction. The spreads hold from 2 m/s on

    Notes
    -----
    Source: F. A. Gifford, Advances in Geophysics 6:117 (1959). For rise and spreads see
    ``measurement.plume.spread``.
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
        limits = SOURCE_HEIGHT_MIN, SOURCE_HEIGHT_MAX
        check_range("height of the source", source_height, *limits, " m")
        if seed < 0:
            raise MeasurementError(f"seed of the plume is {seed}; it must be 0 or more")
        self._parcels = Parcels(time, north, east, settings.parcel_interval)
        self._molar_density = air.molar_density
        self._age_max = min(settings.age_max, self._parcels.end - self._parcels.start)
        winds = (self._parcels.wind_min, self._parcels.wind_max)
        self._table = SpreadTable(emission, air, source_height, winds, self._age_max, settings)
        self._across = self._up = self._structure = None
        if settings.mean:
            return
        across, up, within = (
            np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(3)
        )
        path_end = self._parcels.path_end
        if settings.meander:
            self._across = Meander(path_end, settings.meander_length_across * source_height, across)
            self._up = Meander(path_end, settings.meander_length_up * source_height, up)
        if settings.structure_intensity > 0.0:
            self._structure = Structure(
                settings.structure_intensity,
                length_along=settings.structure_length * self._table.typical_spread,
                length_across=settings.structure_length,
                generator=within,
            )

    def sample(self, time: Array, north: Array, east: Array, up: Array) -> PlumeSample:
        """Return the plume at times and places in any order, each independent of the others.

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
        values = np.empty((len(PlumeSample._fields), len(given[0])))
        for start in range(0, len(given[0]), _CHUNK):
            part = slice(start, start + _CHUNK)
            values[:, part] = self._chunk(*(each[part] for each in given))
        return PlumeSample(*values)

    def axis(self, time: float, age: Array) -> tuple[Array, Array, Array]:
        """Return north and east in the air mass, and height above the sea, of the mean axis [m].

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
                f"age on the plume's axis is {age.min():g} to {age.max():g} s; "
                f"at {time:g} s there are 0 to {oldest:g} s: begin the ship's track earlier"
            )
        north, east, wind = self._parcels.at(time - age)
        return north, east, self._table.at(wind, age).height

    def line(self, end: float, *, length: float, spacing: float, ages: int = 25) -> PlumeLine:
        """Return the parcels that are seen until a time, emitted at even steps.

        Parameters
        ----------
        end : time of the last parcel, within the track's [s]; the first one is the oldest that is
            seen at time 0
        length, spacing : of the line, and between parcels, in a wind as on the average [m]
        ages : columns of the table of spreads
        """
        self._check_times(np.array([end]))
        typical = self._parcels.path_end / (self._parcels.end - self._parcels.start)
        oldest, step = min(self._age_max, length / typical), spacing / typical
        first = math.ceil(max(-oldest, self._parcels.start) / step)
        emitted = step * np.arange(first, math.floor(end / step) + 1, dtype=np.float64)
        north, east, wind = self._parcels.at(emitted)
        path = self._parcels.path(emitted)
        across, up = (
            np.zeros(len(emitted)) if process is None else process.at(path)
            for process in (self._across, self._up)
        )
        winds = self._table.winds
        age = np.linspace(0.0, oldest, ages)
        table = np.stack(
            [np.stack(self._table.at(np.full(ages, wind), age), axis=-1) for wind in winds]
        )
        return PlumeLine(emitted, step, north, east, wind, across, up, winds, oldest, table)

    def _chunk(self, time: Array, north: Array, east: Array, up: Array) -> Array:
        """Return the rows of a ``PlumeSample``, shape (fields, m)."""
        parcels = self._parcels.nearest(
            north, east, float(time.min()) - self._age_max, float(time.max())
        )
        age = time[parcels.place] - parcels.emitted
        alive = (age >= 0.0) & (age <= self._age_max)
        if not alive.all():
            parcels = parcels.where(alive)
        time, up, place = time[parcels.place], up[parcels.place], parcels.place
        sample, square = self._concentration(
            parcels, time - parcels.emitted, self._parcels.path(time), up
        )
        values = np.stack(sample)
        result = np.full((len(values), len(north)), np.nan)
        total = np.bincount(place, sample.dilution, len(north))
        if len(place) > np.count_nonzero(np.bincount(place)):
            # The nearest of several parcels is written last, and stays.
            order = np.argsort(-square, kind="stable")
            place, values = place[order], values[:, order]
        result[:, place] = values
        result[PlumeSample._fields.index("dilution")] = total
        return result

    def _concentration(
        self, parcels: Nearest, age: Array, passed: Array, up: Array
    ) -> tuple[PlumeSample, Array]:
        """Return the plume for pairs of place and parcel, and their distance squared in spreads."""
        height, sigma_y, sigma_z, meander_y, meander_z = self._table.at(parcels.wind, age)
        centre, centre_height = np.zeros(len(age)), height
        if self._across is not None and self._up is not None:
            centre = meander_y * self._across.at(parcels.path)
            # Below the sea the mirror image of the centre stands for it.
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
        sample = PlumeSample(
            dilution=dilution,
            axis_dilution=middle * (1.0 + np.exp(-2.0 * (centre_height / sigma_z) ** 2)),
            age=age,
            distance=passed - parcels.path,
            across=parcels.across,
            axis_height=height,
            centre_across=centre,
            centre_height=centre_height,
            sigma_y=sigma_y,
            sigma_z=sigma_z,
        )
        return sample, square

    def _check(self, time: Array, north: Array, east: Array, up: Array) -> None:
        check_arrays("time, north, east and up in the plume", time, north, east, up)
        self._check_times(time)
        if time.size and up.min() < 0.0:
            raise MeasurementError(f"height above the sea is {up.min():g} m; it must be 0 or more")

    def _check_times(self, time: Array) -> None:
        if time.size and not (
            time.min() >= self._parcels.start and time.max() <= self._parcels.end
        ):
            raise MeasurementError(
                f"time in the plume is {time.min():g} to {time.max():g} s; the ship's track has "
                f"{self._parcels.start:g} to {self._parcels.end:g} s: extend the track"
            )


class Meander:
    """A smooth Gaussian process of unit variance along the air that has passed the stack.

    Its covariance over a path l is (1 + |l|/L) exp(-|l|/L), its integral scale 2 L: Matern's
    process of order 3/2. It is the solution of a linear equation with two states, value and slope,
    which is discretised exactly and started in its stationary state. Between the steps it is the
    cubic with their values and slopes, so that it has no corners and can be evaluated anywhere.

    Parameters
    ----------
    length : of the path, which begins at 0 [m]
    integral_scale : 2 L [m], above 0
    generator : source of its randomness
    """

    def __init__(
        self, length: float, integral_scale: float, generator: np.random.Generator
    ) -> None:
        correlation_length = 0.5 * integral_scale
        self._step = correlation_length / _STEPS_PER_LENGTH
        count = math.ceil(length / self._step) + 2
        value, slope = _meander_states(count, self._step / correlation_length, generator)
        slope *= self._step / correlation_length
        self._cubics = np.ascontiguousarray(cubics(value, slope).T)

    def at(self, path: Array) -> Array:
        """Return the process at places from 0 to the end of the path [m], shape (n,)."""
        steps = path / self._step
        index = steps.astype(np.intp)
        return cubic_value(self._cubics.take(index, axis=0).T, steps - index)


def _meander_states(count: int, step: float, generator: np.random.Generator) -> tuple[Array, Array]:
    """Return value and slope at ``count`` steps, with the correlation length as unit of the path.

    w = value + slope and value are first-order: dw = -w dl + noise, d value = (w - value) dl.
    """
    decay = math.exp(-step)
    stationary = np.array([[1.0, 1.0], [1.0, 2.0]])
    transition = decay * np.array([[1.0, step], [0.0, 1.0]])
    noise = np.linalg.cholesky(
        stationary - transition @ stationary @ transition.T
    ) @ generator.standard_normal((2, count))
    noise[:, 0] = np.linalg.cholesky(stationary) @ generator.standard_normal(2)
    total = _first_order(noise[1], decay)
    noise[0, 1:] += decay * step * total[:-1]
    value = _first_order(noise[0], decay)
    return value, total - value


def _first_order(noise: Array, decay: float) -> Array:
    """Return x_k = decay x_(k-1) + noise_k; scipy.signal takes a second to import."""
    return np.fromiter(
        accumulate(noise.tolist(), lambda state, kick: decay * state + kick), np.float64, len(noise)
    )


class Structure:
    """Fluctuations within a plume: one log-normal factor of mean 1 for all gases.

    exp(s g - s^2/2) with s^2 = ln(1 + i^2), of intensity i, and a Gaussian field g of unit
    variance: a sum of 64 waves with covariance exp(-r^2/2 L^2). It is frozen at emission: the
    coordinate along the plume is the path of air that has passed the stack, those across are
    distances from the centre.

    Parameters
    ----------
    intensity : i, standard deviation over mean [-]
    length_along : L along the plume [m]
    length_across : L across, in relative spreads [-]
    generator : source of its randomness
    """

    def __init__(
        self,
        intensity: float,
        length_along: float,
        length_across: float,
        generator: np.random.Generator,
    ) -> None:
        self._deviation = math.sqrt(math.log1p(intensity**2))
        scale = np.array([length_along, length_across, length_across])
        # In turns per metre and per spread, a column for each direction.
        self._waves = (generator.standard_normal((_WAVES, 3)) / (_TURN * scale)).T[:, :, np.newaxis]
        self._phases = generator.uniform(0.0, 1.0, (_WAVES, 1))

    def factor(self, path: Array, across: Array, up: Array) -> Array:
        """Return the factor on the concentration [-], shape (n,).

        Parameters
        ----------
        path : air that has passed the stack until emission [m], shape (n,)
        across, up : from the centre, in relative spreads [-], shape (n,)
        """
        field = np.empty(len(path))
        by_path, by_across, by_up = self._waves
        for start in range(0, len(path), _WAVE_CHUNK):
            part = slice(start, start + _WAVE_CHUNK)
            turns = (
                self._phases + by_path * path[part] + by_across * across[part] + by_up * up[part]
            )
            turns -= np.rint(turns)
            # Cosines of single precision are good to 1e-6 and take a tenth of the time.
            field[part] = np.cos((_TURN * turns).astype(np.float32)).sum(axis=0, dtype=np.float64)
        field *= math.sqrt(2.0 / _WAVES)
        result: Array = np.exp(self._deviation * field - 0.5 * self._deviation**2)
        return result


def passes(across: Array) -> Iterator[slice]:
    """Yield the samples of each pass through the plume.

    A pass runs from half-way since the last change of sides to half-way to the next. The first and
    the last pass are as long outwards as inwards. A change of sides directly after the one before
    makes no pass, because no sample is between them.

    Parameters
    ----------
    across : distance from the plume's axis, positive on one side, NaN where there is no plume,
        shape (n,) [m]
    """
    change = np.flatnonzero(across[:-1] * across[1:] < 0.0)
    if not len(change):
        return
    middle = (change[:-1] + change[1:]) // 2 + 1
    first, last = 0, len(across)
    if len(middle):
        first = max(first, 2 * change[0] - middle[0])
        last = min(last, 2 * change[-1] - middle[-1])
    for begin, end in zip([first, *middle], [*middle, last], strict=True):
        if end > begin:
            yield slice(int(begin), int(end))
