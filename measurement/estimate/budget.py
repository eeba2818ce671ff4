"""Errors that do not average out: the effect of each uncertain property of the instrument."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from measurement.gases import EXPECTED_PPB_PER_PPM
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

CARBON_SD = 0.015
"""Relative standard deviation of a fuel's carbon content [-] (assumption)."""

SAMPLING_SD = 0.02
"""Relative standard deviation by the time between readings, per time constant of CO2 [-].

Without noise, the result of readings 0.6 to 4.6 time constants apart is 0.8 to 3.7 % too high, or
1.1 to 7.7 % where delays differ by half of the interval.
"""

SULPHATE_SHARE = 0.0225
"""Share of sulphur that leaves as sulphate [-], stated and not corrected (IMO GHG4, eq. 15)."""

_CORRECTING = ("no", "no2")


def unmeasured(
    instrument: SnifferSpec, measured: tuple[str, ...], factor: float
) -> dict[str, tuple[float, float]]:
    """Return the effect of NO and NO2 that were not measured, and its deviation, by gas.

    Both are in the unit to which ``factor`` converts a ratio, such as % m/m.
    """
    so2, found = instrument.known("so2"), {}
    for gas in _CORRECTING:
        share, deviation = so2.cross.get(gas, 0.0), so2.cross_sd.get(gas, 0.0)
        if gas not in measured and (share or deviation):
            ratio, ratio_deviation = EXPECTED_PPB_PER_PPM[gas]
            spread = math.sqrt(
                (share * ratio_deviation) ** 2 + deviation**2 * (ratio**2 + ratio_deviation**2)
            )
            found[gas] = factor * share * ratio, factor * spread
    return found


def common_errors(
    instrument: SnifferSpec,
    measured: tuple[str, ...],
    changes: Callable[[SnifferSpec], tuple[float, Array]],
    *,
    timing: bool = True,
) -> tuple[dict[str, float], float]:
    """Return standard uncertainties of the result by name, and the energy that they add to the
    residuals.

    Each gain, response, delay and cross-sensitivity is moved by its standard deviation, and the
    result is computed again; uncertainties of one name add in squares.

    Parameters
    ----------
    instrument : as stated; where response and delay of SO2 are not stated, with the fitted ones
    measured : gases of the record
    changes : differences of result and residuals of another instrument from those of ``instrument``
    timing : whether gain, t90 and delay of SO2 and CO2 are among the errors
    """
    squares: dict[str, float] = {}
    energy = 0.0
    for name, channel in _moved_channels(instrument, measured, timing):
        change, of_residuals = changes(instrument.with_channel(channel))
        squares[name] = squares.get(name, 0.0) + change**2
        energy += float(np.sum(of_residuals**2))
    return {name: math.sqrt(square) for name, square in squares.items()}, energy


def _moved_channels(
    instrument: SnifferSpec, measured: tuple[str, ...], timing: bool
) -> Iterator[tuple[str, Channel]]:
    """Yield name and channel of each error, without properties found from the record (infinite)."""
    for gas in measured:
        channel = instrument.known(gas)
        calibration, response = "calibration", "response"
        if gas in _CORRECTING:
            if not any(instrument.known(main).cross.get(gas, 0.0) for main in ("so2", "co2")):
                continue
            calibration = response = gas
        moves = timing or gas in _CORRECTING
        if moves and channel.gain_sd:
            yield calibration, replace(channel, gain=channel.gain * (1.0 + channel.gain_sd))
        for other, deviation in channel.cross_sd.items():
            if other in measured and deviation:
                cross = {**channel.cross, other: channel.cross.get(other, 0.0) + deviation}
                name = other if other in _CORRECTING else "calibration"
                yield name, replace(channel, cross=cross)
        if moves and 0.0 < channel.t90_sd < math.inf:
            yield response, replace(channel, t90_s=channel.t90_s * (1.0 + channel.t90_sd))
        if moves and 0.0 < channel.delay_sd_s < math.inf:
            yield response, replace(channel, delay_s=channel.delay_s + channel.delay_sd_s)
