"""Verdicts with their guard bands and words, quality classes, the estimate over time."""

import math

import numpy as np
import pytest
from crossings import changed, crossings, flight, plain_sniffer, read
from scipy.stats import norm, truncnorm

from measurement.estimate.estimator import estimate, over_time, time_to_verdict
from measurement.estimate.quality import quality_class
from measurement.estimate.verdict import (
    decide,
    interval,
    judged,
    needed,
    next_step,
    probability_above,
    verdict_words,
)
from measurement.rules import RULES
from measurement.sniffer.sniffer import Readings

pytestmark = pytest.mark.slow


def test_a_verdict_is_that_of_a_guard_band():
    # JCGM 106: a guard band of 1.645 standard uncertainties for a probability of 95 %.
    for limit, away, verdict in (
        (0.1, 1.65, "above"),
        (0.1, 1.64, "open"),
        (0.5, -1.65, "below"),
        (0.5, -1.64, "open"),
    ):
        assert judged(limit, limit + away * 0.02, 0.02, admitted=True).verdict == verdict
    assert judged(0.1, 0.4, 0.02, admitted=False).verdict == "open"
    assert judged(0.1, math.nan, math.nan, admitted=True).verdict == "open"


def test_a_probability_knows_that_no_fuel_has_less_than_nothing():
    # Far from 0 it is the normal distribution's; near 0 what lies below 0 is not counted.
    assert probability_above(0.5, 0.5, 0.02) == pytest.approx(0.5, abs=1e-9)
    whole, cut = norm.sf(0.1, 0.0, 0.05), probability_above(0.1, 0.0, 0.05)
    assert cut == pytest.approx(2.0 * whole, rel=1e-9)
    # A reading far below 0 is no proof of a clean fuel.
    assert judged(0.1, -0.5, 0.3, admitted=True).verdict == "open"
    assert judged(0.1, -0.5, 0.3, admitted=True).probability_above > 0.3
    # The knowledge that no fuel has less than 0 lifts the probability, and "above" asks for the
    # guard band alone: the normal distribution's 0.9370 at 1.53, over its 0.9484 at 1.63.
    verdict = judged(0.01, 0.163, 0.1, admitted=True)
    assert (verdict.verdict, verdict.probability_above > 0.95) == ("open", True)
    assert verdict_words("open", 0.01, verdict.probability_above).endswith(": 98.8 %")
    assert needed(verdict.probability_above) == "the result is within the guard band"


@pytest.mark.parametrize("fsc", [-3.0, 0.0, 1.0, 1.7, 4.0])
def test_interval_and_probability_are_those_of_one_sampled_distribution(fsc):
    # Contents that are not negative, of a reading with a standard uncertainty of 1: sampled by the
    # inverse of a normal distribution cut at 0, scipy's. 400,000 samples know a share of 5 % to
    # 0.034 %; four times that.
    content = truncnorm.rvs(
        -fsc, np.inf, loc=fsc, size=400_000, random_state=np.random.default_rng(1)
    )
    low, high = interval(fsc, 1.0)
    assert np.mean((content >= low) & (content <= high)) == pytest.approx(0.95, abs=0.0014)
    for limit in (0.2, 1.0, high):
        assert probability_above(limit, fsc, 1.0) == pytest.approx(
            np.mean(content > limit), abs=0.004
        )
    # No other interval that holds 95 % is shorter: those that begin at each of the samples' lowest
    # 5 %.
    ordered = np.sort(content)
    held = round(0.95 * len(ordered))
    assert high - low == pytest.approx(float(np.min(ordered[held:] - ordered[:-held])), rel=0.01)


def test_where_an_interval_begins_at_0_a_limit_outside_of_it_is_what_a_fuel_below_it_is_called_by():
    for fsc in (-0.3, -0.02, 0.0, 0.03, 0.045):
        low, high = interval(fsc, 0.03)
        assert low == 0.0
        assert probability_above(high, fsc, 0.03) == pytest.approx(0.05, abs=1e-9)
        assert judged(1.001 * high, fsc, 0.03, admitted=True).verdict == "below"
        assert judged(0.999 * high, fsc, 0.03, admitted=True).verdict == "open"


def test_an_interval_is_not_empty_and_not_negative():
    # Five standard uncertainties from 0 it is that of the normal distribution, 1.960 to either
    # side.
    assert interval(0.1, 0.02) == pytest.approx((0.0608, 0.1392), abs=1e-4)
    # Ten below 0 an exponential distribution of mean 0.02/10 is left, above 3.0 times which are 5
    # %; a second term takes 4 % of it.
    assert interval(-0.2, 0.02) == pytest.approx((0.0, 0.0059), abs=1e-4)
    assert interval(-20.0, 0.02)[1] == pytest.approx(-math.log(0.05) * 0.02 / 1000.0, rel=1e-3)
    assert interval(0.1, 0.0) == (0.1, 0.1)
    assert all(math.isnan(end) for end in interval(math.nan, math.nan))


@pytest.mark.parametrize("deviation", [0.005, 0.05, 0.3])
def test_a_verdict_states_where_it_begins_and_how_often_it_is_wrong_at_the_limit(deviation):
    verdict = judged(0.1, 0.1, deviation, admitted=True)
    # The ends are those at which the verdict changes, and not a thousandth nearer.
    step = 1e-3 * deviation
    above, below = verdict.above_from_percent, verdict.below_to_percent
    for end, side, outwards in ((above, "above", step), (below, "below", -step)):
        assert judged(0.1, end + outwards, deviation, admitted=True).verdict == side
        assert judged(0.1, end - outwards, deviation, admitted=True).verdict == "open"
    # Rates of 100,000 readings of a fuel at the limit: 5 % are known to 0.07 %; three times that.
    found = 0.1 + deviation * np.random.default_rng(3).standard_normal(100_000)
    assert np.mean(found > above) == pytest.approx(verdict.false_alarm, abs=0.0021)
    assert np.mean(found < below) == pytest.approx(verdict.miss, abs=0.0021)
    assert verdict.false_alarm == pytest.approx(0.05, abs=1e-9)
    assert verdict.miss <= 0.05 + 1e-9


@pytest.mark.parametrize("deviation", [1e-320, 1e-12, 1e-3, 99.0, 101.0, 1e9, 1e300, math.inf])
def test_guard_bands_of_any_uncertainty_are_those_of_the_probability(deviation):
    verdict = judged(0.1, 0.1, deviation, admitted=True)
    assert verdict.verdict == "open"
    if 1e-12 < deviation < 1e9:
        below = verdict.below_to_percent
        # The closed form from 100 % on leaves out parts of a thousandth.
        assert probability_above(0.1, below, deviation) == pytest.approx(0.05, rel=1e-3)


# Rules


@pytest.mark.parametrize("name", RULES)
def test_the_rates_of_a_rule_are_those_of_repeated_readings(name):
    rule, deviation = RULES[name], 0.03
    generator = np.random.default_rng(4)
    rates = []
    for content in (rule.limit_percent, 2.0 * rule.limit_percent):
        found = content + deviation * generator.standard_normal(4000)
        decisions = [decide(rule, float(fsc), deviation, admitted=True) for fsc in found]
        rates.append(np.mean([decision.suspect for decision in decisions]))
    # Shares of 4000 are known to 0.8 %; three times that.
    assert rates[0] == pytest.approx(decisions[0].false_alarm, abs=0.024)
    assert 1.0 - rates[1] == pytest.approx(decisions[0].miss, abs=0.024)
    assert decisions[0].missed_percent == 2.0 * rule.limit_percent
    # A rule without a threshold has the guard band of 5 %.
    if rule.suspect_percent is None:
        assert decisions[0].false_alarm == pytest.approx(0.05)
    # A record without a verdict has no decision.
    assert decide(rule, 0.4, 0.02, admitted=False).suspect is None
    nothing = decide(rule, math.nan, math.nan, admitted=True)
    assert nothing.suspect is None
    assert math.isnan(nothing.false_alarm)


# Quality


GOOD = {
    "problems": (),
    "snr": 50.0,
    "passes": 10,
    "fsc": 0.1,
    "deviation": 0.015,
    "agreement": 0.5,
    "limit": 0.1,
    "responses_stated": True,
}


@pytest.mark.parametrize(
    ("change", "quality", "reason"),
    [
        ({}, "A", ""),
        ({"snr": 12.0}, "B", "CO2 signal to noise is 12.0; class A needs 20"),
        ({"deviation": 0.03}, "B", "standard uncertainty is 0.030 %; class A needs 0.020 %"),
        ({"deviation": 0.0203}, "B", "standard uncertainty is 0.0203 %; class A needs 0.0200 %"),
        ({"deviation": 0.03, "responses_stated": False}, "B", "NO and NO2 is not stated (cross)"),
        (
            {"deviation": 36.0},
            "C",
            "the standard uncertainty is 36 %, and no fuel has above 5 %: SO2 does not follow CO2",
        ),
        (
            {"fsc": 250.0, "deviation": 0.02},
            "C",
            "the result is 250.0 %, and no fuel has above 5 %: check the units of SO2",
        ),
        ({"passes": 2}, "B", "2 passes through the plume; class A needs 3"),
        ({"agreement": 1e-4}, "B", "passes differ more than their noise explains"),
        ({"problems": ("SO2 is saturated",)}, "C", "SO2 is saturated"),
        ({"fsc": -0.2}, "C", "negative by more than 3 standard uncertainties"),
        ({"fsc": math.nan, "deviation": math.nan}, "C", "the CO2 excess is not above its noise"),
    ],
)
def test_quality_is_stated_with_its_reason(change, quality, reason):
    found, reasons = quality_class(**{**GOOD, **change})
    assert found == quality
    assert reason in " ".join(reasons)
    assert bool(reasons) == (quality != "A")


def test_an_open_verdict_says_which_part_of_the_uncertainty_to_lower():
    known = {"passes": 9, "undecided": True, "errors": {"NO2": 0.02, "carbon": 0.01}}
    assert "measure more passes" in next_step("B", noise=0.03, **known)
    assert "as by a calibration: NO2." in next_step("B", noise=0.01, **known)
    assert next_step("B", noise=0.01, **{**known, "undecided": False}) == ""
    assert "measure again in the plume" in next_step("C", noise=math.nan, **{**known, "passes": 0})


# Records


def test_an_estimate_is_given_over_time():
    readings, spec = flight("electrochemical", 0.3, 2, duration=120.0)
    table = over_time(readings, spec, elapsed_s=(5.0, 30.0, 60.0, 120.0, 600.0))
    assert table["elapsed_s"].tolist() == [5.0, 30.0, 60.0, 120.0]
    assert math.isnan(table["fsc_percent"][0])
    assert (table["quality"][0], table["verdict_0.1"][0]) == ("C", "open")
    whole = estimate(readings, spec)
    assert table["fsc_percent"].iloc[-1] == whole.fsc_percent
    assert table["passes"].iloc[-1] == whole.figures.passes
    assert table["noise_percent"].iloc[-1] < table["noise_percent"].iloc[2]
    assert time_to_verdict(table, 0.1) in (30.0, 60.0, 120.0)
    # The verdict of the last row has to have stood since.
    table["verdict_0.1"] = ["above", "open", "above", "above"]
    assert time_to_verdict(table, 0.1) == 60.0
    table["verdict_0.1"] = ["above", "above", "above", "open"]
    assert math.isnan(time_to_verdict(table, 0.1))
    refused = estimate(readings, spec, problems=("a leak",))
    assert (refused.quality, refused.quality_reasons) == ("C", ("a leak",))
    assert {verdict.verdict for verdict in refused.verdicts} == {"open"}


def test_passes_and_doses_are_counted():
    spec = plain_sniffer(so2_noise=2.5, co2_noise=1.0)
    figures = estimate(read(spec, crossings(0.25, meander=0.0)), spec).figures
    # Passes from 12 s on every 9.5 s, to 145 s; a pass of 200 ppm and 0.6 s has a dose of 200 x 0.6
    # x sqrt(2 pi) = 301 ppm s, of which a background that is never clean takes some.
    assert figures.passes == 15
    assert figures.interval_s == pytest.approx(9.5, abs=0.1)
    assert figures.dose_ppm_s == pytest.approx(301.0, rel=0.1)
    assert 15 * 3.0 < figures.seconds_in_plume < 15 * 8.0


def test_gaps_of_any_length_and_uneven_times_do_not_bias_the_result():
    spec = plain_sniffer(rate_hz=10.0)
    readings = read(spec, crossings(0.25))
    rows = np.ones(len(readings), dtype=bool)
    rows[700:850] = rows[1001:1003] = False
    found = estimate(Readings(readings.time[rows], readings.values[rows]), spec)
    # What the cell remembers of passes in the gap decays as the background's transient does.
    assert found.fsc_percent == pytest.approx(0.25, rel=0.01)
    late = readings.time + 0.02 * np.sin(np.arange(len(readings)))
    columns = [np.interp(late, readings.time, column) for column in readings.values.T]
    uneven = estimate(Readings(late, np.stack(columns, axis=1)), spec)
    assert uneven.fsc_percent == pytest.approx(0.25, rel=0.005)


def test_a_long_record_may_drift():
    spec = plain_sniffer(rate_hz=1.0, so2_noise=1.0, co2_noise=0.5)
    readings = read(spec, crossings(0.25, duration=900.0))
    drift = 20.0 * np.sin(readings.time / 300.0)
    values = readings.values + drift[:, np.newaxis] * np.array([1.0, 0.5, 0.0, 0.0])
    found = estimate(Readings(readings.time, values), spec)
    assert found.fsc_percent == pytest.approx(0.25, rel=0.05)


def test_an_instrument_that_is_not_the_one_stated_is_noticed():
    readings, spec = flight("electrochemical", 2.7, 1)
    assert estimate(readings, spec).quality != "C"
    mistaken = estimate(readings, changed(spec, "so2", t90_s=0.5))
    assert mistaken.quality == "C"
    reason = "more than the stated uncertainty of the instrument explains"
    assert reason in mistaken.quality_reasons[-1]
