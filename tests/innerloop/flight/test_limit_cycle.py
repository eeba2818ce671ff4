"""The limit cycle of an aircraft whose servos have play."""

import math

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.model import has_play
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.limit_cycle import limit_cycle, measure_limit_cycle
from innerloop.jsbsim.system import write_root

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


def test_an_aircraft_with_twice_the_play_in_its_servos_oscillates_twice_as_far_as_often(
    x8_schedule, tmp_path
):
    found = []
    for play in (0.0, 0.04, 0.08):
        root = write_root(x8_schedule, tmp_path / f"{play}")
        file = root / "aircraft" / "x8" / "x8.xml"
        model = file.read_text(encoding="utf-8")
        if play:
            model = model.replace("</lag>", f"</lag><hysteresis_width>{play}</hysteresis_width>")
        file.write_text(model, encoding="utf-8")
        assert has_play(root) == (play > 0.0)
        aircraft = AutopilotedAircraft(X8, root)
        found.append(measure_limit_cycle(aircraft, x8_schedule.level(x8_schedule.middle)))
    none, one, two = found
    assert not none.is_flown
    # All but the play is linear near level flight, so that amplitudes go with it and the period
    # stays (Gelb and Vander Velde). Measured 2.52 s, and 0.12 m with the smaller one.
    assert one.is_flown
    assert two.altitude == pytest.approx(2.0 * one.altitude, rel=0.02)
    assert two.bank == pytest.approx(2.0 * one.bank, rel=0.02)
    assert two.period == pytest.approx(one.period, rel=0.01)
