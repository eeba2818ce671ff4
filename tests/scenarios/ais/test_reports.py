"""Files of AIS reports: known layouts, rows of no use, and files of no use."""

import math
from dataclasses import asdict
from datetime import UTC, datetime

import numpy as np
import pytest

from common.physics import METRES_PER_SECOND_PER_KNOT
from scenarios.errors import InputError
from scenarios.world.ais import ShipSize, read_ais
from scenarios.world.ais.reports import read_others

PLAIN = "time_utc,mmsi,lat_deg,lon_deg,sog_kn,cog_deg"

ROW = "2026-06-01T10:00:{:02d}Z,219999001,{:.6f},11.3,12.0,20.5"

LAYOUTS = {
    # Heads as published: web.ais.dk/aisdata, and the data dictionaries of marinecadastre.gov.
    "danish": (
        "# Timestamp,Type of mobile,MMSI,Latitude,Longitude,Navigational status,ROT,SOG,COG,Heading,IMO,Callsign,Name,Ship type,"
        "Cargo type,Width,Length,Type of position fixing device,Draught,Destination,ETA,Data source type,A,B,C,D",
        "01/06/2026 10:00:{0:02d},Class A,219999001,{1:.6f},11.300000,Under way,,12.0,20.5,511,Unknown,,,,,,,,,,,AIS,,,,",
    ),
    "up to 2024": (
        "MMSI,BaseDateTime,LAT,LON,SOG,COG,Heading,VesselName,IMO,CallSign,VesselType,Status,Length,Width,Draft,Cargo,"
        "TransceiverClass",
        "219999001,2026-06-01T10:00:{0:02d},{1:.6f},11.3,12.0,20.5,511.0,,,,70,0,,,,,A",
    ),
    "from 2025": (
        "mmsi,base_date_time,longitude,latitude,sog,cog,heading,vessel_name,imo,call_sign,vessel_type,status,length,width,draft,"
        "cargo,transceiver",
        "219999001,2026-06-01 10:00:{0:02d},11.3,{1:.6f},12.0,20.5,511,,,,70,0,,,,,A",
    ),
    "plain": (PLAIN, ROW),
}


def table(*rows, head=PLAIN):
    return "\n".join([head, *rows]) + "\n"


def rows(seconds=(0, 10, 20), latitude=57.0):
    return [ROW.format(second, latitude + 1e-5 * second) for second in seconds]


@pytest.fixture
def read(tmp_path):
    def of(text, mmsi=None, name="ais.csv"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return read_ais(tmp_path / name, mmsi)

    return of


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_says_the_same(read, layout):
    head, row = LAYOUTS[layout]
    lines = [row.format(second, 57.0 + 1e-5 * second) for second in (0, 10, 20)]
    found = read(table(*lines, head=head), 219999001)
    assert np.degrees(found.latitude) == pytest.approx([57.0, 57.0001, 57.0002], abs=1e-9)
    np.testing.assert_allclose(np.degrees(found.longitude), 11.3, rtol=1e-12)
    # 2026-06-01T10:00:00Z is 1780308000 s after 1970 began (date -u -d ... +%s).
    np.testing.assert_array_equal(found.time, [1780308000.0, 1780308010.0, 1780308020.0])
    np.testing.assert_allclose(found.speed, 12.0 * METRES_PER_SECOND_PER_KNOT, rtol=1e-12)
    np.testing.assert_allclose(found.course, math.radians(20.5), rtol=1e-12)
    assert (found.rows, found.dropped) == (3, {})


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        # Values that say "not available" (ITU-R M.1371-5, table 48), rows that are cut off, and
        # what no receiver should have written.
        ("2026-06-01T10:00:05Z,219999001,91.0,181.0,12.0,20.5", "without a possible position"),
        ("2026-06-01T10:00:05Z,219999001,57.0,361.0,12.0,20.5", "without a possible position"),
        ("2026-06-01T10:00:05Z,219999001", "without a possible position"),
        ("2026-06-01T10:00:05Z,219999001,57.0,11.3,102.3,20.5", "without speed or course"),
        ("2026-06-01T10:00:05Z,219999001,57.0,11.3,12.0,360.0", "without speed or course"),
        ("2026-06-01T10:00:00Z,219999001,57.0,11.3,12.0,20.5", "with the time of another"),
        ("2016-06-01T10:00:00Z,219999001,57.0,11.3,12.0,20.5", "out of order"),
        ("2036-06-01T10:00:00Z,219999001,57.0,11.3,12.0,20.5", "out of order"),
        # 10 km off.
        ("2026-06-01T10:00:05Z,219999001,57.1,11.3,12.0,20.5", "out of reach of others"),
        # On the other side of the earth, which a tangent plane takes for near.
        ("2026-06-01T10:00:05Z,219999001,-57.0,-168.7,12.0,20.5", "out of reach of others"),
    ],
)
def test_a_row_of_no_use_is_dropped_and_counted(read, row, reason):
    first, second, third = rows()
    found = read(table(first, row, second, third))
    assert (len(found.time), found.rows, found.dropped) == (3, 4, {reason: 1})
    used = f"ais.csv: 3 of 4 rows of MMSI 219999001 used; dropped: 1 {reason};"
    assert found.described().startswith(used)


# ITU-R M.1371-5, figure 41: A ahead, B astern, C to port, D to starboard; 0 is not known.
SIZES = [
    ("18,120", "90,30,7,11", ShipSize(120.0, 18.0, 90.0, 7.0)),
    ("18,120", ",,,", ShipSize(120.0, 18.0)),
    ("0,120", "0,0,0,0", ShipSize(120.0)),
    # The antenna at the bow, and at the port side.
    (",", "0,120,9,9", ShipSize(120.0, 18.0, 0.0, 9.0)),
    (",", "90,30,0,0", ShipSize(120.0, None, 90.0)),
]


@pytest.mark.parametrize(("size", "sides", "expected"), SIZES)
def test_length_beam_and_antenna_are_read(read, size, sides, expected):
    head, row = LAYOUTS["danish"]
    row = row.replace("Unknown,,,,,,,,", f"Unknown,,,,,{size},,").replace(
        ",AIS,,,,", f",AIS,{sides}"
    )
    lines = [row.format(10 * number, 57.0 + 5e-5 * number) for number in range(3)]
    found = read(table(*lines, head=head))
    assert (found.size, found.size_remark) == (expected, "")
    assert found.record()["size"] == asdict(expected)


@pytest.mark.parametrize(
    ("text", "mmsi", "words"),
    [
        ("", None, ["the file is empty"]),
        ("a,b,c\n1,2,3\n", None, ["line 1", "the header is 'a,b,c'", PLAIN]),
        (table(*rows()), 366, ["no row of MMSI 366; it has 219999001 (3 rows): check the number (vessel.mmsi"]),
        (
            table(*rows()).replace("sog_kn", "sog_mps"), None,
            ["'sog_mps' is in another unit than 'sog_kn': convert its values before you rename it"],
        ),
        (table(), None, ["no row below the header has an MMSI in digits"]),
        (table(*rows(), "2026-06-01T10:00:05Z,7,57.0,11.3,12.0,20.5"), None, ["2 vessels", "name one of them by its MMSI"]),
        (
            table(*(f"2026-06-01T10:00:{s:02d}Z,1,91.0,11.3,12.0,20.5" for s in range(4))), None,
            ["0 of 4 rows of MMSI 1 used", "4 without a possible position (first in line 2)", "correct the rows"],
        ),
        ("PK\x03\x04\x00", None, ["cannot be unpacked"]),
    ],
)  # fmt: skip
def test_a_file_of_no_use_is_refused_in_one_line(read, text, mmsi, words):
    with pytest.raises(InputError) as refusal:
        read(text, mmsi)
    assert "\n" not in str(refusal.value)
    for word in ["ais.csv", *words]:
        assert word in str(refusal.value)


def sailed(*, knots=1.0, degrees=1.0, turned=0.0, swapped=False, interval=10):
    """Return a table of a vessel that goes north-east at 12 kn, with speeds and courses in units of
    these sizes, and reports every ``interval`` [s].
    """
    lines, begin = [], np.datetime64("2026-06-01T10:00:00")
    for i in range(30):
        # A degree of latitude at 57 N is 111,362 m, one of longitude 60,772 m (WGS 84).
        way = 12.0 * METRES_PER_SECOND_PER_KNOT * interval * i * math.sqrt(0.5)
        place = f"{57.0 + way / 111362.0:.6f}", f"{11.3 + way / 60772.0:.6f}"
        first, second = reversed(place) if swapped else place
        motion = f"{12.0 / knots:.3f},{45.0 / degrees + turned:.3f}"
        lines.append(f"{begin + i * interval}Z,219999001,{first},{second},{motion}")
    return table(*lines)


def mistaken(text, mistake, of):
    """Return a table with a mistake in the places of some rows, counted from 0."""
    head, *lines = text.splitlines()
    for row in of:
        time, mmsi, latitude, longitude, *rest = lines[row].split(",")
        lines[row] = ",".join([time, mmsi, *mistake(latitude, longitude), *rest])
    return table(*lines, head=head)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda north, east: (east, north), "latitude and longitude exchanged"),
        (lambda north, east: (north, "-" + east), "the other sign of longitude"),
        (lambda north, east: ("-" + north, east), "the other sign of latitude"),
    ],
)
@pytest.mark.parametrize("of", [range(15, 30), range(14, 16)])
def test_a_track_that_jumps_by_a_mistake_is_refused_with_rows_and_mistake(read, mistake, words, of):
    with pytest.raises(InputError) as refused:
        read(mistaken(sailed(), mistake, of))
    line = str(refused.value)
    assert f"the place in row {of[0] + 2} is " in line
    assert f"from that in row {of[0] + 1}, 10 s earlier, which is faster than 60 m/s" in line
    assert f"fit together with {words}" in line
    assert "\n" not in line


@pytest.mark.parametrize(
    ("made", "words"),
    [
        # A metre per second is 1/0.5144 kn.
        (sailed(knots=1.0 / 0.514444), "reported speeds are 0.51 of those between places"),
        (sailed(turned=180.0, interval=90), "reported courses are 180 deg off"),
        (sailed(degrees=math.degrees(1.0)), "reported courses are 44 deg off those between places"),
        (sailed(swapped=True), "latitude and longitude are swapped"),
    ],
)
def test_a_file_in_other_units_is_refused_with_the_unit_it_must_have(read, made, words):
    with pytest.raises(InputError, match=words) as refusal:
        read(made)
    assert "\n" not in str(refusal.value)


def test_nmea_sentences_are_decoded_with_the_time_before_them(read):
    encode = pytest.importorskip("pyais.encode", reason="pyais is an extra")
    lines = []
    for second, prefix in (
        (0, "\\s:r1,c:1780308000*00\\"),
        (10, "2026-06-01T10:00:10Z "),
        (20, "1780308020 "),
    ):
        said = {"msg_type": 1, "mmsi": 219999001, "lat": 57.0 + 1e-4 * second, "lon": 11.3}
        said |= {"speed": 12.0, "course": 20.5}
        lines.append(prefix + encode.encode_dict(said, talker_id="AI")[0])
    lines.insert(1, "!AIVDM,1,1,,A,garbage,0*00")
    found = read("\n".join(lines) + "\n", name="ais.nmea")
    np.testing.assert_array_equal(found.time - found.time[0], [0.0, 10.0, 20.0])
    # In a sentence a place is a whole number of 1/10,000 minutes: rounded to 8e-7 deg.
    assert np.degrees(found.latitude) == pytest.approx([57.0, 57.001, 57.002], abs=9e-7)
    with pytest.raises(InputError, match="line 1: the sentence has no time"):
        read(lines[0].rpartition("\\")[2] + "\n", name="ais.nmea")


@pytest.mark.parametrize(
    "written",
    ["2026-06-01T12:{:02d}:00+02:00", "2026-06-01 10:{:02d}:00", "2026-06-01T10:{:02d}:00Z"],
    ids=["with an offset", "without one", "of UTC"],
)
def test_other_ships_are_found_however_their_times_are_written(tmp_path, written):
    rows = [
        f"{written.format(minute)},{mmsi},{55.0 + 0.001 * minute + at},10.0,10.0,0.0"
        for minute in range(10)
        for mmsi, at in ((219999001, 0.0), (219999002, 0.01))
    ]
    late = f"2026-06-01T23:00:00Z,219999003,{55.0},10.0,10.0,0.0"
    path = tmp_path / "two.csv"
    path.write_text("\n".join([PLAIN, *rows, late]) + "\n")
    begin = datetime(2026, 6, 1, 10, 0, tzinfo=UTC).timestamp()
    others = read_others(path, without=219999001, only=None, begin=begin, end=begin + 600.0)
    assert [(reports.mmsi, len(reports.time)) for reports in others] == [(219999002, 10)]
