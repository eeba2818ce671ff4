"""Both methods against what follows in closed form for Gaussian passes and lags of first order."""

import math

import numpy as np
import pytest
from crossings import changed, crossings, plain_sniffer, read

from measurement.estimate.areas import area_ratio
from measurement.estimate.estimator import estimate
from measurement.estimate.fit import fit_record
from measurement.estimate.passes import find_passes
from measurement.estimate.record import checked_record
from measurement.gases import fsc_factor
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_preset

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("method", ["regression", "areas"])
@pytest.mark.parametrize("t90", [1.0, 5.0, 20.0])
def test_equal_responses_read_the_ratio_of_the_air_by_both_methods(method, t90):
    # Equal channels are the same filter of the same air: their ratio is that of the air, and what
    # is not corrected adds 0.2322 sum k_j Q_j/Q_CO2: 20.7 and 2.3 ppb/ppm of NO and NO2.
    other = {"cross": {"no": 0.015, "no2": -0.16}} if t90 == 5.0 else {}
    added = fsc_factor() * (0.015 * 20.7 - 0.16 * 2.3) if other else 0.0
    readings = read(plain_sniffer(t90, t90, **other), crossings(0.25))
    found = estimate(readings, plain_sniffer(t90, t90), method=method)
    assert found.fsc_percent == pytest.approx(0.25 + added, rel=1e-6)


@pytest.mark.parametrize("second_pole", [0.0, 0.5])
def test_regression_of_unequal_responses_is_unbiased_where_samples_are_dense(second_pole):
    # At 20 Hz a reading is as good as straight between samples: (step/tau)^2/12 of the fast channel
    # is 7e-5.
    spec = plain_sniffer(rate_hz=20.0, second_pole=second_pole)
    found = estimate(read(spec, crossings(0.25, step=0.05, duration=120.0), step=0.05), spec)
    assert found.fsc_percent == pytest.approx(0.25, rel=1e-3)


@pytest.mark.parametrize(("gas", "name"), [("so2", "t90_s"), ("so2", "delay_s"), ("co2", "t90_s")])
def test_an_instrument_off_by_what_is_stated_is_off_by_what_is_stated(gas, name):
    # The readings tell t90 and delay better than they are stated: taken as stated, 5 % of t90 are
    # 2.5 % of the result, 0.006 % m/m, and 0.3 s are 3.4 %.
    stated = plain_sniffer(20.0, 4.0, so2_noise=0.1, co2_noise=0.1, rate_hz=10.0, delay_s=2.0)
    stated = changed(stated, "so2", t90_sd=0.05, delay_sd_s=0.3)
    stated = changed(stated, "co2", t90_sd=0.05, delay_s=2.0, delay_sd_s=0.3)
    move = {"t90_s": stated.known(gas).t90_s * 0.05, "delay_s": 0.3}[name]
    actual = changed(stated, gas, **{name: getattr(stated.known(gas), name) + move})
    air = crossings(0.25, duration=120.0)
    right, wrong = (estimate(read(spec, air), stated) for spec in (stated, actual))
    stated_by_fit = math.hypot(wrong.common_percent["response"], wrong.noise_percent)
    assert stated_by_fit < 0.5 * 0.006
    assert abs(wrong.fsc_percent - right.fsc_percent) < 2.0 * stated_by_fit


def test_areas_of_overlapping_passes_read_what_is_predicted():
    # The issue asks for 10 %; 1.9 % were measured. Sums of exponentials with the dose of each pass,
    # against areas without noise.
    spec = plain_sniffer(20.0, 4.0)
    for seed in range(2):
        readings = read(spec, crossings(0.25, seed=seed))
        record = checked_record(readings, spec)
        found = area_ratio(
            record, spec, find_passes(record, changed(spec, "co2", noise=1.0).known("co2"))
        )
        assert found.share == pytest.approx(fsc_factor() * found.ratio / 0.25, rel=0.03)
        assert fsc_factor() * found.separate == pytest.approx(0.25, rel=0.03)
        assert 0.2 < found.share < 0.5
    # What areas would read more of separate passes, which have no bias 2.8 t90 apart (section 0,
    # item 3): less than 1.5 %.
    crossed = estimate(readings, spec, method="areas")
    assert crossed.fsc_percent + crossed.overlap_percent == pytest.approx(0.25, rel=0.03)
    assert crossed.quality == "C"
    assert "overlap in an SO2 channel with a t90 of 20 s" in crossed.quality_reasons[0]
    apart = read(spec, crossings(0.25, interval=75.0, duration=450.0))
    separate = estimate(apart, spec, method="areas")
    assert separate.fsc_percent == pytest.approx(0.25, rel=0.015)
    assert separate.quality != "C"


@pytest.mark.parametrize(("preset", "duration"), [("laser", 60.0), ("fast", 180.0)])
def test_areas_of_separate_passes_are_whole_wherever_between_two_samples_they_come(
    preset, duration
):
    spec = sensor_preset(preset)
    for phase in np.linspace(0.0, 1.0 / spec.rate_hz, 4):
        air = crossings(
            0.2, duration=duration, step=0.02, interval=60.0, meander=0.0, first=30.0 + phase
        )
        record = checked_record(read(spec, air, step=0.02), spec)
        found = area_ratio(record, spec, find_passes(record, spec.known("co2")))
        # 0.79 to 1.25, as long as what is read of a puff was taken at single moments.
        assert found.share == pytest.approx(1.0, abs=0.01)


def test_areas_and_doses_do_not_depend_on_the_gains():
    results = []
    for so2, co2 in ((1.0, 1.0), (1.3, 1.0), (0.8, 1.0), (1.0, 1.5)):
        spec = changed(
            changed(plain_sniffer(20.0, 4.0, so2_noise=1.0, co2_noise=1.0), "so2", gain=so2),
            "co2",
            gain=co2,
        )
        # A reading's noise is that of its sensor, and counts for less where the gain is larger.
        found = estimate(read(spec, crossings(0.25, interval=75.0)), spec, method="areas")
        results.append((found.fsc_percent, found.overlap_percent, found.figures.dose_ppm_s))
    assert np.array(results[1:]) == pytest.approx(np.array(3 * [results[0]]), rel=0.02, abs=0.001)


@pytest.mark.parametrize("estimated", [False, True], ids=["stated", "estimated"])
def test_gaps_in_a_plume_leave_a_delayed_channel_nothing_that_was_not_read(estimated):
    # Gaps of 4 s beside the passes, once a minute: a delay of 10 s gave 0.39 % of 0.25, with a
    # standard uncertainty of 0.02.
    spec = plain_sniffer(5.0, 3.0, so2_noise=0.5, co2_noise=0.5, delay_s=10.0)
    readings = read(
        spec, crossings(0.25, duration=450.0, interval=30.0, meander=0.0, width=2.0), seed=1
    )
    kept = ~((readings.time % 60.0 > 40.0) & (readings.time % 60.0 < 45.0))
    if estimated:
        spec = changed(spec, "so2", t90_sd=math.inf, delay_sd_s=math.inf)
    found = estimate(Readings(readings.time[kept], readings.values[kept]), spec)
    assert found.fsc_percent == pytest.approx(0.25, rel=0.02)
    assert found.quality != "C"


def test_a_record_that_begins_in_a_pass_is_read_from_when_all_channels_read_it():
    spec = plain_sniffer(15.0, 3.0, so2_noise=1.0, co2_noise=0.5, delay_s=10.0)
    readings = read(
        spec, crossings(0.25, duration=200.0, interval=30.0, meander=0.0, width=2.0), seed=1
    )
    # From the top of a pass on, which comes to the SO2 ten seconds later: 0.203 % in place of 0.25.
    found = estimate(Readings(readings.time[13:], readings.values[13:]), spec)
    assert found.fsc_percent == pytest.approx(0.25, rel=0.02)
    assert found.quality == "A"


def test_an_uneven_record_is_the_same_wherever_its_times_begin():
    spec = plain_sniffer(20.0, 4.0, so2_noise=0.5, co2_noise=0.5, rate_hz=10.0)
    readings = read(spec, crossings(0.25, interval=30.0, meander=0.0, width=2.0), seed=2)
    # A row each second, of which a fifth is half a second late. Since 1970 they passed for even
    # ones.
    rows = 10 * np.arange(150)
    rows[1:-1] += 5 * (np.random.default_rng(3).random(148) < 0.2)
    found, other = (
        estimate(Readings(readings.time[rows] + origin, readings.values[rows]), spec)
        for origin in (0.0, 1.78e9)
    )
    assert other.fsc_percent == pytest.approx(found.fsc_percent, rel=1e-5)
    assert other.misfit == pytest.approx(found.misfit, rel=1e-3)
    assert found.misfit < 1.5


def test_results_cached_with_a_record_are_those_of_a_new_record():
    # Passes so far from each other that a window is as long as the slowest response asks for.
    spec = sensor_preset("electrochemical")
    readings = read(spec, crossings(0.3, duration=120.0, interval=75.0))
    so2, co2 = spec.known("so2"), spec.known("co2")
    instruments = [
        spec,
        changed(spec, "so2", t90_s=1.3 * so2.t90_s),
        changed(spec, "co2", t90_s=1.3 * co2.t90_s),
        changed(spec, "no2", t90_s=3.0 * so2.t90_s),
        changed(spec, "so2", delay_s=so2.delay_s + 2.0),
        changed(spec, "co2", delay_s=co2.delay_s + 2.0),
        changed(spec, "so2", gain=1.1),
    ]
    cached = checked_record(readings, spec)
    passes = find_passes(cached, co2)
    for instrument in [*instruments, spec]:
        new = checked_record(readings, spec)
        # To the last bit.
        assert area_ratio(cached, instrument, passes) == area_ratio(new, instrument, passes)
        slopes = [fit_record(record, instrument).slope for record in (cached, new)]
        assert slopes[0] == slopes[1]
