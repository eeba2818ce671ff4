"""The record of an estimate to hand over: result, people, instrument and hashes.

``record-1.json`` in ``measurement/schemas`` is its JSON Schema. The entry ``sha256`` of a record is
that of its other entries, so that a changed figure is noticed:

    bare = {key: value for key, value in record.items() if key != "sha256"}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"))
    hashlib.sha256(text.encode()).hexdigest()

With it comes a CSV with the items of a sulphur inspection in THETIS-EU. Their list is public;
nobody has approved that this table fits into that system.
"""

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from common.files import write_whole
from common.provenance import provenance
from measurement.errors import MeasurementError
from measurement.estimate.gas import SCREENING, GasEstimate
from measurement.estimate.result import FscEstimate, plain
from measurement.estimate.verdict import Verdict
from measurement.gases import MASS_PERCENT, limit_words
from measurement.log.analysis import Analysis, GasAnalysis
from measurement.log.calibration import Calibration
from measurement.log.config import LogConfig
from measurement.log.hashed import HashedFile, content_hash, with_hash, write_hashed
from measurement.log.read import LoggedFlight
from measurement.log.run_files import sha256, version
from measurement.sniffer.spec import SnifferSpec
from measurement.species import SPECIES

FORMAT = "plume-flight record"
"""Entry of a record with its kind."""

VERSION = 1
"""Version of the record, and of its schema."""

NOT_APPROVED = "not approved by anybody"
"""Remark in the table of inspection items."""

SCOPE = f"Measured in a ship's plume: {SCREENING}."
"""Remark on the significance of the figures of a record."""

THETIS_SOURCE = (
    "EU coast guard functions, maritime data catalogue, item 5.02, THETIS-EU sulphur"
    " (coastguard.europa.eu)"
)
"""Public address of the list of inspection items."""


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a record."""
    path = files("measurement").joinpath("schemas", f"record-{VERSION}.json")
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


def record_of(
    flight: LoggedFlight,
    analysis: Analysis | GasAnalysis,
    config: LogConfig,
    *,
    inputs: Mapping[Path, str],
    calibrations: Sequence[Calibration] = (),
    pictures: Sequence[Path] = (),
) -> dict[str, Any]:
    """Return the record of an estimate, with the hash of its content.

    Parameters
    ----------
    inputs : files that were read, and the role of each, such as "log"
    calibrations : that were applied
    pictures : of the ship

    Raises
    ------
    MeasurementError : a file cannot be read
    """
    about = flight.about.record()
    details = about["details"]
    program = provenance()
    figures = [_figure(of) for of in analysis.gases]
    decision = None
    if isinstance(analysis, Analysis):
        figures.insert(0, _sulphur(analysis.estimate))
        decision = None if analysis.decision is None else asdict(analysis.decision)
    content = {
        "format": FORMAT,
        "version": VERSION,
        "ship": {"name": details["vessel"], "imo": details["imo"], "mmsi": details["mmsi"]},
        "time": {
            "first_utc": about["first_utc"],
            "last_utc": about["last_utc"],
            "day": details["day"],
            "by": about["utc_from"],
        },
        "place": {
            "name": details["place"],
            "first_deg": _listed(about["first_position"]),
            "last_deg": _listed(about["last_position"]),
            "ship": list(about["ships"]),
        },
        "operator": details["operator"],
        "figures": figures,
        "decision": decision,
        "instrument": {
            "name": config.instrument.name,
            "title": config.instrument.title,
            "serial": config.serial,
            "sha256": instrument_hash(config.instrument),
        },
        "calibrations": [
            {
                "time_utc": of.content()["time_utc"],
                "serial": of.serial,
                "log": of.source,
                "log_sha256": of.source_sha256,
                "sha256": of.sha256,
            }
            for of in calibrations
        ],
        "inputs": [
            {"what": what, "name": path.name, "sha256": _file_hash(path)}
            for path, what in inputs.items()
        ],
        "pictures": [{"path": path.as_posix(), "sha256": _file_hash(path)} for path in pictures],
        "program": {
            "name": "plume-flight-study",
            "version": version(),
            "revision": str(program["git_revision"]),
        },
        "scope": SCOPE,
    }
    content = json.loads(json.dumps(plain(content)))
    return with_hash(content)


def instrument_hash(instrument: SnifferSpec) -> str:
    """Return the hash of an instrument's properties as they were used."""
    return content_hash(plain(asdict(instrument)))


def _listed(position: Any) -> list[float] | None:
    return None if position is None else list(position)


def _file_hash(path: Path) -> str:
    try:
        return sha256(path.read_bytes())
    except OSError as error:
        raise MeasurementError(
            f"'{path}' cannot be read: {error.strerror}; the record has a hash of each file"
        ) from None


def _sulphur(found: FscEstimate) -> dict[str, Any]:
    """Return the sulphur content of the fuel."""
    species = SPECIES["so2"]
    return {
        "gas": species.name,
        "figure": species.figure,
        "unit": MASS_PERCENT,
        "value": found.fsc_percent,
        "standard_uncertainty": found.total_percent,
        "low_95": found.low_percent,
        "high_95": found.high_percent,
        "parts": {"noise": found.noise_percent, **found.common_percent},
        "slope": found.slope_ppb_per_ppm,
        "slope_unit": species.slope_unit,
        "quality": found.quality,
        "reasons": list(found.quality_reasons),
        "verdicts": [
            _verdict_entry(
                f"sulphur in the fuel, limit of {limit_words(verdict.limit_percent)}", verdict
            )
            for verdict in found.verdicts
        ],
        "no_verdict": "",
        "source": species.source,
    }


def _figure(found: GasEstimate) -> dict[str, Any]:
    """Return the figure of another gas."""
    verdicts = []
    if found.verdict is not None and found.stage is not None:
        rule = (
            f"MARPOL Annex VI, regulation 13, stage {found.stage.stage};"
            f" {found.stage.cycle_g_kwh:.2f} g/kWh over the test cycle"
        )
        verdicts.append(_verdict_entry(rule, found.verdict))
    return {
        "gas": found.gas,
        "figure": found.figure,
        "unit": found.unit,
        "value": found.value,
        "standard_uncertainty": found.total,
        "low_95": found.low,
        "high_95": found.high,
        "parts": {"noise": found.noise, **found.common},
        "slope": found.slope,
        "slope_unit": found.slope_unit,
        "quality": found.quality,
        "reasons": list(found.quality_reasons),
        "verdicts": verdicts,
        "no_verdict": "" if verdicts else found.no_verdict,
        "source": found.source,
    }


def _verdict_entry(rule: str, found: Verdict) -> dict[str, Any]:
    """Return a verdict on a limit by a rule."""
    return {
        "limit": found.limit,
        "rule": rule,
        "verdict": found.verdict,
        "probability_above": found.probability_above,
        "false_alarm": found.false_alarm,
        "miss": found.miss,
    }


# Files

_FILE = HashedFile(
    name="record",
    kind=("format", FORMAT),
    version=("version", VERSION),
    version_words="version",
    made_by="a file of estimate --record",
)


def write_record(path: Path, record: Mapping[str, Any]) -> Path:
    """Write a record and the table of inspection items; return the path of the table.

    Raises
    ------
    MeasurementError : one cannot be written
    """
    table = path.with_suffix(".thetis-eu.csv")
    try:
        write_hashed(path, record)
        write_whole(table, lambda part: part.write_text(items_csv(record), encoding="utf-8"))
    except OSError as error:
        raise MeasurementError(f"'{path}' cannot be written: {error.strerror}") from None
    return table


def read_record(path: Path) -> dict[str, Any]:
    """Return the record of a file, after checking that nothing in it was changed.

    Raises
    ------
    MeasurementError : it cannot be read, is none, is of another version, or was changed
    """
    return _FILE.read(path)


def items_csv(record: Mapping[str, Any]) -> str:
    """Return the items of a sulphur inspection as a table: item, value and source."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["item", "value", "from"])
    rows.writerow(["status of this table", NOT_APPROVED, "this program"])
    rows.writerow(["list of items", THETIS_SOURCE, "this program"])
    rows.writerows(_items(record))
    return text.getvalue()


def _items(record: Mapping[str, Any]) -> Iterator[list[str]]:
    """Yield the public items; those that a measurement from the air cannot know are empty."""
    ship, time, place = record["ship"], record["time"], record["place"]
    configuration, measured, unknown = "configuration", "measurement", "not known from the air"

    def row(item: str, value: Any, source: str) -> list[str]:
        return [item, "" if value is None else str(value), source if value else unknown]

    yield row("name of the ship", ship["name"], configuration)
    yield row("IMO identification number", ship["imo"], configuration)
    for item in (
        *("type of ship", "tonnage (gt)", "year of construction"),
        *("name and address of the company", "flag State", "statutory certificates"),
        "port and date of the last survey",
    ):
        yield row(item, None, unknown)
    yield row("type of inspection", "remote measurement in the plume, no sample", measured)
    yield row("date of inspection", time["first_utc"] or time["day"], time["by"] or configuration)
    yield row("place of inspection", place["name"], configuration)
    position = place["first_deg"]
    words = None if position is None else f"{position[0]:.5f}, {position[1]:.5f}"
    yield row("latitude, longitude [deg]", words, "log")
    yield row("actions taken", None, unknown)
    yield row("record, SHA-256", record["sha256"], measured)
    found = next((of for of in record["figures"] if of["gas"] == "so2"), None)
    if found is None:
        yield row("fuel sulphur content [% m/m]", None, unknown)
        return
    for item, key in (
        (f"fuel sulphur content [{found['unit']}]", "value"),
        (f"standard uncertainty [{found['unit']}]", "standard_uncertainty"),
        ("quality", "quality"),
    ):
        yield row(item, found[key], measured)
    for verdict in found["verdicts"]:
        yield row(f"findings: {verdict['rule']}", verdict["verdict"], measured)
