"""How a logged flight is to be read: its instrument, its columns, its limits."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from measurement.errors import MeasurementError, guess
from measurement.estimate.estimator import check_parameters
from measurement.estimate.flight_log.details import FlightDetails, read_details
from measurement.estimate.result import Method
from measurement.estimate.verdict import LIMITS_PERCENT
from measurement.gases import CARBON_FRACTION, GASES, UNITS
from measurement.sniffer.spec import SnifferSpec, sensor_of, sensor_preset

COLUMNS = {
    "time": "time_s",
    **{gas: f"{gas}_{UNITS[gas]}" for gas in GASES},
    "latitude": "latitude_deg",
    "longitude": "longitude_deg",
    "north": "north_m",
    "east": "east_m",
    "height": "height_m",
}
"""What a logged flight may hold, and what its columns are called unless the configuration says
otherwise.
"""

DEFAULT_INSTRUMENT = "unspecified"
"""The instrument of a flight without a configuration."""

_KEYS = {
    "instrument",
    "carbon",
    "limits_percent",
    "method",
    "missing",
    "columns",
    "scale",
    "flight",
}


@dataclass(frozen=True, kw_only=True)
class LogConfig:
    """How a logged flight is to be read.

    Attributes
    ----------
    instrument : as the analyst knows it
    stated : keys that the configuration has of each channel, by gas; None of a preset, whose file
        says what is assumed
    carbon : mass share of the fuel [-]
    limits_percent : on which there are to be verdicts [% m/m]
    method : "regression" or "areas"
    missing : numbers that the file has for readings that there are not, as -9999
    columns : name in the file of each of ``COLUMNS``
    scale : by which a gas's column is multiplied to be in ppb, or CO2 in ppm
    flight : what the log cannot tell of the flight
    """

    instrument: SnifferSpec = field(default_factory=lambda: sensor_preset(DEFAULT_INSTRUMENT))
    stated: Mapping[str, tuple[str, ...]] | None = None
    carbon: float = CARBON_FRACTION
    limits_percent: tuple[float, ...] = LIMITS_PERCENT
    method: Method = "regression"
    missing: tuple[float, ...] = ()
    columns: Mapping[str, str] = field(default_factory=lambda: dict(COLUMNS))
    scale: Mapping[str, float] = field(default_factory=dict)
    flight: FlightDetails = field(default_factory=FlightDetails)


def read_config(path: Path) -> LogConfig:
    """Return the configuration in a TOML file.

    Raises
    ------
    MeasurementError : it cannot be read, has a key that is not known, or a value that is not of its
        kind or out of range
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MeasurementError(
            f"'{path}' cannot be read: {error.strerror}; give a TOML file"
        ) from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise MeasurementError(f"'{path}' is not TOML: {error}; correct it") from None
    if unknown := sorted(set(table) - _KEYS):
        raise MeasurementError(
            f"'{path}' has the key '{unknown[0]}'{guess(unknown[0], _KEYS)} it may have {', '.join(sorted(_KEYS))}"
        )
    columns, scale = (
        _table(table, "columns", str, COLUMNS, path),
        _table(table, "scale", (int, float), GASES, path),
    )
    for gas, factor in scale.items():
        if not 0.0 < factor < math.inf:
            raise MeasurementError(
                f"'{path}': scale of {gas} is {factor!r}; it must be positive, 1000 for ppm of SO2"
            )
    _check_once({**COLUMNS, **columns}, columns, path)
    method = table.get("method", "regression")
    limits = table.get("limits_percent", list(LIMITS_PERCENT))
    if not isinstance(limits, list) or not limits or not all(_is_number(limit) for limit in limits):
        raise MeasurementError(
            f"'{path}': limits_percent is {limits!r}; give a list of numbers, as in [0.10, 0.50]"
        )
    if len(set(limits)) < len(limits):
        raise MeasurementError(f"'{path}': limits_percent is {limits!r}; give each limit once")
    missing = table.get("missing", [])
    if not isinstance(missing, list) or not all(_is_number(code) for code in missing):
        raise MeasurementError(
            f"'{path}': missing is {missing!r}; give a list of numbers, as in [-9999]"
        )
    carbon = table.get("carbon", CARBON_FRACTION)
    if not _is_number(carbon):
        raise MeasurementError(
            f"'{path}': carbon is {carbon!r}; give the mass share of the fuel, 0.85 to 0.875 for most"
        )
    try:
        check_parameters(method, carbon, limits)
    except MeasurementError as error:
        raise MeasurementError(f"'{path}': {error}") from None
    given = table.get("instrument", DEFAULT_INSTRUMENT)
    instrument = _instrument(given, path)
    return LogConfig(
        instrument=instrument,
        stated={gas: tuple(given["channels"][gas]) for gas in instrument.gases}
        if isinstance(given, dict)
        else None,
        carbon=float(carbon),
        limits_percent=tuple(sorted(float(limit) for limit in limits)),
        method=method,
        missing=tuple(float(code) for code in missing),
        columns={**COLUMNS, **columns},
        scale={gas: float(factor) for gas, factor in scale.items()},
        flight=read_details(table.get("flight", {}), path),
    )


def _instrument(value: Any, path: Path) -> SnifferSpec:
    try:
        if isinstance(value, str | dict):
            return sensor_of(value, path.stem)
    except MeasurementError as error:
        raise MeasurementError(f"'{path}': {error}") from None
    raise MeasurementError(
        f"'{path}': instrument is {value!r}; give the name of a preset, or a table [instrument] with its channels"
    )


def _table(table: Mapping[str, Any], key: str, kind: Any, names: Any, path: Path) -> dict[str, Any]:
    found = table.get(key, {})
    if not isinstance(found, dict):
        raise MeasurementError(f"'{path}': {key} is {found!r}; give a table [{key}]")
    for name, value in found.items():
        if name not in names:
            raise MeasurementError(
                f"'{path}': [{key}] has the key '{name}'{guess(name, names)} it may have {', '.join(names)}"
            )
        if not isinstance(value, kind) or isinstance(value, bool):
            raise MeasurementError(
                f"'{path}': {key}.{name} is {value!r}; give a {'name' if kind is str else 'number'}"
            )
    return dict(found)


def _check_once(names: Mapping[str, str], given: Mapping[str, str], path: Path) -> None:
    """Refuse a column that is given for two quantities: readings of one would be taken for those of
    the other.
    """
    for key, name in given.items():
        if twice := [other for other, of in names.items() if of == name and other != key]:
            raise MeasurementError(
                f"'{path}': [columns] has the column '{name}' for {key} and for {twice[0]}; name another one for either of them"
            )


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
