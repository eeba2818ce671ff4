"""The readings of a sniffer in the air that it flies through."""

import math
from dataclasses import dataclass

import numpy as np

from measurement.errors import MeasurementError
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array, lag, parallel, weights
from measurement.sniffer.spec import SnifferSpec

_DIGITS = 9
"""Decimals of a time in steps: rounding does not move a reading to the next step."""


@dataclass(frozen=True)
class Readings:
    """Readings of a sniffer.

    Attributes
    ----------
    time : shape (m,) [s]
    values : shape (m, 4), in the order of ``GASES`` (ppb, ppm, ppb, ppb); NaN without a channel
    """

    time: Array
    values: Array

    def __len__(self) -> int:
        return len(self.time)


class Sniffer:
    """A sniffer in flight, advanced by the air at its inlet.

    Its readings do not depend on how the air is split into parts.

    Parameters
    ----------
    spec : the instrument; ``SnifferSpec.drawn`` samples one
    generator : for noise and drift
    time_step : between the samples of the air [s]
    """

    def __init__(
        self, spec: SnifferSpec, *, generator: np.random.Generator, time_step: float
    ) -> None:
        if not 0.0 < time_step <= 1.0 / spec.rate_hz + 1e-9:
            raise MeasurementError(
                f"time step is {time_step:g} s; it must be positive and at most the "
                f"{1.0 / spec.rate_hz:g} s between readings of '{spec.name}': "
                "record the air more often"
            )
        if any(math.isnan(channel.noise) for channel in spec.channels):
            raise MeasurementError(f"a noise of '{spec.name}' is not known; give it before reading")
        self._spec = spec
        self._generator = generator
        self._steps_per_reading = 1.0 / (spec.rate_hz * time_step)
        self._states = [_ChannelState(channel, time_step) for channel in spec.channels]
        self._drift = np.zeros(len(spec.channels))
        self._samples = 0
        self._readings = 0

    def advance(self, concentrations: Array, pressure_error_hpa: Array | None = None) -> Readings:
        """Return the readings up to the last of these samples of the air.

        Parameters
        ----------
        concentrations : with the background, shape (n, 4), in the order of ``GASES``; the first is
            a step after the last of the call before
        pressure_error_hpa : pressure in the sensors less that of their calibration, shape (n,);
            0 if not given

        Raises
        ------
        MeasurementError : a value is not finite, or the shapes do not agree
        """
        air = np.asarray(concentrations, dtype=np.float64)
        pressure = (
            np.zeros(len(air))
            if pressure_error_hpa is None
            else np.asarray(pressure_error_hpa, dtype=np.float64)
        )
        if air.ndim != 2 or air.shape[1] != len(GASES) or pressure.shape != air.shape[:1]:
            raise MeasurementError(
                f"concentrations have shape {air.shape}, pressure {pressure.shape}; "
                "they must be (n, 4) and (n,)"
            )
        if not (np.isfinite(air).all() and np.isfinite(pressure).all()):
            raise MeasurementError(
                "a concentration or a pressure error is not finite; give the air at every sample"
            )
        self._samples += len(air)
        end = self._readings
        if len(air):
            last = self._samples - 1
            end = max(end, math.floor(round(last / self._steps_per_reading, _DIGITS)) + 1)
        numbers = np.arange(self._readings, end)
        self._readings = end
        values = np.full((len(numbers), len(GASES)), np.nan)
        noise = self._generator.standard_normal((len(numbers), len(self._states), 2))
        for i, state in enumerate(self._states):
            clean = state.advance(
                air, pressure, np.asarray(numbers * self._steps_per_reading, dtype=np.float64)
            )
            values[:, GASES.index(state.channel.gas)] = self._disturbed(i, clean, noise[:, i])
        return Readings(numbers / self._spec.rate_hz, values)

    def _disturbed(self, i: int, clean: Array, noise: Array) -> Array:
        """Return readings of channel i with noise, drift, resolution and range."""
        channel = self._states[i].channel
        steps = channel.random_walk / math.sqrt(self._spec.rate_hz) * noise[:, 1]
        walk = np.cumsum(np.concatenate([self._drift[i : i + 1], steps]))
        self._drift[i] = walk[-1]
        reading = clean + walk[1:] + channel.noise * noise[:, 0]
        if channel.resolution > 0.0:
            reading = np.round(reading / channel.resolution) * channel.resolution
        return np.asarray(np.clip(reading, channel.range_low, channel.range_high), dtype=np.float64)


class _ChannelState:
    """The lagged response of one channel, without noise, up to the last sample."""

    def __init__(self, channel: Channel, time_step: float) -> None:
        self.channel = channel
        self._step = time_step
        self._lags = parallel(channel.constants)
        self._delay = channel.delay_s / time_step
        # The next reading is later than the last sample, and needs the air its delay earlier.
        self._kept = math.ceil(self._delay) + 2
        self._input = np.empty(0)
        self._outputs = [np.empty(0) for _ in self._lags]
        self._start = 0

    def advance(self, air: Array, pressure: Array, times: Array) -> Array:
        """Return the response at times [steps since the first sample], given further samples."""
        channel = self.channel
        seen = air[:, GASES.index(channel.gas)].copy()
        for gas, share in channel.cross.items():
            seen += share * air[:, GASES.index(gas)]
        new = channel.gain * seen * (1.0 + channel.pressure_effect * pressure) + channel.zero
        if not len(self._input) and len(new):
            # Before the first sample the air was the same.
            self._input = np.full(self._kept, new[0])
            self._outputs = [self._input.copy() for _ in self._lags]
            self._start = -self._kept
        if len(new):
            self._outputs = [
                np.concatenate([old, lag(new, self._step, constant, (old[-1], self._input[-1]))])
                for old, (_, constant) in zip(self._outputs, self._lags, strict=True)
            ]
            self._input = np.concatenate([self._input, new])
        response = self._at(times)
        cut = max(0, len(self._input) - self._kept)
        self._start += cut
        self._input = self._input[cut:]
        self._outputs = [output[cut:] for output in self._outputs]
        return response

    def _at(self, times: Array) -> Array:
        """Return the response between samples, exact for air that is linear between them."""
        if not len(times):
            return np.empty(0)
        when = np.round(times - self._delay, _DIGITS)
        after = np.ceil(when).astype(np.int64)
        share = when - (after - 1)
        i = np.maximum(after - self._start, 1)
        before_input = self._input[i - 1]
        now_input = before_input + share * (self._input[i] - before_input)
        response = np.zeros(len(times))
        for (weight, constant), output in zip(self._lags, self._outputs, strict=True):
            a, old, new = weights(share * self._step, constant)
            response += weight * (a * output[i - 1] + old * before_input + new * now_input)
        return response
