import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.stats import chi2

from gnc.estimation.vessel_filter import FilterParameters, VesselFilter, VesselReport

SIGMA, MEMORY = 0.02, 40.0
POSITION, VELOCITY = 5.0, 0.15
FIRST = VesselReport(0.0, 100.0, -40.0, 5.0, 2.0)


def make(**changes):
    sigmas = {
        "position_sigma": POSITION,
        "velocity_sigma": VELOCITY,
        "acceleration": SIGMA,
        "memory": MEMORY,
    }
    return VesselFilter(FilterParameters(**(sigmas | changes)))


def singer(time, *, sigma=SIGMA, memory=MEMORY):
    """Return transition and process noise of Singer's model by Van Loan's matrix exponential (IEEE
    Trans. AC 23:395, 1978).
    """
    a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / memory]])
    spectral = np.zeros((3, 3))
    spectral[2, 2] = 2.0 * sigma**2 / memory
    e = expm(np.block([[-a, spectral], [np.zeros((3, 3)), a.T]]) * time)
    transition = e[3:, 3:].T
    return transition, transition @ e[:3, 3:]


def packed(p):
    return p[0, 0], p[0, 1], p[0, 2], p[1, 1], p[1, 2], p[2, 2]


def matrix(c):
    return np.array([[c[0], c[1], c[2]], [c[1], c[3], c[4]], [c[2], c[4], c[5]]])


@pytest.mark.parametrize("time", [0.01, 0.19, 0.21, 0.5, 2.0, 12.0, 60.0, 400.0])
def test_its_process_noise_is_singers(time):
    # Below 0.2 s the leading terms alone are taken, true to 0.5 % by their comment; above, six
    # digits of the closed forms cancel at worst, of sixteen.
    tolerance = 5e-3 if time < 0.005 * MEMORY else 1e-3
    assert make()._noise(time) == pytest.approx(packed(singer(time)[1]), rel=tolerance)


@pytest.mark.parametrize("time", [0.5, 12.0, 60.0])
def test_it_extrapolates_an_acceleration_that_fades(time):
    moved = make()._predicted((3.0, 5.0, 0.1), time)
    # Rounding.
    assert moved == pytest.approx(singer(time)[0] @ [3.0, 5.0, 0.1], rel=1e-10)


def test_it_is_a_plain_matrix_kalman_filter():
    rng = np.random.default_rng(3)
    vessel = make()
    vessel.report(FIRST)
    states = np.array(
        [[FIRST.north, FIRST.velocity_north, 0.0], [FIRST.east, FIRST.velocity_east, 0.0]]
    ).T
    p = np.diag([POSITION**2, VELOCITY**2, SIGMA**2])
    h, r = np.eye(2, 3), np.diag([POSITION**2, VELOCITY**2])
    time = 0.0
    for gap in rng.uniform(2.0, 10.0, 40):
        time += gap
        report = VesselReport(time, *(rng.standard_normal(4) * 100.0))
        vessel.report(report)
        transition, noise = singer(gap)
        states, p = transition @ states, transition @ p @ transition.T + noise
        gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + r)
        measured = np.array(
            [[report.north, report.east], [report.velocity_north, report.velocity_east]]
        )
        states, p = states + gain @ (measured - h @ states), (np.eye(3) - gain @ h) @ p
        motion = vessel.at(time + 3.0)
        ahead, more = singer(3.0)
        expected = ahead @ states
        # Rounding of some hundred metres in 40 updates, and the closed forms of the noise as above.
        assert (motion.north, motion.velocity_north, motion.acceleration_north) == pytest.approx(
            expected[:, 0], rel=1e-6, abs=1e-6
        )
        assert (motion.east, motion.velocity_east, motion.acceleration_east) == pytest.approx(
            expected[:, 1], rel=1e-6, abs=1e-6
        )
        assert motion.sigma == pytest.approx(
            math.sqrt((ahead @ p @ ahead.T + more)[0, 0]), rel=1e-6
        )


def test_it_starts_from_the_first_report():
    vessel = make()
    assert vessel.time == -math.inf
    vessel.report(FIRST)
    motion = vessel.at(0.0)
    assert (motion.north, motion.east, motion.velocity_north, motion.velocity_east) == FIRST[1:]
    assert motion.sigma == POSITION
    # A straight line until something else is reported.
    assert (vessel.at(10.0).north, vessel.at(10.0).east) == pytest.approx((150.0, -20.0), abs=1e-12)


def test_a_report_that_is_older_than_the_newest_changes_nothing():
    vessel = make()
    vessel.report(FIRST)
    vessel.report(VesselReport(8.0, 140.0, -24.0, 5.0, 2.0))
    before = vessel.at(10.0)
    vessel.report(VesselReport(5.0, 1e4, 1e4, 50.0, 50.0))
    vessel.report(VesselReport(8.0, 1e4, 1e4, 50.0, 50.0))
    assert vessel.at(10.0) == before
    assert vessel.time == 8.0


def test_a_late_report_counts_for_when_it_was_true():
    # What matters is the time in the report, not when it is handed over: here after a look at a
    # later time.
    looked, silent = make(), make()
    for vessel in (looked, silent):
        vessel.report(FIRST)
    looked.at(9.0)
    late = VesselReport(7.0, 135.0, -26.0, 5.0, 2.0)
    looked.report(late)
    silent.report(late)
    assert looked.at(9.0) == silent.at(9.0)


def test_exact_reports_give_exact_states_and_find_the_acceleration():
    vessel = make(position_sigma=0.0, velocity_sigma=0.0)
    # 6 m/s, speeding up northward by 0.1 m/s^2, reported every half a second, as with exact
    # knowledge.
    for step in range(200):
        time = 0.5 * step
        vessel.report(VesselReport(time, 6.0 * time + 0.05 * time**2, 0.0, 6.0 + 0.1 * time, 0.0))
        motion = vessel.at(time)
        # Rounding of 1,100 m.
        assert motion.north == pytest.approx(6.0 * time + 0.05 * time**2, rel=0.0, abs=1e-9)
        assert motion.velocity_north == pytest.approx(6.0 + 0.1 * time, rel=0.0, abs=1e-9)
        assert motion.sigma == pytest.approx(0.0, abs=1e-6)
    # It reckons with accelerations that fade with 40 s, so it sees 0.1 within the half second's
    # share of that, 1.3 %.
    assert motion.acceleration_north == pytest.approx(0.1, rel=0.02)


def test_its_covariance_stays_positive_over_a_thousand_reports():
    vessel = make()
    for step in range(1000):
        vessel.report(VesselReport(2.0 * step, 10.0 * step, 0.0, 5.0, 0.0))
    assert np.linalg.eigvalsh(matrix(vessel._covariance))[0] > 0.0


def test_it_knows_how_wrong_it_is_about_the_manoeuvres_that_it_reckons_with():
    rng = np.random.default_rng(5)
    flights, gaps = 150, rng.uniform(2.0, 10.0, 15)
    models = [(transition, np.linalg.cholesky(noise)) for transition, noise in map(singer, gaps)]
    normalised = []
    for _ in range(flights):
        # Both axes: place and velocity, and an acceleration of the process's own deviation.
        truth = np.diag([100.0, 5.0, SIGMA]) @ rng.standard_normal((3, 2))
        vessel = make()
        time = 0.0

        def report(truth, time, vessel=vessel):
            noise = np.array([[POSITION], [VELOCITY]]) * rng.standard_normal((2, 2))
            place, velocity = truth[:2] + noise
            vessel.report(VesselReport(time, place[0], place[1], velocity[0], velocity[1]))

        report(truth, time)
        for gap, (transition, root) in zip(gaps, models, strict=True):
            time += gap
            truth = transition @ truth + root @ rng.standard_normal((3, 2))
            report(truth, time)
        error = np.array([vessel._north, vessel._east]).T - truth
        normalised.append(np.sum(error * np.linalg.solve(matrix(vessel._covariance), error)))
    # Six degrees of freedom a flight, independent flights; the limits hold for all but one set of
    # seeds in 500.
    low, high = chi2.ppf([0.001, 0.999], 6 * flights) / flights
    assert low < np.mean(normalised) < high
