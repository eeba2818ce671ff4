"""Tables as people have them: what is found, what has to be given, and what is refused."""

import math
from datetime import date

import numpy as np
import pytest

from common.geodesy import cartesian
from common.tables import (
    TableError,
    TableFormat,
    find_jumps,
    longitude_within,
    read_table,
    table_format,
    unit_factor,
)


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode(encoding))
    return path


def seconds(tmp_path, cells, **given):
    day = given.pop("day", None)
    text = "t;x\n" + "".join(f"{cell};1\n" for cell in cells)
    return read_table(written(tmp_path, text), TableFormat(**given)).times("t", day=day)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "cp1252"])
@pytest.mark.parametrize(
    ("separator", "decimal"), [(",", "."), (";", ","), ("\t", ","), ("|", ".")]
)
def test_separator_decimal_and_encoding_are_found(tmp_path, separator, decimal, encoding):
    plain = "t,so2,co2\n0.5,108.2,543\n1.5,110.9,541.5\n2.5,,545\n"
    text = plain.replace(",", separator).replace(".", decimal)
    table = read_table(written(tmp_path, text, encoding))
    assert (table.format.decimal, table.format.separator) == (decimal, separator)
    assert table.names == ["t", "so2", "co2"]
    assert table.numbers("t") == pytest.approx([0.5, 1.5, 2.5])
    assert table.numbers("so2") == pytest.approx([108.2, 110.9, np.nan], nan_ok=True)
    assert table.numbers("co2") == pytest.approx([543.0, 541.5, 545.0])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"seperator": ";"}, "separator"),
        ({"decimal": "x"}, "'.' or ','"),
        ({"separator": ";;"}, "one mark"),
        ({"separator": "1"}, "one mark"),
        ({"separator": "\n"}, "a text of one line"),
        # A word of pandas, with which it guesses the order of day and month.
        ({"time_format": "mixed"}, "must have year, month and day"),
        ({"time_unit": "h"}, "s, ms, us"),
        ({"encoding": "klingon"}, "Python knows none"),
        ({"time_format": 3}, "must be a text"),
    ],
)
def test_a_format_of_no_use_is_refused(given, words):
    with pytest.raises(TableError, match=words):
        table_format(given)


def test_units_are_converted_and_those_of_another_quantity_are_refused():
    knot = 1852.0 / 3600.0
    speeds = {"m s**-1": 1.0, "m s-1": 1.0, "meters/second": 1.0, "knots": knot, "km/h": 1.0 / 3.6}
    for unit, factor in speeds.items():
        assert unit_factor(unit, "m/s") == pytest.approx(factor, rel=1e-9)
    assert unit_factor("%", "ppm") == pytest.approx(1e4, rel=1e-9)
    assert unit_factor("ppm", "ppb") == pytest.approx(1e3, rel=1e-9)
    for unit, words in (("foo", "no unit that is known"), ("m", "no unit of")):
        with pytest.raises(TableError, match=words):
            unit_factor(unit, "ppb", gas="so2")


DOTS = "%d.%m.%Y %H:%M:%S.%f"
NOON = 1_780_315_200.0
"""2026-06-01T12:00:00Z [s], by another program: date -d 2026-06-01T12:00:00Z +%s."""


@pytest.mark.parametrize(
    ("cells", "given"),
    [
        (["2026-06-01T12:00:00Z", "2026-06-01T12:00:01.5Z"], {}),
        (["2026-06-01T14:00:00+02:00", "2026-06-01T14:00:01.5+02:00"], {}),
        (["2026-06-01 12:00:00", "2026-06-01 12:00:01,5"], {}),
        (["1780315200", "1780315201.5"], {}),
        (["1780315200000", "1780315201500"], {}),
        (["1780315200000000", "1780315201500000"], {}),
        (["01.06.2026 12:00:00.0", "01.06.2026 12:00:01.5"], {"time_format": DOTS}),
        (["12:00:00", "12:00:01.5"], {"day": date(2026, 6, 1)}),
    ],
)
def test_times_are_read_in_utc(tmp_path, cells, given):
    found = seconds(tmp_path, cells, **given)
    assert found.dated
    assert found.seconds == pytest.approx([NOON, NOON + 1.5], abs=1e-6)


def test_a_track_across_the_date_line_at_a_ships_speed_has_no_jump():
    # At the equator 0.001 deg of longitude are 111.3 m (WGS 84): 11 m/s.
    longitude = longitude_within(179.995 + 0.001 * np.arange(10))
    assert longitude[-1] < 0.0
    latitude = np.zeros(10)
    place = cartesian(np.radians(latitude), np.radians(longitude))
    time = 10.0 * np.arange(10)
    assert not find_jumps(time, place, speed_max=60.0, error=0.0, degrees=(latitude, longitude))


def test_a_jump_is_counted_and_measured_against_speed_and_error():
    time = np.array([0.0, 10.0, 20.0, 30.0])
    place = np.array([[0.0, 0.0], [np.nan, 0.0], [1300.0, 0.0], [1995.0, 0.0]])
    # 1,300 m in 20 s, and 695 m in 10 s: 65 and 69.5 m/s. Errors of 99 m explain all but a metre.
    jumps = find_jumps(time, place, speed_max=60.0, error=0.0)
    assert [(jump.before, jump.after) for jump in jumps] == [(0, 2), (2, 3)]
    (jump,) = find_jumps(time, place, speed_max=60.0, error=99.0)
    assert (jump.before, jump.after, jump.distance, jump.seconds) == (0, 2, 1300.0, 20.0)
    assert find_jumps(time, place, speed_max=60.0, error=100.0) == []


# Hard files: each is read right, or refused in a line

HARD = [
    (
        "UTF-16, semicolons, decimal comma, ug/m3, winter time in Berlin",
        "Zeit;SO2 [µg/m³]\r\n2026-03-14T10:15:00+01:00;-1,5\r\n2026-03-14T10:15:01+01:00;1.002,5\r\n".encode("utf-16"),
        {"SO2 [µg/m³]": [-1.5, 1002.5], "Zeit": [1773479700.0, 1773479701.0]},
    ),
    ("tabs, points, commas of thousands", b"t\tx\n1\t101,325.5\n2\t-1,101,330.25\n", {"x": [101325.5, -1101330.25]}),
    (
        "a comma that was said to be of thousands", b"t;x\n1;1,013\n2;1,014\n", {"x": [1013.0, 1014.0]},
        {"decimal": "."},
    ),
    ("apostrophes of thousands", "t;x\n1;1'013.25\n2;1’998.5\n".encode(), {"x": [1013.25, 1998.5]}),
    ("narrow blanks of thousands", "t;x\n1;1\u202f013,25\n2;998,5\n".encode(), {"x": [1013.25, 998.5]}),
    ("the typographer's minus", "t;x\n1;−1,5\n2;−2,25\n".encode(), {"x": [-1.5, -2.25]}),
    (
        # date -u -d 2026-10-25T00:59:59Z +%s; the clock goes back from 3:00 to 2:00.
        "summer time ends", b"t,x\n2026-10-25T02:59:59+02:00,1\n2026-10-25T02:00:00+01:00,2\n",
        {"t": [1792889999.0, 1792890000.0]},
    ),
    (
        "offsets in a format that is given", b"t,x\n25.10.2026 02:59:59 +0200,1\n25.10.2026 02:00:00 +0100,2\n",
        {"t": [1792889999.0, 1792890000.0]}, {"time_format": "%d.%m.%Y %H:%M:%S %z"},
    ),
    (
        "milliseconds since 1970, one of them twice", b"t,x\n1780315200000,1\n1780315200000,2\n1780315201500,3\n",
        {"t": [NOON, NOON, NOON + 1.5]},
    ),
    ("seconds and milliseconds mixed", b"t,x\n1780315200,1\n1780315201500,2\n", "s and ms since 1970"),
    ("all numbers quoted", b'"t";"x"\n"1";"1,5"\n"2";"-2,25"\n', {"x": [1.5, -2.25]}),
    (
        "a byte order mark, comments that look like a head", "\ufeff# logger; a, b\nt,x\n1,2.5\n# in, it\n2,3.5\n".encode(),
        {"x": [2.5, 3.5]},
    ),
    ("carriage returns, empty last columns", b"t;x;;;\r1;2,5;;;\r2;3,5;;;\r", {"x": [2.5, 3.5]}),
    ("units in brackets below the head", b"t;x\n[s];(m/s)\n1;2,5\n2;3,5\n", {"x": [2.5, 3.5]}),
    ("a head in two rows", b"t;x;x\n;raw;cal\ns;mV;ppb\n1;2;3\n2;3;4\n", "time 's' in column 't' cannot be read (row 3)"),
    (
        "day and month without their order", b"t,x\n03-04-2026 10:15,1\n04-04-2026 10:16,2\n",
        'time_format = "%d-%m-%Y %H:%M", or table.time_format = "%m-%d-%Y %H:%M"',
    ),
    (
        "many words for nothing", "t,x\n1,N/A\n2,-\n3,9999\n4,#N/A\n5,---\n6,–\n7,n.a.\n8,1.5\n".encode(),
        {"x": [math.nan, math.nan, 9999.0, math.nan, math.nan, math.nan, math.nan, 1.5]},
    ),
    (
        "zeros where a logger lost its power", b"t,x\n" + b"1,2.5\n" * 60 + b"\0" * 500,
        "line 62 has a letter that no text has",
    ),
    ("no table", b"", "empty"),
    ("a row that is too long", b"t,x\n1,2,3\n", "line 2 has 3 values"),
    ("a quotation without an end", b't,x\n"1,2\n', "the quotation mark in line 2 is not closed"),
    ("a letter of no text", b"t,x\n\x00\x01,2\n", "not a table as text"),
    ("a number that is none", b"t,x\n1,2\n2,two\n", "'two' in row 3"),
    ("an infinite number", b"t,x\n1,2\n2,inf\n", "infinite in row 3"),
    ("times that may be several", b"t,x\n14.03.2026 10:15:00,1\n", 'table.time_format = "%d.%m.%Y %H:%M:%S"'),
    ("times that are none", b"t,x\nsoon,1\n", "time 'soon' in column 't' cannot be read (row 2)"),
    ("times without marks", b"t,x\n20260601120000,1\n20260601120001,1\n", "without marks"),
    ("a row without an end", b"t,x\n1," + b"9" * 200_000 + b"\n2,3.5\n", "200003 letters"),
    ("Python's own underscores", b"t,x\n1,1_000\n2,2\n", "'1_000' in row 2"),
    ("years in which nanoseconds end", b"t,x\n1677-01-01T00:00:00Z,1\n2500-01-01T00:00:00Z,2\n", {"t": [-9246096000.0, 16725225600.0]}),
    ("a format of times that is none", b"t,x\n25.10.2026,1\n26.10.2026,2\n", "table.time_format is '%Q'", {"time_format": "%Q"}),
]  # fmt: skip
"""What makes it hard, the file, what its columns hold or the refusal says, and what is given."""


@pytest.mark.parametrize(
    ("data", "expected", "given"), [pytest.param(*(*case, {})[1:4], id=case[0]) for case in HARD]
)
def test_a_hard_file_is_read_right_or_refused_in_a_line(tmp_path, data, expected, given):
    path = tmp_path / "hard.csv"
    path.write_bytes(data)

    def columns():
        table = read_table(path, table_format(given), head=("t", "x", "Zeit"))
        # Times first: a table whose numbers are refused as well is refused for its times.
        times = {name: table.times(name).seconds for name in table.names if name in ("t", "Zeit")}
        return {name: table.numbers(name) for name in table.names if name not in times} | times

    if isinstance(expected, str):
        with pytest.raises(TableError) as error:
            columns()
        assert expected in str(error.value)
        assert "\n" not in str(error.value)
        return
    found = columns()
    for name, values in expected.items():
        # Times of today have a microsecond's worth of digits.
        assert found[name] == pytest.approx(values, abs=1e-6, nan_ok=True)
