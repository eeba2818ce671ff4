"""The lag of a channel: closed forms of step, ramp and area, two poles, delay, and readings in
parts.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from crossings import BACKGROUND, crossings, read, sniffer_of

from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import lag, time_constants
from measurement.sniffer.sniffer import Sniffer
from measurement.sniffer.spec import sensor_preset

STEP = 0.25
TAU = 20.0 / math.log(10.0)


def response(channel, signal, *, step=STEP, rate_hz=4.0):
    """Return what a channel reads of a signal of its own gas."""
    air = np.tile(BACKGROUND, (len(signal), 1))
    air[:, GASES.index(channel.gas)] = signal
    return read(sniffer_of(channel, rate_hz=rate_hz), air, step=step).values[
        :, GASES.index(channel.gas)
    ]


def test_a_ramp_is_followed_exactly():
    # y = t - tau (1 - e^(-t/tau)): solution of tau y' + y = t.
    time = STEP * np.arange(400)
    read_off = response(Channel(gas="so2", t90_s=20.0, noise=0.0), 3.0 * time)
    np.testing.assert_allclose(
        read_off, 3.0 * (time - TAU * (1.0 - np.exp(-time / TAU))), rtol=1e-12, atol=1e-11
    )


def test_a_step_reaches_90_percent_after_t90():
    # A step within one sample period is a ramp of that length: the exact response is that of two
    # ramps.
    time = STEP * np.arange(400)
    ramp = np.clip(time / STEP, 0.0, 1.0)
    read_off = response(Channel(gas="so2", t90_s=20.0, noise=0.0), ramp)

    def ramped(t):
        return np.where(t > 0.0, t - TAU * (1.0 - np.exp(-np.maximum(t, 0.0) / TAU)), 0.0) / STEP

    np.testing.assert_allclose(read_off, ramped(time) - ramped(time - STEP), atol=1e-12)
    # Half a step after t90 counted from the ramp's middle; the ramp moves it by less than
    # (step/tau)^2/24 = 3e-5.
    middle = np.interp(20.0 + STEP / 2.0, time, read_off)
    assert middle == pytest.approx(0.9, abs=1e-4)


@pytest.mark.parametrize("second_pole", [0.0, 0.3, 0.95])
def test_the_area_of_a_pulse_is_kept(second_pole):
    # A lag has a gain of 1 at rest: the sum of its output is that of its input, once it has
    # forgotten.
    signal = np.zeros(4000)
    signal[40:60] = np.hanning(20)
    read_off = response(Channel(gas="so2", t90_s=20.0, second_pole=second_pole, noise=0.0), signal)
    assert read_off.sum() == pytest.approx(signal.sum(), rel=1e-10)


@pytest.mark.parametrize("second_pole", [0.1, 0.5, 0.9])
def test_two_poles_are_two_lags_in_a_row_and_keep_their_t90(second_pole):
    first, second = time_constants(20.0, second_pole)
    assert second == pytest.approx(second_pole * first, rel=1e-12)
    # Step response of two real poles at t90.
    reached = 1.0 - (first * math.exp(-20.0 / first) - second * math.exp(-20.0 / second)) / (
        first - second
    )
    assert reached == pytest.approx(0.9, abs=1e-9)
    # In a row at a step a hundred times finer, where the first lag's output is as good as straight
    # between samples.
    fine = 0.0025 * np.arange(40_001)
    signal = np.interp(fine, [0.0, 10.0, 20.0, 40.0], [0.0, 5.0, 1.0, 2.0])
    in_a_row = lag(lag(signal, 0.0025, first), 0.0025, second)
    coarse = response(
        Channel(gas="so2", t90_s=20.0, second_pole=second_pole, noise=0.0), signal[::100]
    )
    np.testing.assert_allclose(coarse, in_a_row[::100], atol=1e-6)


def test_a_delay_moves_the_response_also_by_parts_of_a_step():
    time = STEP * np.arange(400)
    signal = np.sin(0.2 * time)
    prompt = response(Channel(gas="so2", t90_s=5.0, noise=0.0), signal)
    whole = response(Channel(gas="so2", t90_s=5.0, delay_s=2.0 * STEP, noise=0.0), signal)
    np.testing.assert_allclose(whole[2:], prompt[:-2], atol=1e-13)
    # Between samples: the lag's own solution for an input that is a straight line there, here a
    # ramp.
    part = response(Channel(gas="so2", t90_s=20.0, delay_s=0.4 * STEP, noise=0.0), time)
    late = np.maximum(time - 0.4 * STEP, 0.0)
    np.testing.assert_allclose(part, late - TAU * (1.0 - np.exp(-late / TAU)), atol=1e-12)


@pytest.mark.parametrize(("rate_hz", "step"), [(1.0, 0.1), (3.0, 0.1), (5.0, 0.03), (0.7, 0.11)])
def test_readings_in_parts_are_those_in_one(rate_hz, step):
    spec = replace(sensor_preset("electrochemical"), rate_hz=rate_hz)
    air = crossings(0.1, duration=60.0, step=step)
    pressure = np.linspace(-1.0, 1.0, len(air))
    whole = Sniffer(spec, generator=np.random.default_rng(1), time_step=step).advance(air, pressure)
    parts = Sniffer(spec, generator=np.random.default_rng(1), time_step=step)
    cuts = np.random.default_rng(2)
    found, at = [], 0
    while at < len(air):
        length = int(cuts.integers(0, 25))
        found.append(parts.advance(air[at : at + length], pressure[at : at + length]))
        at += length
    assert np.array_equal(np.concatenate([part.values for part in found]), whole.values)
    assert np.array_equal(np.concatenate([part.time for part in found]), whole.time)
    np.testing.assert_allclose(whole.time, np.arange(len(whole)) / rate_hz, rtol=1e-15)
