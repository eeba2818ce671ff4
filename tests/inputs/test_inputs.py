"""The table of docs/howto/inputs.md: each file as the world has it, and what is read of it."""

from pathlib import Path

import numpy as np
import pytest

from common.physics import METRES_PER_SECOND_PER_KNOT
from measurement.errors import MeasurementError
from measurement.log.config import read_config
from measurement.log.read import read_flight
from scenarios.world.ais import read_ais

FILES = Path(__file__).parent / "files"

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "inputs.md"

REPORTS = {
    # Rows; course [deg]; first and last longitude [deg]; length of the ship [m].
    "bsvdm.txt": (60, 260.0, 11.3, 11.240772, None),
    "gps_first.txt": (60, 260.0, 11.3, 11.240772, None),
    # Over the date line: 180.003 to 179.996 of 360.
    "lon360.csv": (12, 270.0, -179.997, 179.99612, None),
    # -139.6 + 409.6 deg.
    "signed.csv": (12, 270.0, -91.0, -91.00688, None),
    "two_stations.csv": (60, 260.0, -91.0, -91.03637, 100.0),
}
"""Files of AIS reports, every row of which is of use: a ship that goes straight at 12 kn."""


@pytest.mark.parametrize("name", REPORTS)
def test_a_file_of_reports_is_read_whole(name):
    if name.endswith(".txt"):
        pytest.importorskip("pyais", reason="pyais is an extra")
    rows, course, first, last, length = REPORTS[name]
    found = read_ais(FILES / name)
    assert (len(found.time), found.dropped, found.warning) == (rows, {}, "")
    np.testing.assert_allclose(np.degrees(found.course), course, atol=0.05)
    np.testing.assert_allclose(found.speed, 12.0 * METRES_PER_SECOND_PER_KNOT, atol=0.03)
    # A sentence has 1/10,000 minutes: 1.7e-6 deg.
    np.testing.assert_allclose(np.degrees(found.longitude[[0, -1]]), [first, last], atol=1e-6)
    assert np.all(np.diff(found.time) > 0.0)
    assert (found.size and found.size.length) == length


def test_a_ship_that_turns_to_and_fro_has_its_reports_of_both_courses():
    found = read_ais(FILES / "zigzag_signed.csv")
    assert (len(found.time), found.dropped, found.warning) == (120, {}, "")
    courses, counts = np.unique(np.degrees(found.course).round(1), return_counts=True)
    # 10 deg, and -59.6 + 409.6 deg: half of the rows each.
    assert (courses.tolist(), counts.tolist()) == ([10.0, 350.0], [60, 60])


NAMES = """
[columns]
time = "Zeit"
so2 = "SO2 [ppb]"
co2 = "CO2 [%]"
no = "NO [ppb]"
no2 = "NO2 [ppb]"
latitude = "Breite"
longitude = "Länge"
"""

LOGS = {
    # What is given beside the names of columns; by what share of a reading, and by how much, SO2 may
    # differ [-, ppb].
    "european.csv": ("", 0.0, 0.0),
    "local_dates.csv": ('[table]\ntime_format = "%d.%m.%Y %H:%M:%S"\n', 0.0, 0.0),
    # Made with 2.66 ug/m3 per ppb, which is 2.6632 by the gas law; 0.05 ug/m3 are 0.019 ppb.
    "so2_in_ug_m3.csv": ('[units]\nso2 = "ug/m3"\n', 0.0013, 0.02),
}
"""Logs of one flight, which ``unix_seconds.csv`` has as this project writes logs."""


def logged(tmp_path, name, given):
    (tmp_path / "log.toml").write_text(f'instrument = "electrochemical"\n{given}', "utf-8")
    return read_flight(FILES / name, read_config(tmp_path / "log.toml"))


@pytest.mark.parametrize("name", LOGS)
def test_a_log_is_read_as_the_plain_one_of_the_same_flight(name, tmp_path):
    given, share, rounding = LOGS[name]
    plain = logged(tmp_path, "unix_seconds.csv", "").readings
    found = logged(tmp_path, name, NAMES + given)
    read = found.readings
    np.testing.assert_allclose(read.time - read.time[0], plain.time - plain.time[0])
    so2, others = read.values[:, 0], read.values[:, 1:]
    np.testing.assert_allclose(so2, plain.values[:, 0], rtol=share + 1e-9, atol=rounding)
    np.testing.assert_allclose(others, plain.values[:, 1:], rtol=1e-9)
    assert found.about.first_position == pytest.approx((56.0978620, 11.2))


def test_the_order_of_day_and_month_is_asked_for(tmp_path):
    with pytest.raises(MeasurementError, match=r'time_format = "%d\.%m\.%Y %H:%M:%S"'):
        logged(tmp_path, "local_dates.csv", NAMES)


def test_a_gas_without_a_unit_is_asked_for(tmp_path):
    text = (FILES / "so2_in_ug_m3.csv").read_text("utf-8").replace("SO2 [ppb]", "SO2", 1)
    (tmp_path / "log.csv").write_text(text, "utf-8")
    given = NAMES.replace("SO2 [ppb]", "SO2")
    with pytest.raises(MeasurementError, match="column 'SO2' does not say its unit; give it in"):
        logged(tmp_path, tmp_path / "log.csv", given)


def test_seconds_since_1970_are_compared_with_the_date_that_is_given(tmp_path):
    # date -u -d @1780308000: 2026-06-01T10:00:00Z.
    assert logged(tmp_path, "unix_seconds.csv", "[flight]\ndate = 2026-06-01\n").about.utc_from
    with pytest.raises(
        MeasurementError, match=r"flight\.date is 2026-06-02, but the log begins at"
    ):
        logged(tmp_path, "unix_seconds.csv", "[flight]\ndate = 2026-06-02\n")


def test_the_page_of_inputs_has_every_file():
    text = PAGE.read_text("utf-8")
    assert [path.name for path in FILES.glob("*.[ct][sx][vt]") if path.name not in text] == []
