"""Equilibria against Newton's and Euler's equations: the X8's published, the T-37's of JSBSim."""

import math

import numpy as np
import pytest
import x8_published as x8

from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftError
from aircraft.state import body_velocity
from aircraft.trim import TrimOutcome, search_trim, trim

CONDITIONS = {
    "slow": {"airspeed": 14.0, "altitude": 100.0},
    "middle": {"airspeed": 20.0, "altitude": 100.0},
    "fast": {"airspeed": 26.0, "altitude": 100.0},
    "high": {"airspeed": 20.0, "altitude": 1500.0},
    "climbing": {"airspeed": 20.0, "altitude": 100.0, "climb_angle": 0.1},
    "descending": {"airspeed": 20.0, "altitude": 100.0, "climb_angle": -0.1},
    "turning right": {"airspeed": 20.0, "altitude": 100.0, "bank": math.radians(45.0)},
    "turning left": {"airspeed": 17.0, "altitude": 100.0, "bank": math.radians(-35.0)},
    "climbing turn": {"airspeed": 20.0, "altitude": 100.0, "bank": 0.5, "climb_angle": 0.1},
}


@pytest.fixture(scope="module")
def trims():
    fdm = Fdm(X8)
    return {name: trim(fdm, **condition) for name, condition in CONDITIONS.items()}


def state_of(found):
    driven = [
        found.driven[name] for name in ("elevator_position", "aileron_position", "propeller_speed")
    ]
    body = [
        found.airspeed,
        found.alpha,
        found.beta,
        *found.rates_body,
        found.roll,
        found.pitch,
        found.altitude,
    ]
    return np.array([*body, *driven])


def test_the_published_equations_are_in_balance_at_every_trim(trims):
    for found in trims.values():
        # The solver converges quadratically and stops far below its limit; one part in a million of
        # g would move the aircraft 1 mm in its first 15 s.
        assert found.residual < 1e-5
        rates = dict(
            zip(x8.RATES, x8.state_rates(state_of(found), found.inputs["throttle"]), strict=True)
        )
        unit = (
            x8.standard_density(found.altitude)
            * (found.driven["propeller_speed"] / (2.0 * math.pi)) ** 2
        )
        # Thrust may be off by what linear interpolation in a table with steps of 0.05 is (see
        # test_x8_propulsion), 6.8e-5 in C_T.
        thrust_error = 6.8e-5 * unit * x8.PROPELLER_DIAMETER**4 / x8.MASS
        # The earth turns and is round: 2 omega V = 3e-3 m/s^2 where motion is not north, V^2/R =
        # 6e-5 m/s^2.
        coriolis = 2.0 * 7.292e-5 * found.airspeed
        assert rates["airspeed"] == pytest.approx(0.0, abs=thrust_error + coriolis)
        assert rates["alpha"] == pytest.approx(0.0, abs=coriolis / found.airspeed)
        assert rates["beta"] == pytest.approx(0.0, abs=coriolis / found.airspeed)
        # rad/s^2, where one thousandth of an aileron's full deflection gives 0.07 and of the
        # elevator's 0.06. What is left is density (1e-5) of moments that balance, and the earth's
        # rate times rates.
        assert (rates["p"], rates["q"], rates["r"]) == pytest.approx((0.0, 0.0, 0.0), abs=3e-4)
        # Definitions of a steady turn: exact but for rounding.
        assert (rates["roll"], rates["pitch"]) == pytest.approx((0.0, 0.0), abs=1e-12)
        assert rates["climb_rate"] == pytest.approx(
            found.airspeed * math.sin(found.climb_angle), abs=1e-9
        )
        assert rates["heading_rate"] == pytest.approx(found.yaw_rate, abs=coriolis / found.airspeed)
        velocity = np.array(body_velocity(found.airspeed, found.alpha, found.beta))
        north, east, _ = x8.body_from_ned(found.roll, found.pitch).T @ velocity
        assert found.course_offset() == pytest.approx(math.atan2(east, north), abs=1e-12)


def test_an_equilibrium_beyond_a_limit_does_not_count_and_names_it(x8_fdm):
    # The equations balance, with twice the throttle that there is.
    found = search_trim(x8_fdm, airspeed=60.0, altitude=100.0)
    assert found.residual < 1e-5
    assert found.outcome is TrimOutcome.LIMITED
    assert found.limits == ("throttle at its upper limit",)


@pytest.mark.parametrize("airspeed", [-3.0, 0.0, math.nan, math.inf])
def test_an_impossible_airspeed_is_refused_in_one_line_that_names_it(x8_fdm, airspeed):
    words = f"'x8': airspeed is {airspeed:g} m/s; it must lie between 0 and inf m/s"
    with pytest.raises(AircraftError, match=words) as caught:
        trim(x8_fdm, airspeed=airspeed, altitude=100.0)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "condition", [{"bank": math.radians(85.0)}, {"airspeed": -1.0}, {"altitude": math.nan}]
)
def test_a_refused_trim_leaves_an_aircraft_that_can_be_trimmed_and_flown(x8_fdm, trims, condition):
    with pytest.raises(AircraftError):
        trim(x8_fdm, **{"airspeed": 20.0, "altitude": 100.0, **condition})
    found = trim(x8_fdm, airspeed=20.0, altitude=100.0)
    assert found.alpha == pytest.approx(trims["middle"].alpha, abs=1e-8)  # the solver's own spread
    x8_fdm.place(found.state())
    x8_fdm.step(12)
    assert x8_fdm.read("position/lat-geod-rad") > 1e-7  # it moves on north: 2 m are 3e-7 rad


JET_CONDITIONS = [
    {},
    {"climb_angle": math.radians(3.0)},
    {"climb_angle": math.radians(-2.0)},
    {"bank": math.radians(30.0)},
    {"bank": math.radians(-30.0)},
    {"bank": math.radians(20.0), "climb_angle": math.radians(2.0)},
]


def test_a_trim_that_converged_leaves_less_than_a_millionth_of_g_and_no_sideslip():
    jet = Fdm(find_spec("T37"))
    for condition in JET_CONDITIONS:
        found = trim(jet, airspeed=80.0, altitude=1000.0, **condition)
        assert found.outcome is TrimOutcome.CONVERGED
        assert found.limits == ()
        assert len(found.residuals) == 6
        assert found.residual == max(abs(value) for value in found.residuals) < 1e-5
        # What the rudder is for; it is solved for as the accelerations are.
        assert found.beta == pytest.approx(0.0, abs=1e-6)
