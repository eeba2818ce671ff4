"""When and whether the trajectories of an ensemble settle."""

import math

import numpy as np
import pytest
from ensemble_cases import BAND, fly, history, oscillating, references, wandering
from gnc_cases import LOOK_AHEAD, SPEED

from extensions.convergence.ensemble import Outcome
from extensions.convergence.motion import Steering
from extensions.convergence.references import averaged_settling_time

pytestmark = pytest.mark.slow


def test_a_circle_that_spends_almost_all_of_omega_max_is_never_reached_under_cut_commands():
    # Where the proof ends: it takes phi's rate to be -h(phi), and here the command is cut for 0.9
    # of the time. With 0.499 of 0.503 rad/s spent on the circle, trajectories end on a cycle 115 to
    # 198 m from the reference, which this start lies on: the study's counter-examples, found at
    # random and flown for 90,000 s.
    start = ([[-37.757], [-160.629]], [-1.1095])
    refs = references(rate=[0.499])
    _, times, states, _, _ = history(
        Steering.CASCADE_CUT, refs, (-37.757, -160.629), -1.1095, time_max=360.0
    )
    distance = np.hypot(*states[:, :2].T)
    # A metre for the digits that the start is given with.
    assert distance.min() > 113.5
    assert distance.max() < 199.0
    # A cycle: as far out, and as close, late as early. A decay from 160 m at the averaged motion's
    # V/(2 delta) takes 10 s per 1/e.
    early, late = distance[times < 150.0], distance[times > 210.0]
    assert (late.min(), late.max()) == pytest.approx((early.min(), early.max()), abs=1.0)
    # The same start under the same law, uncut, and under the cut law with a tenth of omega_max
    # left.
    assert fly(Steering.CASCADE, refs, *start).outcome == (Outcome.CONVERGED,)
    assert fly(Steering.CASCADE_CUT, references(rate=[0.45]), *start).outcome == (
        Outcome.CONVERGED,
    )


@pytest.mark.parametrize("law", [Steering.LYAPUNOV, Steering.CASCADE])
def test_behind_a_straight_reference_the_error_along_the_track_stays(law):
    # Section IV.C needs omega_r other than zero: on a straight course phi_r = phi = 0 anywhere on
    # the reference's track.
    result, _, states, _, _ = history(law, references(), (800.0, 150.0), 0.0, time_max=5000.0)
    assert result.outcome == (Outcome.TIME_UP,)
    assert "raise time_max" in result.message[0]
    assert math.isnan(result.settling_time[0])
    along, across = states[-1][:2]
    # Across the track it does converge; along it, the vehicle loses what its way back to the track
    # is longer than straight: some metres of 800.
    assert abs(across) < 1e-2
    assert 780.0 < along < 850.0
    assert (
        averaged_settling_time(LOOK_AHEAD, SPEED, references(), [[800.0], [150.0]], BAND)
        == math.inf
    )


def test_the_averaged_settling_time_of_a_circle_is_its_closed_form():
    # dy/dt = -V y/(epsilon y + R), y = d^2, integrated:
    # [2 R ln(d_0/d_1) + epsilon (d_0^2 - d_1^2)]/V; 60 bisections, so rounding.
    expected = (2.0 * 60.0 * math.log(5000.0 / 5.0) + 0.005 * (5000.0**2 - 5.0**2)) / SPEED
    refs = references(course=[0.0, 1.0], rate=[0.3, -0.1])
    times = averaged_settling_time(LOOK_AHEAD, SPEED, refs, [[3000.0, 1.0], [4000.0, 2.0]], BAND)
    assert times == pytest.approx([expected, 0.0], rel=1e-12)


@pytest.mark.parametrize(
    "refs",
    [references(rate=[0.3]), oscillating(), wandering()],
    ids=["circle", "oscillation", "random"],
)
@pytest.mark.parametrize("law", [Steering.LYAPUNOV, Steering.CASCADE])
def test_trajectories_settle_when_the_averaged_motion_says(law, refs):
    result = fly(law, refs, [[1200.0], [900.0]], [1.0])
    predicted = averaged_settling_time(LOOK_AHEAD, SPEED, refs, [[1200.0], [900.0]], BAND)
    # In the study of 10,000 half of all flights settle within 5 % of it, and the oscillations'
    # extremes from 1.5 km within 30 %.
    assert result.outcome == (Outcome.CONVERGED,)
    assert result.settling_time == pytest.approx(predicted, rel=0.2)
