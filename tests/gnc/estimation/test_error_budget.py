"""The error budget's formulas against simulated processes, and how its terms combine."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from gnc.estimation.error_budget import (
    Bias,
    ErrorBudget,
    Growth,
    Process,
    TurnDeviation,
    WindErrorByGusts,
    deviations,
)
from gnc.estimation.navigation import WindFilter

GUSTS = Process(sigma=1.2, correlation_time=11.3, key="turbulence.level")
DT = 0.1


def simulated(process, count, steps, seed=20261128):
    """Return a process at steps of 0.1 s, shape (count, steps + 1), from its stationary state."""
    kept = math.exp(-DT / process.correlation_time)
    kicks = np.random.default_rng(seed).standard_normal((count, steps + 1))
    kicks[:, 1:] *= math.sqrt(1.0 - kept**2)
    return process.sigma * lfilter([1.0], [1.0, -kept], kicks, axis=1)


@pytest.mark.parametrize("time", [2.0, 10.0, 60.0])
def test_integrals_of_a_process_are_those_of_simulated_ones(time):
    steps = round(time / DT)
    values = simulated(GUSTS, 4000, steps)
    integral = DT * (values[:, 1:] + values[:, :-1]).sum(axis=1) / 2.0
    fading = np.exp(-DT * np.arange(steps + 1) / GUSTS.correlation_time)
    expected = values[:, 0] * DT * (fading[1:] + fading[:-1]).sum() / 2.0
    # 4,000 deviations are known to 1.1 %: three of that.
    assert integral.std() == pytest.approx(GUSTS.integral(time), rel=0.035)
    assert (integral - expected).std() == pytest.approx(GUSTS.integral_from_known(time), rel=0.035)
    assert (values[:, -1] - values[:, 0]).std() == pytest.approx(GUSTS.change(time), rel=0.035)


def filtered(values, every):
    """Return errors of the estimates that a wind's filter makes of gusts north, and its budget."""
    noise = 6.6 * GUSTS.sigma
    errors, predicted = [], WindErrorByGusts(GUSTS)
    filters = [
        WindFilter(airspeed_sigma=noise, course_sigma=noise / 20.0, drift=0.02) for _ in values
    ]
    for number in range(0, values.shape[1], every):
        before = filters[0].variance_north + 0.02**2 * DT * every
        for wind, gust in zip(filters, values[:, number], strict=True):
            wind.update(20.0, 0.0, 20.0 + gust, 0.0, DT * every)
        gain = 1.0 if number == 0 else 1.0 - filters[0].variance_north / before
        predicted.measure(gain, DT * every)
        errors.append(np.array([wind.north for wind in filters]))
    return errors, predicted


@pytest.mark.parametrize("steps", [0, 200, 1200])
def test_the_wind_error_by_gusts_is_that_of_the_filter_itself(steps):
    errors, predicted = filtered(simulated(GUSTS, 600, steps), every=5)
    # 600 deviations are known to 2.9 %: three of that.
    assert errors[-1].std() == pytest.approx(predicted.sigma, rel=0.09)


def test_dead_reckoning_errs_by_turbulence_as_the_budget_says():
    # A wind filter over 20 s, then dead reckoning by its estimate and what is left of the gust.
    values = simulated(GUSTS, 600, 200 + 300)
    errors, predicted = filtered(values[:, :201], every=5)
    wind, after = errors[-1], values[:, 200:]
    fading = np.exp(-DT * np.arange(after.shape[1]) / GUSTS.correlation_time)
    taken = wind[:, None] + fading * (after[:, :1] - wind[:, None])
    off = DT * (after - taken)[:, :-1].sum(axis=1)
    budget = ErrorBudget(turbulence=GUSTS, drift=Growth(rate=1.0))
    assert off.std() == pytest.approx(budget.drift_sigma(30.0, predicted.sigma), rel=0.09)


def test_k_is_exceeded_as_often_as_stated():
    process, hours = Process(sigma=1.0, correlation_time=10.0), 100.0
    steps = round(hours * 36_000.0)
    north = simulated(process, 1, steps, seed=1)[0]
    east = simulated(process, 1, steps, seed=2)[0]
    rate = 2.0
    beyond = np.hypot(north, east) > deviations(rate, correlation_times=[10.0])
    begins = DT * np.flatnonzero(beyond[1:] & ~beyond[:-1])
    # What begins within a correlation time is one event.
    events = 1 + np.count_nonzero(np.diff(begins) > 10.0)
    # The rate is an upper bound, and some 150 events are counted.
    assert 0.4 * rate < events / hours < rate


DRIFT = Growth(rate=1.0)
TURNING = TurnDeviation(interval=1.0, sigmas=(0.0, 1.0, 2.0))


def settled_wind():
    """Return the error of a wind that has been measured for 5 min."""
    wind = WindErrorByGusts(GUSTS)
    for number in range(600):
        wind.measure(max(0.002, 1.0 / (number + 1)), 0.5)
    return wind


def test_a_loss_of_satellites_costs_nothing_where_it_is_not_declared():
    steady = ErrorBudget(turbulence=GUSTS, turning=TURNING).displacement(wind=settled_wind())
    losing = ErrorBudget(turbulence=GUSTS, turning=TURNING, drift=DRIFT)
    assert steady.after(6.0) < losing.displacement(wind=settled_wind()).after(6.0)
    # What was allowed for before the loss is enough after it.
    for age in (0.1, 1.0, 5.0):
        after = losing.displacement(lost=age, wind=settled_wind()).after(6.0 - age)
        assert after <= losing.displacement(wind=settled_wind()).after(6.0)


def test_what_is_known_anew_counts_from_then_on():
    wind, losing = settled_wind(), ErrorBudget(turbulence=GUSTS, turning=TURNING, drift=DRIFT)
    displacement = losing.displacement(wind=wind)
    displacement.after(6.0)
    displacement.renew(20.0, wind)
    # Dead reckoning for 26 s in all.
    sigma = math.hypot(TURNING.at(6.0), losing.drift_sigma(26.0, wind.sigma))
    assert displacement.after(6.0) == pytest.approx(losing.k * sigma, rel=1e-12)


def test_a_wind_that_is_known_exactly_moves_a_turn_by_what_its_filter_takes_in_of_the_gusts():
    wind = WindErrorByGusts(GUSTS)
    wind.gain = 0.02
    # By at most g t/2 times the integral of the gusts.
    found = ErrorBudget(turbulence=GUSTS).turn_sigma(10.0, wind)
    assert found == pytest.approx(0.5 * 0.02 * 10.0 * GUSTS.integral(10.0), rel=1e-9)


@pytest.mark.parametrize("lost", [0.0, 20.0])
def test_displacement_grows_with_time(lost):
    budget = ErrorBudget(turbulence=GUSTS, turning=TURNING, drift=DRIFT)
    displacement = budget.displacement(lost=lost, wind=settled_wind())
    found = [displacement.after(time) for time in np.arange(0.0, 60.0, 0.5)]
    assert np.all(np.diff(found) >= 0.0)


def test_velocities_that_last_add_up():
    sizes = {"own_velocity": 0.5, "gusts": 4.0, "wind_change": 0.25}
    budget = ErrorBudget(drift=DRIFT, **{name: Bias(size=size) for name, size in sizes.items()})
    assert budget.velocity(0.0) == 4.75
    assert budget.velocity(0.0, lost=1.0) == 5.75


def test_the_parts_of_a_turn_name_what_takes_the_room():
    budget = ErrorBudget(
        own_velocity=Bias(size=0.5, key="following.speed_error_mps"),
        response=Bias(size=3.0, key="following.turn_deviation_m"),
        turbulence=GUSTS,
        turning=TURNING,
    )
    parts = budget.parts(6.0)
    assert parts["own velocity"] == (3.0, "following.speed_error_mps")
    assert parts["response of turns"].distance == 3.0
    # The deviation of the turn goes on as between its last times: 2 m after 2 s, 6 m after 6 s.
    assert parts["turbulence"].distance == pytest.approx(6.0 * budget.k)
    assert max(parts, key=lambda name: parts[name].distance) == "turbulence"
