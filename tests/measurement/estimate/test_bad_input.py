"""Records that cannot be used are refused in a line, and weak ones have no verdict."""

import math

import numpy as np
import pytest
from crossings import changed, crossings, flight, plain_sniffer, read, sniffer_of, with_column

from measurement.errors import MeasurementError
from measurement.estimate.estimator import estimate, over_time
from measurement.estimate.record import checked_record, readings_noise
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_preset

pytestmark = pytest.mark.slow

SPEC = plain_sniffer(so2_noise=2.5, co2_noise=1.0)
READINGS = read(SPEC, crossings(0.25, duration=120.0))


def outcome(readings, spec):
    """Return the estimate, or the line that refuses the readings."""
    try:
        return estimate(readings, spec)
    except MeasurementError as error:
        return str(error)


def with_change(readings, change):
    copy = Readings(readings.time.copy(), readings.values.copy())
    other = change(copy)
    return copy if other is None else other


def put(array, index, value):
    array[index] = value


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: put(r.values, (slice(None), 1), np.nan), "no CO2 readings"),
        (lambda r: put(r.values, (slice(None), 0), np.nan), "no SO2 readings"),
        (
            lambda r: put(r.values, (slice(None), 1), r.values[:, 1] / 100.0),
            r"CO2 has a median of 4\.\d+ ppm; air has 250 to 5",
        ),
        (lambda r: put(r.values, (slice(None), 1), r.values[:, 1] * 1000.0), "check the unit"),
        (lambda r: put(r.values, 5, 1e9), r"SO2 reaches 1e\+09 ppb"),
        (
            lambda r: put(r.values, (5, 0), -9999999.0),
            r"SO2 reaches -1e\+07 ppb; at most 1e\+06 ppb of either sign can be",
        ),
        (
            lambda r: Readings(1714560000.5 + np.repeat(r.time[::2], 2)[:100], r.values[:100]),
            "1714560000.5 s is followed by 1714560000.5 s",
        ),
        (
            lambda r: put(r.time, 7, r.time[6]),
            "times do not increase: 6 s is followed by 6 s; sort the record",
        ),
        (lambda r: put(r.time, slice(None), r.time[::-1].copy()), "times do not increase"),
        (lambda r: put(r.time, 7, np.nan), "time of sample 7 is not a number"),
        (
            lambda r: put(r.time, slice(None), 1000.0 * r.time),
            r"samples are 1000 s apart \(median\); they must be 0.001 to 30 s apart",
        ),
        (
            lambda r: put(r.time, slice(None), r.time / 3600.0),
            r"samples are 0.000277778 s apart \(median\)",
        ),
        (
            lambda r: Readings(r.time[:5], r.values[:5]),
            "the record has 5 samples; it needs at least 8",
        ),
        (lambda r: Readings(r.time[:0], r.values[:0]), "the record has 0 samples"),
        (
            lambda r: Readings(r.time, r.values[:, :2]),
            r"readings have shapes \(121,\) and \(121, 2\)",
        ),
    ],
)
def test_records_that_cannot_be_are_refused_in_one_line(change, message):
    with pytest.raises(MeasurementError, match=message) as caught:
        estimate(with_change(READINGS, change), SPEC)
    assert "\n" not in str(caught.value)


def assert_no_verdict(found, reason):
    assert found.quality == "C"
    assert reason in " ".join(found.quality_reasons)
    assert {verdict.verdict for verdict in found.verdicts} == {"open"}


def test_a_flight_that_met_no_plume_has_no_result():
    spec = sensor_preset("electrochemical")
    still = crossings(0.25, peak=0.0)
    for seed in range(4):
        found = estimate(read(spec, still, seed=seed), spec)
        assert_no_verdict(found, "no pass through a plume: CO2 is nowhere 5.0 ppm")
        assert math.isnan(found.fsc_percent)
        assert math.isnan(found.total_percent)
        assert all(math.isnan(verdict.probability_above) for verdict in found.verdicts)


def test_clean_air_in_whole_numbers_has_no_verdict():
    # Nothing is known of the noise, and rounding hides it: more than a tenth of the second
    # differences are 0.
    verdicts, time = 0, np.arange(300.0)
    for seed, sigma in enumerate(6 * [0.0, 0.1, 0.3, 0.5, 0.7, 1.0, 3.0]):
        generator, values = np.random.default_rng(seed), np.full((300, 4), np.nan)
        for column, level in ((0, 2.0), (1, 420.0)):
            values[:, column] = np.round(level + sigma * generator.normal(size=300))
        verdicts += estimate(Readings(time, values), sensor_preset("unspecified")).quality != "C"
    # Noise that is not rounded is taken for a pass in 1.5 % of such records: of 42 records 0.6 are
    # expected, and more than two in 3 of 100 such tests.
    assert verdicts <= 2


def test_the_noise_of_whole_numbers_is_that_before_rounding_and_of_rounding():
    generator, time = np.random.default_rng(1), np.arange(20_000.0)
    for sigma in (0.7, 1.0, 2.0):
        readings = Readings(
            time,
            np.round(
                np.array([50.0, 420.0, 0.0, 0.0]) + sigma * generator.normal(size=(len(time), 4))
            ),
        )
        spec = sensor_preset("unspecified")
        # Rounding to 1 adds a variance of 1/12. What is rounded is less normal the coarser it is: 7
        # % at 0.7.
        expected = math.hypot(sigma, 1.0 / math.sqrt(12.0))
        assert readings_noise(checked_record(readings, spec), spec)["co2"] == pytest.approx(
            expected, rel=0.1
        )


def test_a_single_pass_that_the_record_cuts_off_is_reported_as_that():
    spec = plain_sniffer(so2_noise=1.0, co2_noise=1.0)
    readings = read(spec, crossings(0.25, duration=100.0, interval=200.0, first=80.0, meander=0.0))
    found = estimate(readings, spec, method="areas")
    assert found.figures.passes == 1
    assert "the record ends before an SO2 channel with a t90 of 20 s has read the pass" in " ".join(
        found.quality_reasons
    )
    assert "nan" not in " ".join(found.quality_reasons)


def test_a_gas_with_next_to_no_readings_is_named_as_what_to_leave_out():
    readings, spec = flight("electrochemical", 0.25, 1)
    readings.values[3:, 3] = math.nan
    assert outcome(readings, spec).endswith(
        "give a record with fewer gaps, or leave out the column of NO2, which has fewest"
    )


def test_a_plume_below_the_detection_limit_is_none():
    spec = sensor_preset("electrochemical")
    assert_no_verdict(
        estimate(read(spec, crossings(0.25, peak=4.0)), spec), "no pass through a plume"
    )


def test_a_record_shorter_than_a_crossing_and_its_response_has_no_verdict():
    readings, spec = flight("electrochemical", 0.5, 1)
    short = Readings(readings.time[8:24], readings.values[8:24])
    assert_no_verdict(
        estimate(short, spec), "the record lasts 15 s; a pass and the response of SO2 take"
    )


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (
            lambda r: put(r.values, (slice(40, 60), 0), 20000.0),
            "SO2 is saturated at 20000 ppb in 6.6 % of the readings",
        ),
        (
            lambda r: put(r.values, 50, [-400.0, 420.0, 0.0, 0.0]),
            "SO2 reads -400 ppb, which its noise and zero do not explain",
        ),
        (lambda r: put(r.values, (50, 1), -3.0), "CO2 reads -3 ppm"),
        (
            lambda r: put(r.values, (slice(50, 70), 1), 2.0 + 0.1 * np.arange(20)),
            "CO2 reads 2 ppm, which its noise and zero do not explain (from 208 ppm)",
        ),
        (
            lambda r: put(r.values, (slice(50, 90), 2), np.nan),
            "13 % of NO is missing; at most 10 % may be",
        ),
    ],
)
def test_readings_that_a_sensor_cannot_have_leave_no_verdict(change, reason):
    readings, spec = flight("electrochemical", 0.5, 1)
    assert_no_verdict(estimate(with_change(readings, change), spec), reason)


@pytest.mark.parametrize(
    ("name", "noise", "fsc"),
    [
        ("electrochemical", "its noise is 2.5 ppb", 0.001),
        ("unspecified", "is about 1 ppb", 0.25),
    ],
)
def test_so2_in_ppm_has_no_verdict(name, noise, fsc):
    readings, _ = flight("electrochemical", fsc, 1)
    # As in a log: rounded to a tenth of a ppb.
    in_ppm = with_column(readings, 0, readings.values[:, 0].round(1) / 1000.0)
    found = estimate(in_ppm, sensor_preset(name))
    assert_no_verdict(found, noise)
    assert (
        "it is in another unit (of ppm, give a [scale] of so2 = 1000.0), or its sensor is dead"
        in " ".join(found.quality_reasons)
    )


@pytest.mark.parametrize("name", ["electrochemical", "unspecified"])
def test_an_so2_sensor_that_is_dead_has_no_verdict(name):
    readings, _ = flight("electrochemical", 0.25, 1)
    dead = with_column(readings, 0, 3.0)
    assert_no_verdict(estimate(dead, sensor_preset(name)), "SO2 reads the same throughout")


@pytest.mark.parametrize(
    ("analyst", "decimals"),
    [("electrochemical", 0), ("fast", 1), ("laser", 0), ("unspecified", 3)],
)
def test_a_clean_ship_with_ordinary_noise_is_no_dead_sensor(analyst, decimals):
    # The quietest preset has 0.3 ppb, which rounding to whole numbers does not hide.
    readings, spec = flight("laser" if analyst == "unspecified" else analyst, 0.001, 1)
    rounded = with_column(readings, 0, readings.values[:, 0].round(decimals))
    found = estimate(rounded, spec if analyst != "unspecified" else sensor_preset("unspecified"))
    assert "another unit" not in " ".join(found.quality_reasons)
    # Whole numbers misfit the 0.3 ppb that are stated of the laser, which is another matter.
    assert found.quality != "C" or decimals == 0


def test_rounding_that_is_known_to_be_coarse_is_no_dead_sensor():
    readings, spec = flight("electrochemical", 0.001, 1)
    coarse = with_column(readings, 0, 0.0)
    found = estimate(coarse, changed(spec, "so2", resolution=100.0))
    assert "another unit" not in " ".join(found.quality_reasons)


def test_a_gap_longer_than_the_pieces_of_the_background_leaves_no_verdict():
    # A knot of the background every 120 s: within a gap of 600 s some have no sample.
    readings, spec = flight("electrochemical", 0.5, 1)
    time = readings.time + np.where(readings.time < 150.0, 0.0, 600.0)
    assert_no_verdict(
        estimate(Readings(time, readings.values), spec), "gaps make up 67 % of the record"
    )


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"method": "magic"}, "method is 'magic'; it must be 'regression' or 'areas'"),
        ({"carbon": 87.0}, r"carbon is 87; a fuel's mass share of carbon must be 0.5 to 0.95"),
        ({"carbon": math.nan}, "carbon is nan"),
        ({"limits_percent": ()}, r"limits_percent is \[\]; give one or more"),
        ({"limits_percent": (-0.1,)}, "give one or more numbers above 0"),
    ],
)
def test_parameters_out_of_range_are_refused(keywords, message):
    for function in (estimate, over_time):
        with pytest.raises(MeasurementError, match=message):
            function(READINGS, SPEC, **keywords)


def test_an_instrument_without_the_channels_is_refused():
    with pytest.raises(MeasurementError, match="or 'test' no such channel"):
        estimate(READINGS, sniffer_of(Channel(gas="so2", t90_s=20.0, noise=1.0)))


def test_areas_need_a_response_that_is_given():
    with pytest.raises(MeasurementError, match="t90 and delay of 'test' are not both given"):
        estimate(READINGS, changed(SPEC, "so2", t90_sd=math.inf), method="areas")


def test_random_records_give_an_estimate_or_a_line():
    generator = np.random.default_rng(3)
    spec = sensor_preset("unspecified")
    lines = 0
    for _ in range(40):
        length = int(generator.integers(0, 60))
        time = np.cumsum(generator.exponential(1.0, length))
        values = generator.normal(0.0, 10.0 ** generator.uniform(-2, 4), (length, 4)) + np.array(
            [0.0, 420.0, 0.0, 0.0]
        )
        values[generator.random(values.shape) < 0.05] = np.nan
        found = outcome(Readings(time, values), spec)
        # Of noise nothing is known.
        assert "\n" not in found if isinstance(found, str) else found.quality == "C"
        lines += isinstance(found, str)
    assert 0 < lines < 40
