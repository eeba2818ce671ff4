"""The limit cycle of an aircraft whose servos have play."""

import math

import numpy as np
import pytest

from innerloop.flight.limit_cycle import limit_cycle

pytestmark = pytest.mark.slow

TIME = np.arange(14_400) / 120.0


def wave(amplitude, period=5.0):
    return amplitude * np.sin(math.tau * TIME / period)


def test_amplitudes_and_period_of_a_sustained_oscillation_are_measured():
    # A slow drift beside it is none of the oscillation.
    found = limit_cycle(100.0 + 0.005 * TIME + wave(0.3), 0.02 + wave(0.005))
    assert found.is_flown
    # The line through whole periods of a sine takes a little of it: at the ends of twelve periods
    # 8 % of the amplitude, by which eleven periods between crossings change by 0.3 % at most.
    assert found.period == pytest.approx(5.0, rel=5e-3)
    assert found.altitude == pytest.approx(0.3, rel=0.05)
    assert found.bank == pytest.approx(0.005, rel=0.05)


@pytest.mark.parametrize(
    "altitude",
    [
        wave(0.04),  # less than counts
        wave(3.0) * np.exp(-TIME / 40.0),  # decays: 0.47 of itself in 30 s
        1.0 - np.exp(-TIME / 60.0),  # creeps
    ],
)
def test_what_is_small_or_decays_is_no_limit_cycle(altitude):
    assert not limit_cycle(altitude, np.zeros_like(altitude)).is_flown


def test_a_cessna_with_play_in_its_servos_has_its_limit_cycle_in_the_record(designs):
    found = designs("c172x").record["limit_cycle"]
    assert found["is_flown"]
    # As flown for 240 s under the design at 100 m: 5.165 s, 0.306 m and 0.283 deg, from 60 s on to
    # four digits the same. At 60 m the gains are others by less than a per cent.
    assert found["period_s"] == pytest.approx(5.165, rel=0.03)
    assert found["altitude_m"] == pytest.approx(0.306, rel=0.05)
    assert math.degrees(found["bank_rad"]) == pytest.approx(0.283, rel=0.05)
