"""A logged flight, and one estimate of it by the command that the tests of its files share."""

import contextlib
import io
import json
from dataclasses import dataclass
from pathlib import Path

import pytest
from logged_flights import flight_table, run

from measurement.log.calibration import write_calibration
from tests.measurement.log.zero_and_span import calibrated

GOLDEN = """
instrument = "electrochemical"
serial = "7"
rule = "eca_0.13"
[flight]
vessel = "Nordlys"
imo = 9074729
mmsi = 219000000
date = 2026-06-01T10:00:00Z
place = "Kattegat"
operator = "Agency"
latitude_deg = 56.0
longitude_deg = 11.0
[engine]
keel_laid = 2012-05-01
rated_rpm = 120
design_speed_mps = 8.0
speed_mps = 7.0
"""


@pytest.fixture
def logged(tmp_path):
    path = tmp_path / "flight.csv"
    flight_table().to_csv(path, index=False)
    (tmp_path / "instrument.toml").write_text('instrument = "electrochemical"\n', encoding="utf-8")
    return path


@dataclass(frozen=True)
class Golden:
    """An estimate by the command: its log and files, and what it printed."""

    log: Path
    printed: str

    def json(self, name):
        return json.loads((self.log.parent / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def golden(tmp_path_factory):
    """Return the estimate of two minutes with other gases, places, a calibration and a record."""
    folder = tmp_path_factory.mktemp("golden")
    log = folder / "flight.csv"
    flight_table(rows=121, gases=True).to_csv(log, index=False)
    (folder / "instrument.toml").write_text(GOLDEN, encoding="utf-8")
    before = calibrated(folder / "zero.csv", gain=1.0, t90=20.0, delay=1.0)
    write_calibration(folder / "before.json", before)
    (folder / "ship.png").write_bytes(b"a picture")
    words = ["--record", "record.json", "--picture", "ship.png", "--calibration", "before.json"]
    printed = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed):
        assert run(log, *words) == 0
    return Golden(log, printed.getvalue())
