"""Knowledge of a flight besides its log: calibrations, humid air, and the speed of its ship."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from measurement.engine import Engine
from measurement.log.calibration import Applied, Calibration, applied
from measurement.log.config import LogConfig
from measurement.log.read import LoggedFlight
from measurement.log.ship import ShipTrack, speed_of
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec, channel_of

HUMID_PERCENT = 80.0
"""Least relative humidity whose effect has to be stated [%].

Of eight systems that measured side by side at the Elbe seven read too little sulphur, possibly in
air of more than 80 % relative humidity (Beecken et al., AMT 16:5883, 2023, doi
10.5194/amt-16-5883-2023). A log without humidity allows no conclusion.
"""


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """A configuration with the knowledge of the flight.

    Attributes
    ----------
    config : with the channels as they were during the flight, and the engine with the ship's speed
    changed : whether channels changed, so that the log has to be read again
    problems : reasons why there can be no verdict on a gas, by gas
    remarks : lines for the reader
    calibrations : that were applied
    """

    config: LogConfig
    changed: bool
    problems: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    calibrations: tuple[Calibration, ...] = ()


def prepare(
    flight: LoggedFlight,
    config: LogConfig,
    calibrations: Sequence[Calibration] = (),
    ships: Sequence[ShipTrack] = (),
) -> Prepared:
    """Return the configuration of a flight with the knowledge of it.

    Raises
    ------
    MeasurementError : a calibration does not hold for the flight
    """
    instrument, channels = config.instrument, dict(config.channels)
    problems: dict[str, list[str]] = {}
    remarks: list[str] = []
    kept: tuple[Calibration, ...] = ()
    if calibrations:
        about = flight.about
        found = applied(
            calibrations,
            instrument=instrument.name,
            serial=config.serial,
            begin=about.first_utc,
            end=about.last_utc,
            hours_most=config.calibration_hours,
        )
        kept = found.calibrations
        instrument = _with_channels(instrument, found)
        for gas in found.gases & {of.species.name for of in flight.gases if of.own_column}:
            channels[gas] = found.channel(gas, channels.get(gas) or channel_of(gas))
        for gas in sorted(found.gases):
            for of in _of(gas, config):
                problems.setdefault(of, []).extend(found.problems(gas))
        remarks += list(_calibration_remarks(found))
    if _is_humid(flight.humidity):
        instrument, channels = _in_humid_air(flight, config, instrument, channels, problems)
    engine = _with_speed(config.engine, flight, ships)
    changed = instrument != config.instrument or channels != dict(config.channels)
    return Prepared(
        config=replace(config, instrument=instrument, channels=channels, engine=engine),
        changed=changed,
        problems={gas: tuple(dict.fromkeys(of)) for gas, of in problems.items() if of},
        remarks=tuple(remarks),
        calibrations=kept,
    )


def _of(gas: str, config: LogConfig) -> tuple[str, ...]:
    """Return the gases whose figure depends on a channel."""
    if gas == "co2":
        return ("so2", *config.species)
    return {"no": ("so2", "nox"), "no2": ("so2", "nox")}.get(gas, (gas,))


def _with_channels(instrument: SnifferSpec, found: Applied) -> SnifferSpec:
    """Return an instrument with its channels as they are calibrated."""
    for channel in instrument.channels:
        instrument = instrument.with_channel(found.channel(channel.gas, channel))
    return instrument


def _calibration_remarks(found: Applied) -> list[str]:
    """Return a line for each calibration, with its findings."""
    lines = []
    for of in found.calibrations:
        gases = ", ".join(gas.upper() for gas in of.channels)
        shown = [remark for channel in of.channels.values() for remark in channel.remarks]
        words = "".join(f"; {remark}" for remark in shown)
        lines.append(
            f"calibration: {gases} of {of.time_utc:%Y-%m-%d %H:%M} UTC, {of.sha256[:12]}{words}"
        )
    return lines


def _is_humid(humidity: Array | None) -> bool:
    """Return whether the air was humid in half of the rows with a humidity."""
    if humidity is None or not np.isfinite(humidity).any():
        return False
    return float(np.nanmedian(humidity)) > HUMID_PERCENT


def _channel_in_humid_air(
    channel: Channel, effect: tuple[float, float] | None
) -> tuple[Channel, str]:
    """Return a channel in humid air, and why there can be no verdict, or an empty text.

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


def _in_humid_air(
    flight: LoggedFlight,
    config: LogConfig,
    instrument: SnifferSpec,
    channels: dict[str, Channel],
    problems: dict[str, list[str]],
) -> tuple[SnifferSpec, dict[str, Channel]]:
    """Return channels in humid air, and add the problems of gases whose effect is not stated."""
    made = {"so2": ("so2",)} | {
        of.species.name: (of.species.name,) if of.own_column else ("no", "no2")
        for of in flight.gases
    }
    for gas, parts in made.items():
        for own in parts:
            channel = instrument.channel(own) or channels.get(own) or channel_of(own)
            changed, problem = _channel_in_humid_air(channel, config.humidity.get(gas))
            if problem:
                problems.setdefault(gas, []).append(problem.format(gas=gas.upper()))
            elif instrument.channel(own):
                instrument = instrument.with_channel(changed)
            else:
                channels[own] = changed
    return instrument, channels


def _with_speed(
    engine: Engine | None, flight: LoggedFlight, ships: Sequence[ShipTrack]
) -> Engine | None:
    """Return the engine with the speed of its ship by AIS, where the configuration has none."""
    about = flight.about
    if engine is None or engine.speed_mps is not None or about.first_utc is None:
        return engine
    end = about.last_utc or about.first_utc
    for ship in ships:
        speed = speed_of(ship, about.first_utc.timestamp(), end.timestamp())
        if speed is not None:
            return replace(engine, speed_mps=speed)
    return engine
