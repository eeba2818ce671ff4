"""Configuration of a logged flight: instrument, columns, limits, and details of the flight."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from common.tables import (
    MASS_PRESSURE_HPA,
    MASS_TEMPERATURE_C,
    TableError,
    TableFormat,
    table_format,
    unit_factor,
)
from measurement.engine import Engine
from measurement.errors import MeasurementError, check_keys, naming
from measurement.estimate.estimator import check_parameters
from measurement.estimate.result import Method
from measurement.estimate.verdict import LIMITS_PERCENT
from measurement.gases import CARBON_FRACTION, GASES, UNITS
from measurement.log.calibration import HOURS_MOST
from measurement.rules import RULES, DecisionRule
from measurement.sniffer.channel import Channel
from measurement.sniffer.spec import SnifferSpec, channel_of, sensor_of, sensor_preset
from measurement.species import SPECIES, Species, species_of

COLUMNS = {
    "time": "time_s",
    **{gas: f"{gas}_{UNITS[gas]}" for gas in GASES},
    "latitude": "latitude_deg",
    "longitude": "longitude_deg",
    "north": "north_m",
    "east": "east_m",
    "height": "height_m",
}
"""Columns of a logged flight, and their names unless the configuration gives others."""

HUMIDITY = "humidity"
"""Name in ``[columns]`` of the relative humidity of the air [%]."""

_FLIGHT_KEYS = (
    *("vessel", "imo", "mmsi", "latitude_deg", "longitude_deg"),
    *("date", "place", "operator"),
)
"""Keys of the table ``[flight]``; each may be left out."""

_ENGINE_KEYS = (
    *("keel_laid", "rated_rpm", "control_area", "design_speed_mps", "speed_mps", "speed_sd_mps"),
    *("strokes", "residual", "consumption_g_kwh", "consumption_sd"),
)
"""Keys of the table ``[engine]``; each may be left out."""

_KEYS = (
    "calibration_hours",
    "carbon",
    "channels",
    "columns",
    "engine",
    "flight",
    "gases",
    "humidity",
    "instrument",
    "limits_percent",
    "method",
    "missing",
    "rule",
    "scale",
    "serial",
    "table",
    "units",
)

_AIR_KEYS = ("temperature_c", "pressure_hpa")
"""Keys of ``[units]`` beside the gases: the air that masses per volume are of."""

_RULE_KEYS = ("limit_percent", "suspect_percent", "title")
"""Keys of the table ``[rule]``."""

_DEFAULT_INSTRUMENT = "unspecified"
"""Instrument of a flight without a configuration."""


_OTHERS: dict[str, Species] = {name: of for name, of in SPECIES.items() if name != "so2"}
"""Gases beside SO2 whose constants are known."""


@dataclass(frozen=True, kw_only=True)
class FlightDetails:
    """Details of the flight in a configuration; empty or None where they are left out.

    Attributes
    ----------
    vessel, imo, mmsi : of the ship that was measured
    position : latitude and longitude of a ship that lay there [deg]
    day : date of the flight in UTC
    start : of the log's first reading in UTC, or None where only the date is given
    place : in words
    operator : person who flew and measured
    """

    vessel: str = ""
    imo: int | None = None
    mmsi: int | None = None
    position: tuple[float, float] | None = None
    day: date | None = None
    start: datetime | None = None
    place: str = ""
    operator: str = ""


@dataclass(frozen=True, kw_only=True)
class LogConfig:
    """Configuration of a logged flight.

    Attributes
    ----------
    instrument : as the analyst states it
    stated : keys of each channel in the configuration, by gas; None for a preset, whose file lists
        its assumptions
    carbon : mass share of the fuel [-]
    limits_percent : limits for the verdicts [% m/m]
    rule : by which the ship is reported, or None
    method : "regression" or "areas"
    missing : numbers that stand for missing readings in the file, as -9999
    columns : name in the file of each of ``COLUMNS``; that of SO2 may be empty: it was not measured
    scale : factors of gases' columns to ppb, or ppm of CO2; they come before any unit
    units : of gases' columns; those that are not given are in the columns' names or in a row of
        units
    air : temperature [deg C] and pressure [hPa] of the air to which masses per volume refer
    table : how the file is written, as far as it is given
    flight : details that the log cannot show
    species : gases beside SO2 that may be in the log, by name
    channels : of these gases, as far as they are declared; each is in the place of SO2
    engine : of the ship, or None
    carbon_stated : whether the configuration gives the fuel's carbon
    humidity : effect of humid air on the readings of a gas, and its standard deviation, relative to
        them, by gas [-]
    serial : number of the instrument, or empty
    calibration_hours : largest time between a calibration and the flight [h]
    """

    instrument: SnifferSpec = field(default_factory=lambda: sensor_preset(_DEFAULT_INSTRUMENT))
    stated: Mapping[str, tuple[str, ...]] | None = None
    carbon: float = CARBON_FRACTION
    limits_percent: tuple[float, ...] = LIMITS_PERCENT
    rule: DecisionRule | None = None
    method: Method = "regression"
    missing: tuple[float, ...] = ()
    columns: Mapping[str, str] = field(default_factory=lambda: dict(COLUMNS))
    scale: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    air: tuple[float, float] = (MASS_TEMPERATURE_C, MASS_PRESSURE_HPA)
    table: TableFormat = field(default_factory=TableFormat)
    flight: FlightDetails = field(default_factory=FlightDetails)
    species: Mapping[str, Species] = field(default_factory=lambda: dict(_OTHERS))
    channels: Mapping[str, Channel] = field(default_factory=dict)
    engine: Engine | None = None
    carbon_stated: bool = False
    humidity: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    serial: str = ""
    calibration_hours: float = HOURS_MOST

    @property
    def with_sulphur(self) -> bool:
        """Whether SO2 was measured."""
        return bool(self.columns["so2"])

    @property
    def declared(self) -> tuple[str, ...]:
        """Gases beside SO2 that the configuration names: errors of these are errors of the log."""
        return tuple(
            gas
            for gas in self.species
            if gas in {*self.channels, *self.columns, *self.units, *self.scale}
        )


def read_config(path: Path) -> LogConfig:
    """Return the configuration in a TOML file.

    Raises
    ------
    MeasurementError : it cannot be read, has an unknown key, or a value of another kind or out of
        range
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MeasurementError(
            f"'{path}' cannot be read: {error.strerror}; give a TOML file"
        ) from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise MeasurementError(f"'{path}' is not TOML: {error}; correct it") from None
    with naming(path):
        return _config(table, path.stem)


def _config(table: Mapping[str, Any], name: str) -> LogConfig:
    """Return the configuration in a table; ``name`` is that of an instrument in it."""
    check_keys(table, _KEYS, "the configuration")
    species = _species(table)
    columns = _columns(table, species)
    scale = _sub_table(table, "scale", (*GASES, *species))
    for gas, factor in scale.items():
        if not _is_finite(factor) or factor <= 0.0:
            raise MeasurementError(
                f"scale of {gas} is {factor!r}; it must be positive, 1000 for ppm of SO2"
            )
    units_of = dict(UNITS) | {name: of.unit for name, of in species.items()}
    units, air = _units(_sub_table(table, "units", (*units_of, *_AIR_KEYS)), units_of)
    method = table.get("method", "regression")
    carbon = table.get("carbon", CARBON_FRACTION)
    if not _is_finite(carbon):
        raise MeasurementError(
            f"carbon is {carbon!r}; give the mass share of the fuel, 0.85 to 0.875 for most"
        )
    limits = table.get("limits_percent", list(LIMITS_PERCENT))
    if not isinstance(limits, list) or not all(_is_finite(limit) for limit in limits):
        raise MeasurementError(
            f"limits_percent is {limits!r}; give a list of numbers, as in [0.10, 0.50]"
        )
    if len(set(limits)) < len(limits):
        raise MeasurementError(f"limits_percent is {limits!r}; give each limit once")
    check_parameters(method, carbon, limits)
    missing = table.get("missing", [])
    if not isinstance(missing, list) or not all(_is_finite(code) for code in missing):
        raise MeasurementError(f"missing is {missing!r}; give a list of numbers, as in [-9999]")
    given = table.get("instrument", _DEFAULT_INSTRUMENT)
    if not isinstance(given, str | dict):
        raise MeasurementError(
            f"instrument is {given!r}; give the name of a preset, or a table [instrument] with its"
            " channels"
        )
    declared = _declared_channels(table, given, species)
    if isinstance(given, dict) and isinstance(given.get("channels"), dict):
        own = {gas: of for gas, of in given["channels"].items() if gas not in species}
        given = {**given, "channels": own}
    instrument = sensor_of(given, name)
    stated = None
    if isinstance(given, dict):
        stated = {gas: tuple(given["channels"][gas]) for gas in instrument.gases}
    return LogConfig(
        instrument=instrument,
        stated=stated,
        carbon=float(carbon),
        limits_percent=tuple(sorted(float(limit) for limit in limits)),
        rule=_rule(table.get("rule")),
        method=method,
        missing=tuple(float(code) for code in missing),
        columns=columns,
        scale={gas: float(factor) for gas, factor in scale.items()},
        units=units,
        air=air,
        table=_table_format(table),
        flight=_details(_sub_table(table, "flight", _FLIGHT_KEYS)),
        species=species,
        channels=declared,
        engine=_engine(_sub_table(table, "engine", _ENGINE_KEYS)) if "engine" in table else None,
        carbon_stated="carbon" in table,
        humidity=_humidity_effects(table, species),
        serial=_serial(table.get("serial", "")),
        calibration_hours=_hours(table.get("calibration_hours", HOURS_MOST)),
    )


def _serial(given: Any) -> str:
    if not isinstance(given, str | int) or isinstance(given, bool) or not str(given).isprintable():
        raise MeasurementError(f"serial is {given!r}; give the instrument's number as a text")
    return str(given)


def _hours(given: Any) -> float:
    if not _is_finite(given) or not 0.0 < given <= 8760.0:
        raise MeasurementError(f"calibration_hours is {given!r}; give hours, above 0, up to 8760")
    return float(given)


def _humidity_effects(
    table: Mapping[str, Any], species: Mapping[str, Species]
) -> dict[str, tuple[float, float]]:
    """Return the effects of humid air by gas: relative to the reading, and its deviation [-]."""
    found = {}
    for gas, given in _sub_table(table, "humidity", ("so2", *species)).items():
        if (
            not isinstance(given, list)
            or len(given) != 2
            or not all(_is_finite(value) for value in given)
            or not (-90.0 <= given[0] <= 90.0 and 0.0 <= given[1] <= 90.0)
        ):
            raise MeasurementError(
                f"humidity.{gas} is {given!r}; give its effect on the reading and the standard"
                " deviation of that, in per cent, as in [-5.0, 3.0]"
            )
        found[gas] = (given[0] / 100.0, given[1] / 100.0)
    return found


def _species(table: Mapping[str, Any]) -> dict[str, Species]:
    """Return the gases beside SO2: known ones, and those whose constants the configuration has."""
    given = table.get("gases", {})
    if not isinstance(given, dict):
        raise MeasurementError(f"gases is {given!r}; give a table [gases.NAME] of constants")
    found = dict(_OTHERS)
    for name, constants in given.items():
        if name in (*COLUMNS, *_OTHERS, *_AIR_KEYS) or not name.isidentifier():
            raise MeasurementError(f"gases has the name '{name}', which is taken or no word")
        if not isinstance(constants, dict):
            raise MeasurementError(f"gases.{name} is {constants!r}; give a table [gases.{name}]")
        found[name] = species_of(name, constants)
    return found


def _declared_channels(
    table: Mapping[str, Any], instrument: Any, species: Mapping[str, Species]
) -> dict[str, Channel]:
    """Return the channels of other gases, of ``[channels]`` or among those of the instrument."""
    given = table.get("channels", {})
    if not isinstance(given, dict):
        raise MeasurementError(f"channels is {given!r}; give a table [channels.NAME]")
    check_keys(given, tuple(species), "[channels]")
    own = instrument.get("channels", {}) if isinstance(instrument, dict) else {}
    if isinstance(own, dict):
        given = {**{gas: of for gas, of in own.items() if gas in species}, **given}
    return {gas: channel_of(gas, channel) for gas, channel in given.items()}


def _engine(table: Mapping[str, Any]) -> Engine:
    """Return the engine in the table ``[engine]``."""
    values = dict(table)
    if "keel_laid" in values:
        keel = values["keel_laid"]
        day = _parsed(keel) if isinstance(keel, str) else keel
        if not isinstance(day, date):
            raise MeasurementError(f"engine.keel_laid is {keel!r}; give a date, as 2012-05-01")
        values["keel_laid"] = day.date() if isinstance(day, datetime) else day
    for key, value in values.items():
        kind = {"control_area": str, "residual": bool, "keel_laid": date}.get(key)
        if kind is None and not _is_finite(value):
            raise MeasurementError(f"engine.{key} is {value!r}; give a number")
        if kind is not None and not isinstance(value, kind):
            raise MeasurementError(f"engine.{key} is {value!r}; give {_KINDS[kind]}")
    return Engine(**values)


_KINDS = {str: "a text", bool: "true or false", date: "a date"}


def _sub_table(table: Mapping[str, Any], key: str, names: Sequence[str]) -> dict[str, Any]:
    """Return the table under a key, empty if there is none, after checking its keys."""
    found = table.get(key, {})
    if not isinstance(found, dict):
        raise MeasurementError(f"{key} is {found!r}; give a table [{key}]")
    check_keys(found, names, f"[{key}]")
    return found


def _units(
    given: Mapping[str, Any], known: Mapping[str, str]
) -> tuple[dict[str, str], tuple[float, float]]:
    """Return the units of gases whose units are ``known``, and the air of masses per volume.

    The air is its temperature [deg C] and pressure [hPa].
    """
    air = []
    for key, usual, low, high in (
        ("temperature_c", MASS_TEMPERATURE_C, -60.0, 60.0),
        ("pressure_hpa", MASS_PRESSURE_HPA, 300.0, 1200.0),
    ):
        value = given.get(key, usual)
        if not _is_finite(value) or not low <= value <= high:
            raise MeasurementError(
                f"units.{key} is {value!r}; it must be a number from {low:g} to {high:g}"
            )
        air.append(float(value))
    units = {}
    for gas, own in known.items():
        if gas not in given:
            continue
        if not isinstance(given[gas], str):
            raise MeasurementError(f"units.{gas} is {given[gas]!r}; give a unit, as in '{own}'")
        try:
            unit_factor(given[gas], own, gas=gas)
        except TableError as error:
            raise MeasurementError(f"units.{gas}: {error}") from None
        units[gas] = given[gas]
    return units, (air[0], air[1])


def _table_format(table: Mapping[str, Any]) -> TableFormat:
    given = table.get("table", {})
    if not isinstance(given, dict):
        raise MeasurementError(f"table is {given!r}; give a table [table]")
    try:
        return table_format(given)
    except TableError as error:
        raise MeasurementError(str(error)) from None


def _rule(given: Any) -> DecisionRule | None:
    """Return the rule of a name or a table; None without one."""
    if given is None:
        return None
    if isinstance(given, str) and given in RULES:
        return RULES[given]
    if not isinstance(given, dict):
        raise MeasurementError(
            f"rule is {given!r}; give one of {', '.join(RULES)}, or a table [rule] with its"
            " limit_percent and suspect_percent"
        )
    check_keys(given, _RULE_KEYS, "[rule]")
    limit: Any = given.get("limit_percent")
    suspect: Any = given.get("suspect_percent")
    if not _is_finite(limit) or not 0.0 < limit <= 10.0:
        raise MeasurementError(
            f"rule.limit_percent is {limit!r}; give a number above 0, up to 10 % m/m"
        )
    if suspect is not None and not (_is_finite(suspect) and limit <= suspect <= 10.0):
        raise MeasurementError(
            f"rule.suspect_percent is {suspect!r}; give a number from the limit of"
            f" {limit:g} % to 10 % m/m, or leave it out for a guard band"
        )
    title = given.get("title", "as configured")
    if not isinstance(title, str) or not title.isprintable():
        raise MeasurementError(f"rule.title is {title!r}; give a text of one line")
    return DecisionRule(
        name="own",
        title=title,
        limit_percent=float(limit),
        suspect_percent=None if suspect is None else float(suspect),
    )


def _columns(table: Mapping[str, Any], species: Mapping[str, Species]) -> dict[str, str]:
    """Return the column of each quantity; two would share the readings of one."""
    given = _sub_table(table, "columns", (*COLUMNS, *species, HUMIDITY))
    columns = {**COLUMNS, **given}
    used: dict[str, str] = {}
    for key, column in columns.items():
        if not isinstance(column, str):
            raise MeasurementError(f"columns.{key} is {column!r}; give a name")
        if key == "so2" and not column:
            continue
        if column in used:
            raise MeasurementError(
                f"[columns] has the column '{column}' for {used[column]} and for {key}; name"
                " another one for either of them"
            )
        used[column] = key
    return columns


def _details(table: Mapping[str, Any]) -> FlightDetails:
    """Return the details in the table ``[flight]``."""
    words = {key: table.get(key, "") for key in ("vessel", "place", "operator")}
    for key, text in words.items():
        if not isinstance(text, str) or not text.isprintable():
            raise MeasurementError(f"flight.{key} is {text!r}; give a text of one line")
    imo, mmsi = table.get("imo"), table.get("mmsi")
    if imo is not None and not _is_imo_number(imo):
        raise MeasurementError(
            f"flight.imo is {imo!r}; give seven digits whose last is their check digit, as"
            " 9074729, without quotation marks"
        )
    if mmsi is not None and not _has_digits(mmsi, 9):
        raise MeasurementError(
            f"flight.mmsi is {mmsi!r}; give nine digits, as 219000000, without quotation marks"
        )
    day, start = _date(table.get("date"))
    texts = {key: text.strip() for key, text in words.items()}
    return FlightDetails(
        imo=imo, mmsi=mmsi, position=_position(table), day=day, start=start, **texts
    )


def _position(table: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the latitude and longitude of the ship [deg], or None without one."""
    given = []
    for key, most in (("latitude_deg", 90.0), ("longitude_deg", 180.0)):
        if key not in table:
            continue
        value = table[key]
        if not _is_finite(value) or abs(value) > most:
            raise MeasurementError(
                f"flight.{key} is {value!r}; give the ship's, from {-most:g} to {most:g}"
            )
        given.append(float(value))
    if len(given) == 1:
        raise MeasurementError(
            "one of flight.latitude_deg and flight.longitude_deg is given; give both, or neither"
        )
    return (given[0], given[1]) if given else None


def _date(value: Any) -> tuple[date | None, datetime | None]:
    """Return the date in UTC, and the time where it is given."""
    if value is None:
        return None, None
    given = _parsed(value) if isinstance(value, str) else value
    if isinstance(given, datetime) and given.tzinfo is not None:
        start = given.astimezone(UTC)
        return start.date(), start
    if isinstance(given, date) and not isinstance(given, datetime):
        return given, None
    raise MeasurementError(
        f"flight.date is {value!s}; give a date, as 2026-06-01, or a time with its offset, as"
        " 2026-06-01T10:00:00Z"
    )


def _parsed(text: str) -> date | None:
    """Return a date or a time in ISO 8601, or None for another text."""
    for kind in (date, datetime):
        try:
            return kind.fromisoformat(text)
        except ValueError:
            continue
    return None


def _is_imo_number(value: Any) -> bool:
    """Return whether seven digits end in their check digit (IMO resolution A.1117(30))."""
    if not _has_digits(value, 7):
        return False
    *digits, check = (int(digit) for digit in str(value))
    return sum(d * weight for d, weight in zip(digits, range(7, 1, -1), strict=True)) % 10 == check


def _has_digits(value: Any, digits: int) -> bool:
    whole = isinstance(value, int) and not isinstance(value, bool)
    return whole and 10 ** (digits - 1) <= value < 10**digits


def _is_finite(value: Any) -> bool:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return number and math.isfinite(value)
