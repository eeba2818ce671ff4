"""What a trim says of itself: how it ended, what is left, and which limits hold it; and trims of
aircraft with a rudder.
"""

import math

import pytest

from aircraft.dynamics.equilibrium import TrimOutcome
from aircraft.dynamics.trim import search_trim, trim
from aircraft.errors import TrimError
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.state import body_velocity, level
from common.physics.units import METRES_PER_FOOT, NEWTONS_PER_POUND

JET = {"airspeed": 80.0, "altitude": 1000.0}
CONDITIONS = {
    "level": {},
    "climbing": {"climb_angle": math.radians(3.0)},
    "descending": {"climb_angle": math.radians(-2.0)},
    "turning right": {"bank": math.radians(30.0)},
    "turning left": {"bank": math.radians(-30.0)},
    "climbing turn": {"bank": math.radians(20.0), "climb_angle": math.radians(2.0)},
}


@pytest.fixture(scope="module")
def jet():
    return Fdm(find_spec("T37"))


@pytest.fixture(scope="module")
def trims(jet):
    return {name: trim(jet, **JET, **condition) for name, condition in CONDITIONS.items()}


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_trim_that_converged_says_so_and_leaves_less_than_a_millionth_of_g_without_sideslip(
    trims, name
):
    found = trims[name]
    assert found.outcome is TrimOutcome.CONVERGED
    assert found.limits == ()
    assert len(found.residuals) == 6
    assert found.residual == max(abs(value) for value in found.residuals) < 1e-5
    assert found.beta == pytest.approx(
        0.0, abs=1e-6
    )  # what the rudder is for; solved for as the accelerations are


@pytest.mark.parametrize("name", CONDITIONS)
def test_jsbsims_own_forces_carry_the_weight_and_turn_the_aircraft(jet, trims, name):
    found = trims[name]
    with jet.frozen():
        jet.command(dict(found.inputs))
        jet.place(found.state())
        jet.settle()
        force = tuple(jet.read(f"forces/fb{axis}-total-lbs") * NEWTONS_PER_POUND for axis in "xyz")
        gravity = jet.read("accelerations/gravity-ft_sec2") * METRES_PER_FOOT
        weight = jet.read("inertia/weight-lbs") * NEWTONS_PER_POUND
    velocity = body_velocity(found.airspeed, found.alpha, found.beta)
    ahead, right, down = level(force, found.roll, found.pitch)
    v_ahead, v_right, v_down = level(velocity, found.roll, found.pitch)
    mass = weight / 9.80665
    # Newton: the vertical force carries what gravity pulls, and across the course it is m
    # V_horizontal omega. The earth turns (2 omega V = 0.012 m/s^2) and is round (V^2/R = 0.001
    # m/s^2), and gravity at the equator is 0.3 % less than the standard.
    assert -down == pytest.approx(mass * gravity, rel=6e-3)
    horizontal = math.hypot(v_ahead, v_right)
    across = (v_ahead * right - v_right * ahead) / horizontal
    assert across == pytest.approx(mass * horizontal * found.yaw_rate, abs=mass * 0.015)
    along = (v_ahead * ahead + v_right * right) / horizontal
    assert along == pytest.approx(0.0, abs=mass * 0.015)
    assert -v_down == pytest.approx(found.airspeed * math.sin(found.climb_angle), abs=1e-9)


def test_a_turn_goes_where_it_banks_and_at_the_rate_of_the_textbook(trims):
    for name in ("turning right", "turning left"):
        found = trims[name]
        # Without sideslip tan(bank) = V omega/g; angle of attack bends that by its square.
        expected = 9.79 * math.tan(found.roll) / found.airspeed
        assert found.yaw_rate == pytest.approx(expected, rel=0.02)


def test_a_climb_takes_more_thrust_and_a_descent_less(trims):
    throttles = [trims[name].inputs["throttle"] for name in ("descending", "level", "climbing")]
    assert throttles == sorted(throttles)


def test_sideslip_is_zero_only_where_a_rudder_makes_it_so(trims):
    # The X8 has none: the propeller's torque is balanced at half a milliradian, and turns slip.
    found = trim(Fdm(X8), airspeed=20.0, altitude=100.0, bank=math.radians(45.0))
    assert abs(found.beta) > 1e-3
    assert abs(trims["turning right"].beta) < 1e-6


# By hand: at 40 m/s drag is 14 N and full throttle gives nothing; a climb of 1 rad needs 28 N of
# thrust of 19.
@pytest.mark.parametrize("condition", [{"airspeed": 40.0}, {"airspeed": 20.0, "climb_angle": 1.0}])
def test_a_condition_that_takes_more_than_the_throttle_gives_says_so(x8_fdm, condition):
    found = search_trim(x8_fdm, altitude=100.0, **condition)
    assert found.outcome is TrimOutcome.LIMITED
    assert found.limits == ("throttle at its upper limit",)
    # The equilibrium that would be there lies past the limit.
    assert found.inputs["throttle"] > 1.0
    with pytest.raises(TrimError, match="throttle at its upper limit is not enough"):
        trim(x8_fdm, altitude=100.0, **condition)


# By hand: 5 m/s needs a lift coefficient of 2.9, an angle of attack of 0.7 rad; a dive of 0.5 rad
# needs 16 N of drag at 20 m/s, where there are 5 and what an idle propeller adds.
@pytest.mark.parametrize("condition", [{"airspeed": 5.0}, {"airspeed": 20.0, "climb_angle": -0.5}])
def test_a_condition_far_from_any_equilibrium_says_how_far_within_all_limits(x8_fdm, condition):
    found = search_trim(x8_fdm, altitude=100.0, **condition)
    assert found.outcome is not TrimOutcome.CONVERGED
    assert found.residual > 0.1
    assert all(i.lower <= found.inputs[i.name] <= i.upper for i in x8_fdm.spec.inputs)
    assert abs(found.alpha) <= 0.5
    with pytest.raises(TrimError, match=f"largest acceleration {found.residual:.2g}"):
        trim(x8_fdm, altitude=100.0, **condition)


def test_an_impossible_airspeed_of_a_jet_names_its_throttle(jet):
    # 240 m/s at 1000 m: a quarter more than the 425 mph (190 m/s) that a T-37 reaches.
    found = search_trim(jet, airspeed=240.0, altitude=1000.0)
    assert found.outcome is TrimOutcome.LIMITED
    assert found.limits == ("throttle at its upper limit",)


def test_a_trim_found_from_a_neighbour_is_the_one_found_from_nothing(jet, trims):
    nearby = trim(jet, airspeed=84.0, altitude=1000.0)
    found = trim(jet, **JET, start=nearby)
    assert found.alpha == pytest.approx(
        trims["level"].alpha, abs=1e-6
    )  # both solved to 1e-5 m/s^2 of 50 m/s^2 per rad
    assert found.inputs == pytest.approx(trims["level"].inputs, abs=1e-5)
