"""Humid air: its effect on a gas where that is stated, and no verdict where it is not.

Of eight systems that measured side by side at the Elbe seven read too little sulphur, possibly in
air of more than 80 % relative humidity (Beecken et al., AMT 16:5883, 2023, doi
10.5194/amt-16-5883-2023). A log without humidity allows no conclusion.
"""

import math
from dataclasses import replace

import numpy as np

from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array

HUMID_PERCENT = 80.0
"""Least relative humidity whose effect has to be stated [%]."""


def is_humid(humidity: Array | None) -> bool:
    """Return whether the air was humid in half of the rows with a humidity."""
    if humidity is None or not np.isfinite(humidity).any():
        return False
    return float(np.nanmedian(humidity)) > HUMID_PERCENT


def in_humid_air(channel: Channel, effect: tuple[float, float] | None) -> tuple[Channel, str]:
    """Return a channel in humid air, and the reason why there can be no verdict, or an empty text.

    Parameters
    ----------
    effect : on the reading, relative to it, and its standard deviation [-]; None if not stated
    """
    if effect is None:
        return channel, (
            f"the air had more than {HUMID_PERCENT:g} % relative humidity, and its effect on"
            " {gas} is not stated; give it in [humidity]"
        )
    share, deviation = effect
    gain_sd = math.hypot(channel.gain_sd, deviation / (1.0 + share))
    return replace(channel, gain=channel.gain * (1.0 + share), gain_sd=gain_sd), ""
