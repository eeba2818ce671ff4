"""The configuration of a logged flight: instrument, limits, columns, and details of the flight."""

import pandas as pd
import pytest

from measurement.errors import MeasurementError
from measurement.log.config import read_config
from measurement.log.read import read_flight


@pytest.fixture
def config(tmp_path):
    """Return a function that reads a configuration from a text."""

    def read(text):
        path = tmp_path / "own.toml"
        path.write_text(text, encoding="utf-8")
        return read_config(path)

    return read


@pytest.mark.parametrize(
    ("text", "quoted"),
    [
        ("[", "not TOML"),
        ("zone = 1", "'zone'; it may have calibration_hours, carbon"),
        ("limit_percent = 0.1", "'limit_percent'; did you mean 'limits_percent'?"),
        ("instrument = 'nose'", "instrument is 'nose'; there are alphasense_a4"),
        ("instrument = 'laserr'", "instrument is 'laserr'; did you mean 'laser'?"),
        ("instrument = 3", "instrument is 3"),
        ("[instrument.channels.so2]\ngain = 0.03", "gain of so2 is 0.03"),
        ("[instrument.channels.so2]\nt90_s = -3", "t90 is -3 s"),
        ("[instrument.channels.so2]\nt90 = 3", "'t90'; did you mean 't90_s'?"),
        ("method = 'magic'", "method is 'magic'"),
        ("carbon = 'much'", "carbon is 'much'"),
        ("carbon = 87", "carbon is 87; a fuel's mass share of carbon must be 0.5 to 0.95"),
        ("limits_percent = 0.1", "limits_percent is 0.1; give a list"),
        ("limits_percent = []", "limits_percent is []"),
        ("limits_percent = [-1]", "limits_percent is [-1]"),
        ("limits_percent = [0.5, 0.1, 0.1]", "limits_percent is [0.5, 0.1, 0.1]"),
        ("missing = -9999", "missing is -9999; give a list of numbers, as in [-9999]"),
        ("[scale]\nso2 = 0", "scale of so2 is 0; it must be positive"),
        ("[columns]\nso3 = 'x'", "[columns] has the key 'so3'"),
        ("[columns]\nso2 = 3", "columns.so2 is 3"),
        ("[columns]\nso2 = 'co2_ppm'", "[columns] has the column 'co2_ppm' for so2 and for co2"),
        ("flight = 3", "flight is 3; give a table [flight]"),
        ("flight.ship = 'A'", "[flight] has the key 'ship'; it may have vessel, imo, mmsi"),
        ("flight.vesel = 'A'", "[flight] has the key 'vesel'; did you mean 'vessel'?"),
        ("flight.vessel = 3", "flight.vessel is 3"),
        ('flight.place = "a\\nb"', "flight.place is 'a\\nb'"),
        # 9074729 has the check digit 9: 9 7 + 0 6 + 7 5 + 4 4 + 7 3 + 2 2 = 139.
        ("flight.imo = 9074728", "flight.imo is 9074728"),
        ("flight.imo = 907472", "flight.imo is 907472"),
        ('flight.imo = "9074729"', "'9074729'; give seven digits"),
        ('flight.mmsi = "219000000"', "'219000000'; give nine digits"),
        ("flight.mmsi = 2190000", "flight.mmsi is 2190000"),
        ("flight.date = 2026-06-01T10:00:00", "flight.date is 2026-06-01 10:00:00"),
        ("flight.date = 'June'", "flight.date is June"),
        ('rule = "eca_0.12"', "rule is 'eca_0.12'"),
        ("rule = 0.13", "rule is 0.13"),
        ("rule.suspect_percent = 0.13", "rule.limit_percent is None"),
        ("rule.limit_percent = nan", "rule.limit_percent is nan"),
        ("[rule]\nlimit_percent = 0.2\nsuspect_percent = 0.1", "rule.suspect_percent is 0.1"),
        ("[rule]\nlimit_percent = 0.2\nsuspect = 0.3", "suspect"),
        ('[rule]\nlimit_percent = 0.2\ntitle = "a\\nb"', "rule.title"),
        ("flight.latitude_deg = 56.1", "one of flight.latitude_deg and flight.longitude_deg"),
        ("flight = {latitude_deg = 91, longitude_deg = 11}", "flight.latitude_deg is 91; give"),
        ("flight = {latitude_deg = 'N', longitude_deg = 11}", "flight.latitude_deg is 'N'"),
        ("[gases.n2o]", "gas 'n2o' has no molar_mass_g_mol"),
        ("[gases.ch4]\nmolar_mass_g_mol = 17.0", "gases has the name 'ch4', which is taken"),
        ("[gases]\nn2o = 44.0", "gases.n2o is 44.0; give a table [gases.n2o]"),
        ("[columns]\nn2o = 'N2O [ppb]'", "[columns] has the key 'n2o'"),
        ("[units]\nch4 = 'kg'", "units.ch4: 'kg' is no unit of this quantity"),
        ("[channels.ch4]\nt90 = 2.0", "channel 'ch4' has the key 't90'"),
        ("[channels.ch4]\ncross = { no = 0.1 }", "only SO2, NO and NO2 may have one"),
        ("[engine]\nkeel_laid = 'May'", "engine.keel_laid is 'May'; give a date"),
        ("[engine]\nrated_rpm = 'slow'", "engine.rated_rpm is 'slow'; give a number"),
        ("[humidity]\nso2 = -5.0", "humidity.so2 is -5.0; give its effect"),
        ("calibration_hours = 0", "calibration_hours is 0"),
        ("serial = true", "serial is True"),
    ],
)
def test_mistakes_are_refused_in_one_line_that_names_the_value(config, text, quoted):
    with pytest.raises(MeasurementError) as error:
        config(text)
    line = str(error.value)
    assert quoted in line
    assert line.count("own.toml") == 1
    assert "\n" not in line


@pytest.mark.parametrize(
    ("step_s", "date", "message"),
    [
        (1.0, "2026-06-02", "2026-06-02.* 2026-06-01T10:00:00Z"),
        (1.0, "2026-06-01T10:00:02Z", "2026-06-01T10:00:02.* 2026-06-01T10:00:00Z"),
        (1e12, "2026-06-01T10:00:00Z", r"lasts 3e\+14 s .* year 9999"),
    ],
)
def test_a_date_that_cannot_be_that_of_the_log_is_refused(logged, config, step_s, date, message):
    seconds = step_s * pd.Series(range(301))
    times = pd.Timestamp("2026-06-01T10:00:00Z") + pd.to_timedelta(range(301), unit="s")
    table = pd.read_csv(logged).assign(time_s=times.astype(str) if step_s == 1.0 else seconds)
    table.to_csv(logged, index=False)
    with pytest.raises(MeasurementError, match=message):
        read_flight(logged, config(f"flight.date = {date}\n"))


def test_a_log_of_seconds_with_a_date_alone_has_no_time_of_day(logged, config):
    found = read_flight(logged, config('flight.date = "2026-06-01"\n')).about.record()
    assert found["details"]["day"] == "2026-06-01"
    assert (found["first_utc"], found["utc_from"]) == (None, "")
    assert read_flight(logged, config("")).about.record()["details"]["day"] is None


@pytest.mark.parametrize(
    ("text", "limit", "suspect"),
    [
        ('rule = "eca_0.13"', 0.10, 0.13),
        ('rule = "global"', 0.50, None),
        ("[rule]\nlimit_percent = 0.2\nsuspect_percent = 0.3", 0.2, 0.3),
        ("[rule]\nlimit_percent = 0.2", 0.2, None),
    ],
)
def test_a_rule_has_a_name_or_a_table(config, text, limit, suspect):
    rule = config(text).rule
    assert (rule.limit_percent, rule.suspect_percent) == (limit, suspect)
