"""Loop margins of the autopilot: requirements, and what a margin is."""

import math

import control
import numpy as np
import pytest

from innerloop.controller import COMMANDS, CONTROLS
from innerloop.margins import DELAY, SENSOR_BREAKS, closed_loop, frequency_response, loop_margins, open_loop

BREAKS = (*CONTROLS, *SENSOR_BREAKS)
AIRSPEEDS = range(5)
GAIN_DB, PHASE_DEG = 6.0, 45.0  # the customary requirement, as in MIL-F-9490D: 6 dB and 45 degrees


@pytest.fixture(scope="module")
def margins(x8_schedule):
    return {(i, m.loop): m for i in AIRSPEEDS for m in loop_margins(x8_schedule, i)}


def negative_feedback_poles(loop, gain=1.0):
    """Poles of a single loop closed with a gain, from its state equations: A - B K C/(1 + K D)."""
    a, b, c, d = loop.A, loop.B, loop.C, loop.D
    assert d.shape == (1, 1)
    return np.linalg.eigvals(a - gain / (1.0 + gain * float(d[0, 0])) * b @ c)


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", AIRSPEEDS)
def test_every_single_loop_has_six_decibels_and_forty_five_degrees(margins, index, loop):
    margin = margins[index, loop]
    assert margin.gain_db >= GAIN_DB
    assert margin.phase_deg >= PHASE_DEG


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", AIRSPEEDS)
def test_every_single_loop_has_them_also_for_gain_and_phase_at_once(margins, index, loop):
    margin = margins[index, loop]
    assert margin.disk_gain_db >= GAIN_DB
    assert margin.disk_phase_deg >= PHASE_DEG


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", AIRSPEEDS)
def test_a_disk_margin_promises_no_more_than_the_classical_ones(margins, index, loop):
    margin = margins[index, loop]
    # The disk lies inside both classical intervals. Tolerance: it is sought on a grid of frequencies, 2 % apart.
    assert margin.disk_gain_db <= margin.gain_db * 1.001
    assert margin.disk_phase_deg <= margin.phase_deg * 1.001


@pytest.mark.parametrize("index", AIRSPEEDS)
def test_all_controls_at_once_have_six_decibels_and_forty_five_degrees_too(margins, index):
    margin = margins[index, "all controls"]
    assert margin.disk_gain_db >= GAIN_DB
    assert margin.disk_phase_deg >= PHASE_DEG
    # Changing all at once is worse than changing one, and only the disk margin is defined for it.
    assert margin.disk_gain_db <= min(margins[index, name].disk_gain_db for name in CONTROLS) * 1.001
    assert math.isnan(margin.gain_db)


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", [0, 2, 4])
def test_closing_the_opened_loop_gives_the_closed_loop(x8_schedule, index, loop):
    expected = closed_loop(x8_schedule, index).poles()
    found = negative_feedback_poles(open_loop(x8_schedule, index, (loop,)))
    assert len(found) == len(expected)
    # Two state-space realisations of the same system: eigenvalues agree to rounding times their condition, 1e-6 of 280 rad/s.
    for pole in expected:
        assert np.abs(found - pole).min() < 1e-5 * (1.0 + abs(pole))
    for pole in found:
        assert np.abs(expected - pole).min() < 1e-5 * (1.0 + abs(pole))


@pytest.mark.parametrize("index", AIRSPEEDS)
def test_the_closed_loop_is_stable(x8_schedule, index):
    assert closed_loop(x8_schedule, index).poles().real.max() < -0.05


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", [0, 2, 4])
def test_the_loop_stays_stable_up_to_its_gain_margin_and_not_beyond(x8_schedule, margins, index, loop):
    opened, margin = open_loop(x8_schedule, index, (loop,)), margins[index, loop].gain_db

    def stable(decibels):
        return negative_feedback_poles(opened, 10.0 ** (decibels / 20.0)).real.max() < 0.0

    for share in (0.5, 0.9, 0.99):
        assert stable(share * margin)
        assert stable(-share * margin)
    # The margin is the nearer of up and down. One per cent of it is a tenth of a decibel or more, far above rounding.
    assert math.isinf(margin) or not (stable(1.01 * margin) and stable(-1.01 * margin))


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", [0, 2, 4])
def test_the_phase_margin_is_the_least_distance_from_minus_one_where_the_gain_is_one(x8_schedule, margins, index, loop):
    opened, margin = open_loop(x8_schedule, index, (loop,)), margins[index, loop]
    frequency = np.logspace(-2.5, 2.5, 20_000)
    response = frequency_response(opened, frequency)
    # At every gain crossover the response lies this far from -1 along the unit circle; the margin is the least of them.
    crossings = np.nonzero(np.diff(np.sign(np.abs(response) - 1.0)))[0]
    distances = [abs(math.degrees(math.remainder(float(np.angle(response[k])) - math.pi, 2.0 * math.pi))) for k in crossings]
    # 20,000 frequencies over five decades: 0.06 % a step, and phase moves by less than two radians an e-fold here.
    assert margin.phase_deg == pytest.approx(min(distances), abs=0.1)
    assert margin.crossover == pytest.approx(frequency[crossings[-1]], rel=2e-3)


@pytest.mark.parametrize("loop", BREAKS)
@pytest.mark.parametrize("index", [0, 2, 4])
def test_the_disk_margin_is_that_of_its_definition(x8_schedule, margins, index, loop):
    # Seiler, Packard, Gahinet, "An Introduction to Disk Margins", IEEE Control Systems 40 (2020): the symmetric margin is
    # alpha = 1/max|S - 1/2|, or 1/max|(S - T)/2|, with gains (2 + alpha)/(2 - alpha) and phases 2 atan(alpha/2).
    response = frequency_response(open_loop(x8_schedule, index, (loop,)), np.logspace(-2.0, 2.3, 4000))
    alpha = 1.0 / np.abs(0.5 * (1.0 - response) / (1.0 + response)).max()
    margin = margins[index, loop]
    # A finer grid of frequencies than the package's finds a peak higher by a fraction of a per cent.
    assert margin.disk_gain_db == pytest.approx(20.0 * math.log10((2.0 + alpha) / (2.0 - alpha)), rel=5e-3)
    assert margin.disk_phase_deg == pytest.approx(math.degrees(2.0 * math.atan(0.5 * alpha)), rel=5e-3)


def test_the_opened_loop_has_the_loops_computing_delay(x8_schedule):
    # One step of computing and half a step of hold at 120 Hz, 12.5 ms, as a second-order Pade approximation: gain 1, and a phase
    # that is off by less than 0.1 degrees at 20 rad/s, beyond every crossover.
    assert pytest.approx(0.0125, abs=1e-12) == DELAY
    loops = [open_loop(x8_schedule, 2, (name,)) for name in CONTROLS]
    for loop in loops:
        assert any(abs(p) > 100.0 for p in loop.poles())
    pade = control.tf(*control.pade(DELAY, 2))(20.0j)
    assert abs(pade) == pytest.approx(1.0, abs=1e-12)
    assert math.degrees(np.angle(pade)) == pytest.approx(-math.degrees(20.0 * DELAY), abs=0.1)


@pytest.mark.parametrize("index", AIRSPEEDS)
@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_commanded_is_reached_and_nothing_else_moves(x8_schedule, index, command):
    loop = closed_loop(x8_schedule, index)
    gains = np.real(control.ss(loop).dcgain())
    outputs = [loop.output_labels.index(name.removesuffix("_command")) for name in COMMANDS]
    # Integral action: exactly 1 on its own quantity and 0 on the others, but for the condition of the inverse.
    expected = [float(name == command) for name in COMMANDS]
    np.testing.assert_allclose(gains[outputs, COMMANDS.index(command)], expected, atol=1e-6)
