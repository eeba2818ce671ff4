"""Records that cannot be used are refused in a line, and weak ones have no verdict."""

import math

import numpy as np
import pytest
from crossings import changed, crossings, flight, plain_sniffer, read, sniffer_of, with_column

from measurement.errors import MeasurementError
from measurement.estimate.estimator import estimate
from measurement.estimate.record import checked_record, readings_noise
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_preset

pytestmark = pytest.mark.slow

SPEC = plain_sniffer(so2_noise=2.5, co2_noise=1.0)
READINGS = read(SPEC, crossings(0.25, duration=120.0))


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
            lambda r: put(r.values, (slice(None), 1), 4.2),
            r"CO2 has a median of 4\.2 ppm; air has 250",
        ),
        (lambda r: put(r.values, (slice(None), 1), 1000.0 * r.values[:, 1]), "check the unit"),
        (lambda r: put(r.values, 5, 1e9), r"SO2 reaches 1e\+09 ppb"),
        (lambda r: put(r.values, (5, 0), -9999999.0), r"SO2 reaches -1e\+07 ppb; at most 1e\+06"),
        (lambda r: put(r.time, 7, r.time[6]), "6 s is followed by 6 s; sort the record"),
        (lambda r: put(r.time, slice(None), r.time[::-1].copy()), "times do not increase"),
        (lambda r: put(r.time, 7, np.nan), "time of sample 7 is not a number"),
        (
            lambda r: put(r.time, slice(None), 1000.0 * r.time),
            r"samples are 1000 s apart \(median\); they must be 0.001 to 30 s apart",
        ),
        (lambda r: put(r.time, slice(None), r.time / 3600.0), r"samples are 0.000277778 s apart"),
        (
            lambda r: Readings(r.time[:5], r.values[:5]),
            "the record has 5 samples; it needs at least 8",
        ),
        (lambda r: Readings(r.time, r.values[:, :2]), r"shapes \(121,\) and \(121, 2\)"),
    ],
)
def test_records_that_cannot_be_are_refused_in_one_line(change, message):
    with pytest.raises(MeasurementError, match=message) as caught:
        estimate(with_change(READINGS, change), SPEC)
    assert "\n" not in str(caught.value)


def test_parameters_and_instruments_that_cannot_be_are_refused():
    found_t90 = changed(SPEC, "so2", t90_sd=math.inf)
    no_co2 = sniffer_of(Channel(gas="so2", t90_s=20.0, noise=1.0))
    for spec, keywords, message in (
        (SPEC, {"method": "magic"}, "method is 'magic'; it must be 'regression' or 'areas'"),
        (SPEC, {"carbon": 87.0}, "carbon is 87; a fuel's mass share of carbon must be 0.5 to 0.95"),
        (SPEC, {"carbon": math.nan}, "carbon is nan"),
        (SPEC, {"limits_percent": ()}, r"limits_percent is \[\]; give one or more"),
        (SPEC, {"limits_percent": (-0.1,)}, "give one or more numbers above 0"),
        (no_co2, {}, "or 'test' no such channel"),
        (found_t90, {"method": "areas"}, "t90 and delay of 'test' are not both given"),
    ):
        with pytest.raises(MeasurementError, match=message):
            estimate(READINGS, spec, **keywords)


def test_random_records_give_a_refusal_or_no_verdict():
    generator = np.random.default_rng(3)
    spec = sensor_preset("unspecified")
    lines = 0
    for _ in range(40):
        length = int(generator.integers(0, 60))
        time = np.cumsum(generator.exponential(1.0, length))
        values = generator.normal(0.0, 10.0 ** generator.uniform(-2, 4), (length, 4))
        values += np.array([0.0, 420.0, 0.0, 0.0])
        values[generator.random(values.shape) < 0.05] = np.nan
        try:
            found = estimate(Readings(time, values), spec)
        except MeasurementError:
            lines += 1
        else:
            # Of noise nothing is known.
            assert found.quality == "C"
    assert 0 < lines < 40


def assert_no_verdict(found, reason):
    assert found.quality == "C"
    assert reason in " ".join(found.quality_reasons)
    assert {verdict.verdict for verdict in found.verdicts} == {"open"}


def test_a_flight_that_met_no_plume_has_no_result():
    spec = sensor_preset("electrochemical")
    still = crossings(0.25, peak=0.0)
    # The second is below the detection limit.
    for air in (still, crossings(0.25, peak=4.0)):
        found = estimate(read(spec, air), spec)
        assert_no_verdict(found, "no pass through a plume: CO2 is nowhere 5.0 ppm")
        assert math.isnan(found.fsc_percent)
        assert math.isnan(found.total_percent)
        assert all(math.isnan(verdict.probability_above) for verdict in found.verdicts)


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
    assert_no_verdict(found, "ends before an SO2 channel with a t90 of 20 s has read the pass")
    assert "nan" not in " ".join(found.quality_reasons)


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
            "SO2 is saturated at 20000 ppb in 13",
        ),
        (lambda r: put(r.values, (slice(None), 0), 3.0), "SO2 reads the same throughout"),
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
            lambda r: put(r.values, (slice(50, 70), 2), np.nan),
            "13 % of NO is missing; at most 10 %",
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


@pytest.mark.parametrize(("preset", "decimals"), [("electrochemical", 0), ("fast", 1)])
def test_a_clean_ship_with_ordinary_noise_is_no_dead_sensor(preset, decimals):
    readings, spec = flight(preset, 0.001, 1)
    rounded = with_column(readings, 0, readings.values[:, 0].round(decimals))
    found = estimate(rounded, spec)
    assert "another unit" not in " ".join(found.quality_reasons)
    assert found.quality != "C" or decimals == 0


def test_a_gap_longer_than_the_pieces_of_the_background_leaves_no_verdict():
    # A knot of the background every 120 s: within a gap of 600 s some have no sample.
    readings, spec = flight("electrochemical", 0.5, 1)
    time = readings.time + np.where(readings.time < 75.0, 0.0, 600.0)
    found = estimate(Readings(time, readings.values), spec)
    assert_no_verdict(found, "gaps make up 80 % of the record")
