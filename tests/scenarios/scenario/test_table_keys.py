"""The section ``[table]``: how AIS reports and winds are written, where that is not found."""

import json

import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import CATALOG, load_study
from scenarios.studies.base import FlightStudy
from scenarios.world.ais import read_ais
from scenarios.world.world import mean_wind, vessel_of

KINEMATIC = 'title = "mine"\nfidelity = "kinematic"\n'

HOURS = (("2026-06-01T09:00:00Z", 5.0, 90.0), ("2026-06-01T13:00:00Z", 5.0, 90.0))

DIALECTS = {
    # Day before month, which cannot be found: the first of June, and not the sixth of January.
    "order of day and month": (
        "time_utc;speed_mps;from_deg\n01.06.2026 09:00;5,0;90\n01.06.2026 13:00;5,0;90\n",
        {"time_format": "%d.%m.%Y %H:%M"},
    ),
    # Every comma may be of thousands: a wind of 5.000 or 5000 m/s.
    "commas of three decimals": (
        "time_utc;speed_mps;from_deg\n"
        "2026-06-01T09:00:00Z;5,000;90\n2026-06-01T13:00:00Z;5,000;90\n",
        {"decimal": ","},
    ),
    "milliseconds": (
        "time_utc,speed_mps,from_deg\n1780304400000,5,90\n1780318800000,5,90\n",
        {"time_unit": "ms"},
    ),
    "a separator that is not looked for": (
        "time_utc:speed_mps:from_deg\n20260601 09:5:90\n20260601 13:5:90\n".replace(" ", ""),
        {"separator": ":", "time_format": "%Y%m%d%H"},
    ),
    # The head's first letters would be a comment in UTF-8.
    "an encoding": (
        "time_utc,speed_mps,from_deg,Bö\n2026-06-01T09:00:00Z,5,90,x\n2026-06-01T13:00:00Z,5,90,x\n",
        {"encoding": "cp850"},
    ),
}


def east_wind(tmp_path, text, table, *, encoding="utf-8", **more):
    (tmp_path / "wind.csv").write_text(text, encoding=encoding)
    keys = "".join(f"table.{key} = {json.dumps(value)}\n" for key, value in table.items())
    (tmp_path / "mine.toml").write_text(
        f'{KINEMATIC}wind.table = "wind.csv"\nplace.utc = 2026-06-01T10:00:00Z\n{keys}',
        encoding="utf-8",
    )
    return load_study(str(tmp_path / "mine.toml"), **more)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_wind_is_read_as_the_scenario_says(tmp_path, dialect):
    text, table = DIALECTS[dialect]
    scenario = east_wind(tmp_path, text, table, encoding=table.get("encoding", "utf-8"))
    north, east = mean_wind(scenario, vessel_of(scenario)).now(0.0, 10.0)
    # 5 m/s from the east, at 10 o'clock of the first of June.
    assert (north, east) == (pytest.approx(0.0, abs=1e-12), pytest.approx(-5.0))


def test_reports_and_wind_are_read_each_as_it_is_written(tmp_path):
    danish = (CATALOG / "ais" / "synthetic_danish.csv").read_text(encoding="utf-8")
    (tmp_path / "ship.csv").write_text(danish, encoding="utf-8")
    text, table = DIALECTS["order of day and month"]
    text = text.replace("13:00", "14:00")
    (tmp_path / "wind.csv").write_text(text, encoding="utf-8")
    mine = tmp_path / "mine.toml"
    keys = 'extends = "ship_from_ais"\ntitle = "mine"\nfidelity = "kinematic"\n' + (
        'vessel.track = "ship.csv"\nwind = { table = "wind.csv" }\ntable.time_format = '
    )
    # The Danish layout says of itself how its times are written, and is not to be read otherwise.
    mine.write_text(f'{keys}"{table["time_format"]}"\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"ship\.csv: time '01/06/2026 10:00:00' in column"):
        vessel_of(load_study(str(mine)))
    mine.write_text(
        f'{keys}"{table["time_format"]}"\ntable.file = "wind.table"\n', encoding="utf-8"
    )
    scenario = load_study(str(mine))
    study = FlightStudy(scenario, "mine", {"mine": scenario})
    manifest = study.initial_manifest()
    (ship,), (wind,) = manifest["vessel_files"].values(), manifest["wind_files"].values()
    assert ship["read"] == "separated by commas, decimal point, utf-8"
    assert wind == {
        "read": "separated by semicolons, decimal comma, utf-8",
        "times": 2,
        "heights_m": [],
    }


def test_reports_are_read_as_the_scenario_and_python_say(tmp_path):
    rows = [f"01.06.2026 10:00:{s:02d};219999001;57,{s:06d};11,3;12,0;0,0" for s in (0, 10, 20)]
    head = "time_utc;mmsi;lat_deg;lon_deg;sog_kn;cog_deg"
    (tmp_path / "ship.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
    with pytest.raises(InputError, match=r"give its order: table\.time_format = \"%d\.%m\.%Y"):
        read_ais(tmp_path / "ship.csv")
    ship = read_ais(tmp_path / "ship.csv", time_format="%d.%m.%Y %H:%M:%S")
    # 2026-06-01T10:00:00Z is 1780308000 s after 1970 began (date -u -d ... +%s).
    assert ship.time.tolist() == [1780308000.0, 1780308010.0, 1780308020.0]
    assert ship.read == "separated by semicolons, decimal comma, utf-8"
    assert ship.described().endswith(ship.read)
    with pytest.raises(InputError, match=r"table\.decimals is not known; did you mean 'decimal'"):
        read_ais(tmp_path / "ship.csv", decimals=",")


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "separator",
            ";;",
            "table.separator is ';;'; it must be one mark, as ';', or 'whitespace'",
        ),
        ("separator", "", "table.separator is ''; it must be a text"),
        ("decimal", ";", "table.decimal is ';'; it must be '.' or ','"),
        ("encoding", "hex", "table.encoding is 'hex'"),
        ("encoding", "utf-9", "table.encoding is 'utf-9'"),
        ("time_format", "%H:%M", "table.time_format is '%H:%M'; it must have year, month and day"),
        ("time_unit", "min", "table.time_unit is 'min'; it must be one of s, ms, us"),
        ("separator", 5, "table.separator is 5; input should be a valid string"),
        ("file", "wind", "table.file is 'wind'; input should be 'vessel.track' or 'wind.table'"),
        ("seperator", ";", "unknown key 'table.seperator'; did you mean 'table.separator'?"),
    ],
)
def test_values_that_cannot_be_are_refused_with_the_key_and_the_limit(tmp_path, key, value, words):
    with pytest.raises(InputError) as refusal:
        east_wind(tmp_path, DIALECTS["milliseconds"][0], {key: value})
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("dialect", "table", "words"),
    [
        ("milliseconds", {"separator": ";"}, "table.separator is ';', which none of the first 3"),
        ("milliseconds", {"encoding": "utf-16"}, "not text in utf-16"),
        ("milliseconds", {"time_format": "%d.%m.%Y"}, "time '1780304400000' in column 'time_utc'"),
        ("milliseconds", {"time_unit": "us"}, "have no date, as '1780304400000' (row 2)"),
        (
            "order of day and month",
            {"time_format": "%d.%m.%Y %H:%M", "time_unit": "s"},
            "table.time_unit is 's', and times in column 'time_utc' are no numbers",
        ),
        ("order of day and month", {}, 'table.time_format = "%d.%m.%Y %H:%M"'),
    ],
)
def test_keys_that_contradict_the_table_are_refused(tmp_path, dialect, table, words):
    scenario = east_wind(tmp_path, DIALECTS[dialect][0], table)
    with pytest.raises(InputError) as refusal:
        mean_wind(scenario, vessel_of(scenario))
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_times_of_reports_and_of_a_wind_need_a_date(tmp_path):
    text = DIALECTS["milliseconds"][0].replace("1780304400000", "09:00:00")
    scenario = east_wind(tmp_path, text.replace("1780318800000", "13:00:00"), {})
    with pytest.raises(InputError, match=r"wind\.csv: times in column 'time_utc' have no date"):
        mean_wind(scenario, vessel_of(scenario))
    # Days since 1900, as spreadsheets have them.
    rows = [f"46174.{part};219999001;57,{part};11,3;12,0;0,0" for part in (416667, 416782)]
    head = "time_utc;mmsi;lat_deg;lon_deg;sog_kn;cog_deg"
    (tmp_path / "ship.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
    with pytest.raises(InputError, match=r"ship\.csv: times in column 'time_utc' have no date, as"):
        read_ais(tmp_path / "ship.csv")


def test_keys_of_tables_without_a_table_have_no_effect_and_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"'table\.decimal' has no effect here: it is used by a"):
        load_study({"title": "mine", "table": {"decimal": ","}})
    with pytest.raises(InputError, match=r"'table\.file' has no effect here: it is used by two"):
        east_wind(tmp_path, DIALECTS["milliseconds"][0], {"file": "wind.table"})
    (tmp_path / "ship.txt").write_text("1780308000 !AIVDM,1,1,,A,13,0*00\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"table\.decimal is given, and the file has NMEA"):
        read_ais(tmp_path / "ship.txt", decimal=",")
