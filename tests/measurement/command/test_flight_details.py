"""Which flight a log is of: date, time, place and ship, by the log and by the configuration."""

import hashlib
import json

import pandas as pd
import pytest
from logged_flights import run

pytestmark = pytest.mark.usefixtures("briefly")

WHOLE = """instrument = "electrochemical"
[flight]
vessel = "Nordlys"
imo = 9074729
mmsi = 219000000
date = 2026-06-01T12:00:00+02:00
place = "Kattegat, east of Anholt"
operator = "Agency"
"""
"""9074729 is the IMO number by which the check digit is commonly explained: 9 7 + 0 6 + 7 5 + 4 4 +
7 3 + 2 2 = 139.
"""


def recorded(logged, config):
    """Estimate a log, and return what its directory says of the flight."""
    (logged.parent / "instrument.toml").write_text(config, encoding="utf-8")
    assert run(logged) == 0
    return json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))[
        "flight"
    ]


def told(logged, capsys, config):
    """Return the line by which an estimate is refused."""
    (logged.parent / "instrument.toml").write_text(config, encoding="utf-8")
    assert run(logged) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    return line


def rewritten(logged, **columns):
    pd.read_csv(logged).assign(**columns).to_csv(logged, index=False)


def since(start):
    return pd.Timestamp(start) + pd.to_timedelta(range(301), unit="s")


def test_a_configuration_names_ship_place_operator_and_the_time_of_the_first_reading(logged):
    found = recorded(logged, WHOLE)
    # The log has 301 readings, a second apart; 12:00 two hours east of Greenwich is 10:00 UTC.
    assert (found["first_utc"], found["last_utc"], found["utc_from"]) == (
        "2026-06-01T10:00:00Z", "2026-06-01T10:05:00Z", "configuration",
    )  # fmt: skip
    expected = {
        "vessel": "Nordlys",
        "imo": 9074729,
        "mmsi": 219000000,
        "place": "Kattegat, east of Anholt",
        "operator": "Agency",
    }
    assert expected.items() <= found["details"].items()
    assert found["readings"] == 301
    assert found["columns"]["so2"] == "so2_ppb"


def test_a_log_of_seconds_with_a_date_alone_has_no_time_of_day(logged):
    found = recorded(logged, 'flight.date = "2026-06-01"\n')
    assert (found["details"]["day"], found["first_utc"], found["utc_from"]) == (
        "2026-06-01",
        None,
        "",
    )
    assert recorded(logged, "")["details"]["day"] is None


@pytest.mark.parametrize(
    ("start", "offset"), [("2026-06-01T10:00:00Z", True), ("2026-06-01T10:00:00", False)]
)
def test_times_and_first_and_last_known_place_of_a_log_are_kept(logged, start, offset):
    places = {"latitude_deg": [None, *(56.0 + 1e-4 * i for i in range(300))], "longitude_deg": 11.5}
    rewritten(logged, time_s=since(start).astype(str), **places)
    found = recorded(logged, "flight.date = 2026-06-01\n")
    assert (found["first_utc"], found["last_utc"], found["utc_from"]) == (
        "2026-06-01T10:00:00Z",
        "2026-06-01T10:05:00Z",
        "log",
    )
    assert found["offset"] is offset
    assert found["first_position"] == [56.0, 11.5]
    assert found["last_position"] == pytest.approx([56.0299, 11.5])


@pytest.mark.parametrize("date", ["2026-06-02", "2026-06-01T10:00:02Z"])
def test_a_date_other_than_that_of_the_log_is_refused(logged, capsys, date):
    rewritten(logged, time_s=since("2026-06-01T10:00:00Z").astype(str))
    line = told(logged, capsys, f"flight.date = {date}\n")
    assert (
        f"flight.date is {date}, but '{logged}' begins at 2026-06-01T10:00:00Z; correct it, or leave it out"
        in line
    )


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ("flight = 3", "flight is 3; give a table [flight]"),
        (
            "flight.ship = 'A'",
            "[flight] has the key 'ship'; it may have vessel, imo, mmsi, date, place, operator",
        ),
        ("flight.vesel = 'A'", "[flight] has the key 'vesel'; did you mean 'vessel'?"),
        ("flight.vessel = 3", "flight.vessel is 3; give a text of one line"),
        ('flight.place = "a\\nb"', "flight.place is 'a\\nb'; give a text of one line"),
        (
            "flight.imo = 9074728",
            "flight.imo is 9074728; give seven digits whose last is their check digit, as 9074729",
        ),
        ("flight.imo = 907472", "flight.imo is 907472; give seven digits"),
        (
            'flight.imo = "9074729"',
            "is '9074729'; give seven digits whose last is their check digit, as 9074729, without quotation marks",
        ),
        (
            'flight.mmsi = "219000000"',
            "flight.mmsi is '219000000'; give nine digits, as 219000000, without quotation marks",
        ),
        ("flight.mmsi = 2190000", "flight.mmsi is 2190000; give nine digits, as 219000000"),
        (
            "flight.date = 2026-06-01T10:00:00",
            "flight.date is 2026-06-01 10:00:00; give a date, as 2026-06-01, or a time with",
        ),
        (
            "flight.date = 'June'",
            "flight.date is June; give a date, as 2026-06-01, or a time with its offset",
        ),
    ],
)
def test_details_with_mistakes_are_refused_in_one_line(logged, capsys, config, message):
    assert message in told(logged, capsys, f"{config}\n")


def test_times_that_lead_beyond_all_years_are_refused_in_one_line(logged, capsys):
    rewritten(logged, time_s=[1e12 * i for i in range(301)])
    assert "lasts 3e+14 s from flight.date on, beyond the year 9999" in told(
        logged, capsys, "flight.date = 2026-06-01T10:00:00Z\n"
    )


def test_a_code_for_a_missing_reading_stands_for_a_missing_place_as_well(logged):
    rewritten(logged, latitude_deg=[-9999.0] * 3 + [56.0] * 298, longitude_deg=11.5)
    assert recorded(logged, "missing = [-9999]\n")["first_position"] == [56.0, 11.5]


def test_the_manifest_names_log_and_configuration_with_their_whole_hashes(logged):
    recorded(logged, WHOLE)
    manifest = json.loads((logged.parent / "out" / "manifest.json").read_text(encoding="utf-8"))
    for name, path in (("source", logged), ("settings", logged.parent / "instrument.toml")):
        assert manifest[name] == path.name
        assert manifest[f"{name}_hash"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert run(logged, config=False) == 0
    manifest = json.loads((logged.parent / "out" / "manifest.json").read_text(encoding="utf-8"))
    assert (manifest["settings"], manifest["settings_hash"]) == (None, None)


def test_the_instrument_is_kept_as_it_was_stated_and_as_it_was_used(logged):
    recorded(logged, 'instrument = "electrochemical"\n')
    record = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))[
        "instrument"
    ]
    # Figures of measurement/sniffer/presets/electrochemical.toml.
    assert (
        record["stated"]["so2"] | {"t90_s": 20.0, "t90_sd": 0.05, "noise": 2.5}
        == record["stated"]["so2"]
    )
    assert record["used"] == record["stated"]
    recorded(
        logged, "[instrument.channels.so2]\ncross = {}\n[instrument.channels.co2]\nnoise = 1.0\n"
    )
    whole = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))
    stated, used = (whole["instrument"][kind]["so2"] for kind in ("stated", "used"))
    # What is not stated is None, and what the record showed in its place is used.
    assert (stated["noise"], stated["t90_sd"]) == (None, None)
    assert used["noise"] > 0.0
    assert used["t90_s"] == whole["estimate"]["so2_t90_s"] != stated["t90_s"]
