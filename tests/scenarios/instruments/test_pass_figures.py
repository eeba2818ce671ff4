"""Figures of the passes of a flight: crossings of the plume's axis, and those of them that had
smoke in them.
"""

import math

import numpy as np
import pytest

from scenarios.instruments.sniffer import INSIDE, pass_figures

TIME = 0.05 + 0.1 * np.arange(600)

ACROSS = 50.0 * np.sin(2.0 * math.pi * (TIME - 2.5) / 20.0)
"""Across the axis and back, in 60 s six times: at 2.5, 12.5, 22.5, 32.5, 42.5 and 52.5 s."""

CENTRES = (2.5, 12.5, 22.5, 32.5, 42.5, 52.5)


def figures(peaks):
    """Return the figures of a flight whose passes have these peaks of concentration over that in
    the plume's centre.
    """
    fraction = sum(
        peak * np.exp(-0.5 * ((TIME - at) / 0.5) ** 2)
        for at, peak in zip(CENTRES, peaks, strict=True)
    )
    return pass_figures(ACROSS, np.full(len(TIME), 3.0), fraction, 100.0 * fraction, time_step=0.1)


def test_a_crossing_above_or_beside_the_smoke_is_no_pass_through_smoke():
    # Above 0.6 is a hit, above exp(-2) = 0.135 smoke, and 0.1 and 0 are none.
    found = figures([1.0, 0.7, 0.3, 0.14, 0.1, 0.0])
    assert found["plume_axis_crossings"] == 6
    assert found["smoke_passes"] == 4
    assert found["hit_rate"] == pytest.approx(2 / 6)


def test_a_flight_that_never_met_the_smoke_has_crossings_and_no_passes_through_smoke():
    found = figures([0.9 * INSIDE] * 6)
    assert (found["plume_axis_crossings"], found["smoke_passes"], found["seconds_in_plume_s"]) == (
        6,
        0,
        0.0,
    )
