"""Records that cannot be used are refused in a line, and weak ones have no verdict."""

import math

import numpy as np
import pytest
from crossings import changed, crossings, flight, plain_sniffer, read, sniffer_of

from measurement.errors import MeasurementError
from measurement.estimate import estimate, over_time
from measurement.sniffer import Channel, Readings, sensor_preset

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
        (lambda r: put(r.time, 7, r.time[6]), "times do not increase: 6 s is followed by 6 s; sort the record"),
        (lambda r: put(r.time, slice(None), r.time[::-1].copy()), "times do not increase"),
        (lambda r: put(r.time, 7, np.nan), "time of sample 7 is not a number"),
        (lambda r: Readings(r.time[:5], r.values[:5]), "the record has 5 samples; it needs at least 8"),
        (lambda r: Readings(r.time[:0], r.values[:0]), "the record has 0 samples"),
        (lambda r: Readings(r.time, r.values[:, :2]), r"readings have shapes \(121,\) and \(121, 2\)"),
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
    for seed in range(10):
        found = estimate(read(spec, still, seed=seed), spec)
        assert_no_verdict(found, "no pass through a plume: CO2 is nowhere 5.0 ppm")
        assert math.isnan(found.fsc_percent)
        assert math.isnan(found.total_percent)
        assert all(math.isnan(verdict.probability_above) for verdict in found.verdicts)


def test_a_plume_below_the_detection_limit_is_none():
    spec = sensor_preset("electrochemical")
    assert_no_verdict(estimate(read(spec, crossings(0.25, peak=4.0)), spec), "no pass through a plume")


def test_a_record_shorter_than_a_crossing_and_its_response_has_no_verdict():
    readings, spec = flight("electrochemical", 0.5, 1)
    short = Readings(readings.time[8:24], readings.values[8:24])
    assert_no_verdict(estimate(short, spec), "the record lasts 15 s; a pass and the response of SO2 take")


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda r: put(r.values, (slice(40, 60), 0), 20000.0), "SO2 is saturated at 20000 ppb in 6.6 % of the readings"),
        (lambda r: put(r.values, 50, [-400.0, 420.0, 0.0, 0.0]), "SO2 reads -400 ppb, which its noise and zero do not explain"),
        (lambda r: put(r.values, (50, 1), -3.0), "CO2 reads -3 ppm"),
        (lambda r: put(r.values, (slice(50, 90), 2), np.nan), "13 % of NO is missing; at most 10 % may be"),
    ],
)
def test_readings_that_a_sensor_cannot_have_leave_no_verdict(change, reason):
    readings, spec = flight("electrochemical", 0.5, 1)
    assert_no_verdict(estimate(with_change(readings, change), spec), reason)


def test_a_record_that_is_mostly_gap_has_no_verdict():
    readings, spec = flight("electrochemical", 0.5, 1)
    rows = (readings.time < 60.0) | (readings.time > 200.0)
    assert_no_verdict(estimate(Readings(readings.time[rows], readings.values[rows]), spec), "gaps make up 47 % of the record")


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"method": "magic"}, "method is 'magic'; it must be 'regression' or 'areas'"),
        ({"carbon": 87.0}, r"carbon is 87; a fuel's mass share of carbon must be 0.5 to 0.95"),
        ({"carbon": math.nan}, "carbon is nan"),
        ({"limits_percent": ()}, r"limits are \(\) %"),
        ({"limits_percent": (-0.1,)}, "give one or more of 0 to 10"),
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
        values = generator.normal(0.0, 10.0 ** generator.uniform(-2, 4), (length, 4)) + np.array([0.0, 420.0, 0.0, 0.0])
        values[generator.random(values.shape) < 0.05] = np.nan
        found = outcome(Readings(time, values), spec)
        # Of noise nothing is known.
        assert "\n" not in found if isinstance(found, str) else found.quality == "C"
        lines += isinstance(found, str)
    assert 0 < lines < 40
