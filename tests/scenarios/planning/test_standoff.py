import numpy as np
import pytest

from gnc.errors import InfeasibleError
from scenarios.planning.missions import VesselCircle, vessel_circle
from scenarios.scenario.files import load_study

SPEED = 19.42


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.8])
def test_the_point_on_the_circle_moves_at_airspeed_through_the_air_and_returns_after_a_period(nu):
    circle = VesselCircle(nu=nu, speed=SPEED, radius=200.0)
    time = np.linspace(0.0, circle.period, 400)
    step = 1e-2
    (x0, y0), (x1, y1) = circle.offset(time), circle.offset(time + step)
    through_air = np.hypot((x1 - x0) / step + nu * SPEED, (y1 - y0) / step)
    # The table has 720 points: half a degree of a turn, over which the speed changes by nu times
    # that, at most 1 %.
    assert through_air == pytest.approx(np.full(400, SPEED), rel=0.012)
    # The trapezoidal rule over a whole turn is exact to rounding; the closed form is an elliptic
    # integral.
    assert np.hypot(*circle.offset(circle.period) - np.array(circle.offset(0.0))) == pytest.approx(
        0.0, abs=1e-3
    )


def test_a_circle_that_is_too_tight_is_refused_with_the_radius_that_is_not():
    scenario = load_study("arena", ["reference.standoff_radius_m=50"], refusing=False)
    # omega_max = g tan 45 deg/V = 0.505 rad/s; (1 + 0.5)^2 V/omega_max = 86.5 m.
    with pytest.raises(
        InfeasibleError,
        match=r"circle of 50 m .* widen it to 87 m \(reference\.standoff_radius_m\)",
    ):
        vessel_circle(scenario, 0.5, 60.0)
    # Nor is one recommended that lies within the keep-out area and its margin.
    with pytest.raises(InfeasibleError, match="widen it to 203 m"):
        vessel_circle(scenario, 0.5, 203.0)
    assert vessel_circle(load_study("arena"), 0.5, 203.0).radius == 203.0
