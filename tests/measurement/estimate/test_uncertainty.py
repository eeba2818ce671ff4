"""Noise and its stated variance by Monte Carlo, coverage of the stated interval, response and delay
that are not given.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from crossings import changed, crossings, flight, plain_sniffer, read

from measurement.estimate.areas import area_ratio
from measurement.estimate.estimator import estimate
from measurement.estimate.fit import fit_record
from measurement.estimate.passes import find_passes
from measurement.estimate.record import checked_record
from measurement.estimate.signals import make_signals
from measurement.gases import GASES, fsc_factor
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_of, sensor_preset

pytestmark = pytest.mark.slow

REPEATS = 60
"""They give a standard deviation to 9 %; twice that is the tolerance, and the seeds are always the
same.
"""


def repeated(spec, air, estimator):
    """Return slopes and stated deviations of the same flight with other noise."""
    found = [
        estimator(checked_record(read(spec, air, seed=seed, step=1.0 / spec.rate_hz), spec))
        for seed in range(REPEATS)
    ]
    return np.array([slope for slope, _ in found]), np.array([noise for _, noise in found])


@pytest.mark.parametrize(
    "spec",
    [
        plain_sniffer(co2_noise=4.0),
        plain_sniffer(so2_noise=1.0, random_walk=1.0),
        plain_sniffer(4.0, 20.0, so2_noise=2.5, co2_noise=1.0),
        plain_sniffer(second_pole=0.5, so2_noise=2.5),
    ],
    ids=["CO2 alone", "drift", "CO2 slower", "two poles"],
)
def test_the_stated_noise_of_the_regression_is_its_scatter(spec):
    of_co2_alone = spec.known("so2").noise == 0.0
    peak = 60.0 if of_co2_alone else 200.0
    air, misfits = crossings(0.25, duration=80.0, step=1.0, width=1.5, peak=peak), []

    def estimator(record):
        found = fit_record(record, spec)
        misfits.append(found.residuals.misfit)
        return found.slope, found.noise

    slopes, stated = repeated(spec, air, estimator)
    assert np.std(slopes) == pytest.approx(np.sqrt(np.mean(stated**2)), rel=0.18)
    # The slope takes 1 of 70 degrees of freedom; a drift has next to none, and noise of CO2 has
    # fewer after the lag of SO2.
    drifts = spec.known("so2").random_walk > 0.0
    tolerance = 0.2 if drifts else 0.1 if of_co2_alone else 0.05
    assert np.mean(misfits) == pytest.approx(1.0, abs=tolerance)
    # Noise in CO2 does not attenuate the slope, as it would that of a regression: by the noise's
    # share of the CO2 energy. A quotient of noisy sums keeps a bias of second order, its relative
    # variance.
    if of_co2_alone:
        exact = plain_sniffer()
        clean = fit_record(checked_record(read(exact, air, step=1.0), exact), exact).slope
        signals = make_signals(checked_record(read(spec, air, step=1.0), spec), spec)
        co2, _ = signals.excess
        noise_energy = signals.noise("co2") ** 2 * signals.noise_energy("co2")
        attenuation = noise_energy / (float(co2 @ co2) - noise_energy)
        tolerance = 4.0 * np.std(slopes) / math.sqrt(REPEATS) + np.var(slopes) / clean
        assert abs(np.mean(slopes) - clean) < tolerance
        assert attenuation * clean > 2.0 * tolerance


def test_the_stated_noise_of_areas_is_its_scatter():
    spec = plain_sniffer(so2_noise=2.5, co2_noise=1.0)
    air = crossings(0.25, duration=240.0, step=1.0, width=1.5, interval=75.0)
    passes = find_passes(checked_record(read(spec, air, step=1.0), spec), spec.known("co2"))

    def estimator(record):
        found = area_ratio(record, spec, passes)
        return found.ratio, found.noise

    slopes, stated = repeated(spec, air, estimator)
    assert np.std(slopes) == pytest.approx(np.sqrt(np.mean(stated**2)), rel=0.16)


def test_one_pass_is_as_good_as_a_matched_filter_can_be():
    # u(area) >= sigma sqrt(2 tau / f_s) with a known background (section 4.4); a background to be
    # found costs more.
    spec = plain_sniffer(20.0, 0.5, so2_noise=2.5, rate_hz=10.0)
    air = crossings(0.25, duration=200.0, interval=1000.0, first=60.0, width=0.3)
    found = fit_record(checked_record(read(spec, air), spec), spec)
    dose = 0.1 * float(np.sum(air[:, 1] - 420.0))
    least = 2.5 * math.sqrt(2.0 * 20.0 / math.log(10.0) / 10.0)
    assert least < found.noise * dose < 1.35 * least


def test_noise_falls_with_the_root_of_passes_and_common_errors_do_not():
    readings, spec = flight("electrochemical", 0.1, 3, duration=320.0)
    short = estimate(Readings(readings.time[:81], readings.values[:81]), spec)
    long = estimate(readings, spec)
    assert long.noise_percent / short.noise_percent == pytest.approx(0.5, abs=0.12)
    long_errors, short_errors = long.common_percent, short.common_percent
    assert long_errors["no2"] == pytest.approx(short_errors["no2"], rel=0.35)
    # Nearly a share of the content, by 3 % of the gain of SO2 and 2 % of CO2.
    for found in (long, short):
        assert found.common_percent["calibration"] > 0.03 * found.fsc_percent


def test_stated_intervals_cover_and_are_as_narrow_as_asked():
    # 91 to 98 % are asked of 200 flights and more; of 40, 34 are fewer than 1 in 100 times fewer by
    # chance where 95 % is true.
    largest = 0.03
    flights = [flight("electrochemical", 0.1, seed, duration=100.0) for seed in range(40)]
    found = [estimate(readings, spec) for readings, spec in flights]
    assert sum(e.low_percent <= 0.1 <= e.high_percent for e in found) >= 34
    assert np.std([e.fsc_percent for e in found]) < largest
    assert np.mean([e.fsc_percent for e in found]) == pytest.approx(
        0.1, abs=0.005 + 3.0 * largest / math.sqrt(40)
    )
    # A simulation that states less than 0.01 % of an electrochemical sniffer misses an error
    # (section 4.7).
    assert min(e.total_percent for e in found) > 0.01


def test_response_and_delay_are_found_where_they_are_not_given():
    actual = plain_sniffer(23.0, 4.0, so2_noise=2.5, co2_noise=1.0, delay_s=3.0)
    readings = read(actual, crossings(0.5))
    unknown = changed(actual, "so2", t90_s=8.0, t90_sd=math.inf, delay_s=0.0, delay_sd_s=math.inf)
    # A delay before CO2, too.
    early = changed(plain_sniffer(so2_noise=1.0, co2_noise=1.0), "co2", delay_s=2.5)
    before = estimate(read(early, crossings(0.5)), changed(early, "so2", delay_sd_s=math.inf))
    assert before.delay_sd_s < 0.1
    assert before.delay_s == pytest.approx(-2.5, abs=0.15)
    found = estimate(readings, unknown)
    assert found.so2_t90_s == pytest.approx(23.0, abs=3.0 * found.so2_t90_sd_s)
    # Sampling at 1 Hz adds to the noise: 0.1 s.
    assert found.delay_s == pytest.approx(3.0, abs=3.0 * found.delay_sd_s + 0.1)
    assert found.fsc_percent == pytest.approx(0.5, abs=2.5 * found.total_percent)
    given = estimate(readings, actual)
    assert found.common_percent["response"] > given.common_percent["response"]


def test_response_and_delay_are_found_without_bias_where_other_gases_correct_so2():
    # NO2 between samples has less noise than on them, 0.64 of its square halfway. Left out of
    # account, that drew flights to 18.0 s and 0.13 s in the mean, and their fuels to 0.187 %; each
    # t90 is known to 1 s, each delay to 0.04 s.
    spec = sensor_preset("electrochemical")
    for gas in GASES:
        cross = dict.fromkeys(spec.known(gas).cross_sd, 0.0)
        exact = dict.fromkeys(("t90_sd", "delay_sd_s", "gain_sd", "zero_sd", "random_walk"), 0.0)
        spec = changed(spec, gas, cross_sd=cross, **exact)
    unknown = changed(spec, "so2", t90_sd=math.inf, delay_sd_s=math.inf)
    found = [
        estimate(read(spec, crossings(0.2, duration=300.0, seed=seed + 9999), seed=seed), unknown)
        for seed in range(6)
    ]
    assert np.mean([each.so2_t90_s for each in found]) == pytest.approx(20.0, abs=1.2)
    assert np.mean([each.delay_s for each in found]) == pytest.approx(0.0, abs=0.07)
    assert np.mean([each.fsc_percent for each in found]) == pytest.approx(0.2, abs=0.007)


def test_readings_that_are_far_apart_have_an_interval_that_holds_what_lies_between():
    # Every second, 4.6 time constants of CO2 apart: up to 7.7 % too much, on which averaging over
    # passes has no effect.
    exact = replace(
        plain_sniffer(5.0, 0.5, so2_noise=0.01, co2_noise=0.01, delay_s=0.5), rate_hz=1.0
    )
    for seed in range(3):
        found = estimate(read(exact, crossings(0.2, step=0.05, seed=seed), step=0.05), exact)
        assert found.low_percent < 0.2 < found.high_percent


def without_nox(readings):
    return Readings(readings.time, np.where(np.arange(4) < 2, readings.values, np.nan))


def test_gases_that_are_not_measured_widen_the_interval():
    readings, _ = flight("electrochemical", 0.5, 5)
    spec = sensor_preset("electrochemical")
    seen, unseen = estimate(readings, spec), estimate(without_nox(readings), spec)
    # 0.015 of 18 +- 7.5 ppb/ppm, and 0.16 of 2 +- 1.2 with +-0.032: gases.EXPECTED_PPB_PER_PPM.
    assert unseen.common_percent["no"] == pytest.approx(
        fsc_factor() * math.hypot(0.015 * 7.5, 0.0015 * 19.5), rel=0.01
    )
    assert unseen.common_percent["no2"] > seen.common_percent["no2"]
    assert unseen.low_percent < 0.5 < unseen.high_percent


def test_without_a_stated_response_nox_shows_only_how_much_of_it_there_is():
    # The response is 0 with a standard deviation of 0.02: readings of NO correct nothing, and what
    # they may have done is in proportion to them. 1.5 times the 20.7 ppb/ppm of this ship are more
    # than 18 +- 7.5, which are taken where NO is not measured, and a quarter of them is less.
    spec = sensor_preset("unspecified")
    readings, _ = flight("electrochemical", 0.5, 5)
    unseen = estimate(without_nox(readings), spec)
    assert unseen.common_percent["no"] == pytest.approx(
        fsc_factor() * 0.02 * math.hypot(18.0, 7.5), rel=0.01
    )
    for emitted in (1.5, 0.25):
        values = readings.values * np.array([1.0, 1.0, emitted, emitted])
        seen = estimate(Readings(readings.time, values), spec)
        assert seen.fsc_percent == pytest.approx(unseen.fsc_percent, rel=1e-3)
        # The gain, response and noise of the NO cell are not those that are assumed: 20 %.
        expected = fsc_factor() * 0.02 * 20.7 * emitted
        assert seen.common_percent["no"] == pytest.approx(expected, rel=0.2)
        assert (seen.total_percent > unseen.total_percent) == (emitted > 1.0)


@pytest.mark.parametrize("seed", [0, 7])
def test_a_response_that_is_not_given_is_not_taken_for_a_fast_one_where_so2_is_noisy(seed):
    # Noise of 25 ppb, as much as passes raise SO2; a t90 of 0 would smooth it most, and read a
    # quarter of the content.
    readings = read(
        plain_sniffer(so2_noise=25.0, co2_noise=1.0),
        crossings(0.25, duration=300.0, seed=seed),
        seed=seed,
    )
    readings.values[:, 2:] = np.nan
    spec = sensor_of({"channels": {"so2": {"cross": {}}, "co2": {}}}, "own")
    found = estimate(readings, spec)
    assert found.so2_t90_s > 8.0
    # The truth is 0.25 %; the stated uncertainty is a quarter of it.
    assert abs(found.fsc_percent - 0.25) < 2.0 * found.total_percent
    assert [verdict.verdict for verdict in found.verdicts] == ["above", "below"]


@pytest.mark.parametrize("co2_t90", [1.5, 4.5])
def test_a_response_that_is_found_is_as_uncertain_as_that_of_co2_makes_it(co2_t90):
    # Of CO2 3 s are stated, to 50 %. By noise alone t90 had 0.3 s and the delay 0.03 s, for errors
    # of 2 and 0.5 s.
    readings = read(
        plain_sniffer(20.0, co2_t90, so2_noise=1.0, co2_noise=0.5, rate_hz=5.0, delay_s=3.0),
        crossings(0.25, interval=30.0, width=2.0, meander=0.0),
    )
    stated = sensor_preset("unspecified")
    found = estimate(
        readings, stated.with_channel(replace(stated.known("so2"), cross={}, cross_sd={}))
    )
    assert abs(found.so2_t90_s - 20.0) < 2.0 * found.so2_t90_sd_s < 10.0
    assert abs(found.delay_s - 3.0) < 2.0 * found.delay_sd_s < 1.0


def test_noise_of_co2_does_not_raise_a_strong_so2_in_a_slow_cell():
    # Where passes are short for the cell, a longer t90 makes them lower nearly as less sulphur
    # does. Noise of CO2 in the columns of t90 and delay made these logs read 11 to 39 % too much.
    # They scatter by 3 %, so that the mean of six is within 4 % with a probability above 99.8 %.
    spec = sensor_preset("electrochemical")
    found = []
    for seed in range(6):
        air = crossings(2.7, duration=240.0, interval=12.0, width=1.2, peak=14.0, seed=seed)
        found.append(estimate(read(spec, air, seed=seed), spec).fsc_percent)
    assert np.mean(found) == pytest.approx(2.7, rel=0.04)
