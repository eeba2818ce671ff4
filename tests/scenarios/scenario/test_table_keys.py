"""The section ``[table]``: how AIS reports and winds are written, where that is not found."""

import json

import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.world.world import mean_wind, vessel_of

KINEMATIC = 'title = "mine"\nfidelity = "kinematic"\n'


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


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "separator",
            ";;",
            "table.separator is ';;'; it must be one mark, as ';', or 'whitespace'",
        ),
        ("decimal", ";", "table.decimal is ';'; it must be '.' or ','"),
        ("encoding", "utf-9", "table.encoding is 'utf-9'"),
        ("time_unit", "min", "table.time_unit is 'min'; it must be one of s, ms, us"),
        ("file", "wind", "table.file is 'wind'; input should be 'vessel.track' or 'wind.table'"),
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
        ("milliseconds", {"time_format": "%d.%m.%Y"}, "time '1780304400000' in column 'time_utc'"),
        (
            "order of day and month",
            {"time_format": "%d.%m.%Y %H:%M", "time_unit": "s"},
            "table.time_unit is 's', and times in column 'time_utc' are no numbers",
        ),
    ],
)
def test_keys_that_contradict_the_table_are_refused(tmp_path, dialect, table, words):
    scenario = east_wind(tmp_path, DIALECTS[dialect][0], table)
    with pytest.raises(InputError) as refusal:
        mean_wind(scenario, vessel_of(scenario))
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)
