"""What the design asks for: by hand for a simple aircraft, and without a length or a time of its
own.
"""

import math
from dataclasses import astuple, fields, replace

import numpy as np
import pytest

from aircraft.linearise import LinearModel
from common.physics.units import STANDARD_GRAVITY
from innerloop.synthesis import weights
from innerloop.synthesis.schedule import LEVEL_GAINS
from innerloop.synthesis.servo_lqr import design_gains
from innerloop.synthesis.weights import (
    LoopBandwidths,
    control_weights,
    design_weights,
    reachable_bandwidths,
)

STATES = [
    "airspeed",
    "alpha",
    "beta",
    "p",
    "q",
    "r",
    "roll",
    "pitch",
    "altitude",
    "elevator_effect",
    "throttle_effect",
]
INPUTS = ["elevator", "aileron", "throttle", "rudder"]
LAG, ENGINE_LAG = 0.04, 0.5  # s, of elevator and engine; aileron and rudder have none
DELAY = 0.0125  # s, of the autopilot's steps


def simple(
    aileron=30.0, roll_damping=-4.0, elevator=-20.0, z_alpha=-3.0, rudder=5.0, yaw_stiffness=8.0
):
    """An aircraft with one number for each thing that the bandwidths depend on [1/s, 1/s^2]."""
    a, b = np.zeros((11, 11)), np.zeros((11, 4))
    entries = {
        ("alpha", "alpha"): z_alpha,
        ("p", "p"): roll_damping,
        ("q", "q"): -5.0,
        ("r", "r"): -1.5,
        ("r", "beta"): yaw_stiffness,
        ("q", "elevator_effect"): elevator,
        ("airspeed", "throttle_effect"): 6.0,
        ("elevator_effect", "elevator_effect"): -1.0 / LAG,
        ("throttle_effect", "throttle_effect"): -1.0 / ENGINE_LAG,
    }
    for (row, column), value in entries.items():
        a[STATES.index(row), STATES.index(column)] = value
    forcing = {
        ("p", "aileron"): aileron,
        ("r", "rudder"): rudder,
        ("elevator_effect", "elevator"): 1.0 / LAG,
        ("throttle_effect", "throttle"): 1.0 / ENGINE_LAG,
    }
    for (row, column), value in forcing.items():
        b[STATES.index(row), INPUTS.index(column)] = value
    return LinearModel(
        A=a,
        B=b,
        C=np.eye(11),
        D=np.zeros((11, 4)),
        state_labels=STATES,
        input_labels=INPUTS,
        output_labels=STATES,
    )


BANK = 0.6  # rad; half of it is the step that half the authority is to turn


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        # A tenth of a radian and more of phase for delays: 0.18 rad over 12.5 ms without a servo.
        ({"aileron": 1000.0}, 0.18 / DELAY),
        # Authority: w^2 times 0.3 rad from half of 2 1/s^2.
        ({"aileron": 2.0, "roll_damping": -0.1}, math.sqrt(0.5 * 2.0 / 0.3)),
        # Roll damping: 0.42 w times 0.3 rad is as fast as half of 10 1/s^2 rolls against 20 1/s.
        ({"aileron": 10.0, "roll_damping": -20.0}, 0.5 * 10.0 / 20.0 / (0.42 * 0.3)),
    ],
)
def test_the_turn_is_as_fast_as_delay_authority_and_roll_damping_allow(changes, expected):
    assert reachable_bandwidths([simple(**changes)], BANK).lateral == pytest.approx(
        expected, rel=1e-12
    )


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"elevator": -1000.0, "z_alpha": -50.0}, 0.18 / (LAG + DELAY)),
        # Either sign of the elevator: 0.15 rad from half of 1 1/s^2.
        ({"elevator": 1.0}, math.sqrt(0.5 * 1.0 / 0.15)),
        ({"elevator": -1.0}, math.sqrt(0.5 * 1.0 / 0.15)),
        # Three quarters of what lift follows the angle of attack with.
        ({"z_alpha": -1.2}, 0.75 * 1.2),
    ],
)
def test_altitude_is_as_fast_as_delay_authority_and_lift_allow(changes, expected):
    assert reachable_bandwidths([simple(**changes)], BANK).longitudinal == pytest.approx(
        expected, rel=1e-12
    )


def test_airspeed_is_as_fast_as_the_engine_and_slower_than_altitude():
    # Lift allows 2.25 rad/s, of which 0.27; the engine 0.3 over its lag.
    assert reachable_bandwidths([simple()], BANK).airspeed == pytest.approx(
        0.3 / (ENGINE_LAG + DELAY), rel=1e-12
    )
    assert reachable_bandwidths([simple(z_alpha=-1.2)], BANK).airspeed == pytest.approx(
        0.27 * 0.9, rel=1e-12
    )


def test_the_slowest_of_all_airspeeds_decides_each_axis_by_itself():
    slow_turn, slow_climb = simple(aileron=2.0, roll_damping=-0.1), simple(z_alpha=-1.2)
    both = reachable_bandwidths([slow_turn, slow_climb], BANK)
    assert both.lateral == reachable_bandwidths([slow_turn], BANK).lateral
    assert both.longitudinal == reachable_bandwidths([slow_climb], BANK).longitudinal


def test_the_controls_may_do_what_moves_their_axis_at_its_frequency_against_its_damping():
    bandwidths = LoopBandwidths(lateral=3.0, longitudinal=2.0, airspeed=0.5)
    asked = design_weights(bandwidths, 20.0)
    found = control_weights(simple(), bandwidths, asked)
    # w hypot(w, damping) times the acceptable angle, over authority: by hand, 0.3 rad of pitch and
    # 0.1 rad of roll.
    assert found.elevator == pytest.approx(0.3 * 2.0 * math.hypot(2.0, 5.0) / 20.0, rel=1e-12)
    assert found.aileron == pytest.approx(0.1 * 3.0 * math.hypot(3.0, 4.0) / 30.0, rel=1e-12)
    assert found.throttle == pytest.approx(asked.airspeed * 0.5 / 6.0, rel=1e-12)
    # The rudder: 0.05 rad of sideslip, at w hypot(w, 1.5) or, if that is less, against the
    # weathercock's own 8 1/s^2.
    assert found.rudder == pytest.approx(0.05 * 8.0 / 5.0, rel=1e-12)
    stiff = control_weights(simple(yaw_stiffness=50.0), bandwidths, asked)
    assert stiff.rudder == pytest.approx(0.05 * 3.0 * math.hypot(3.0, 1.5) / 5.0, rel=1e-12)


def test_an_aircraft_without_a_rudder_has_no_weight_for_it(x8_design):
    schedule = x8_design.schedule
    assert math.isnan(
        control_weights(
            schedule.models[2][LEVEL_GAINS], x8_design.bandwidths, schedule.weights
        ).rudder
    )


def test_deviations_are_those_that_a_pitch_of_three_tenths_makes_in_a_unit_of_time():
    found = design_weights(LoopBandwidths(lateral=4.0, longitudinal=2.0, airspeed=0.5), 20.0)
    # Half a second of a climb at 0.3 rad and 20 m/s is 3 m, of which half; g times 0.3 rad in it is
    # 1.47 m/s, twice.
    assert found.altitude == pytest.approx(0.5 * 20.0 * 0.3 * 0.5)
    assert found.airspeed == pytest.approx(2.0 * STANDARD_GRAVITY * 0.3 * 0.5)
    assert (found.pitch, found.roll, found.sideslip) == (0.3, 0.1, 0.05)
    assert (found.model_frequency, found.model_damping) == (4.0, 0.9)


def test_with_half_the_speed_everything_takes_twice_as_long():
    bandwidths = LoopBandwidths(lateral=4.0, longitudinal=2.0, airspeed=0.5)
    quick, slow = (
        design_weights(bandwidths, 20.0),
        design_weights(bandwidths.scaled(lateral=0.5, longitudinal=0.5, airspeed=0.5), 20.0),
    )
    # At the same V and g: lengths V/w and airspeeds g/w double, their integrals quadruple, angles
    # stay, and rates halve.
    exponents = {
        "airspeed": 1, "pitch": 0, "pitch_rate": -1, "altitude": 1, "airspeed_integral": 2, "altitude_integral": 2, "roll": 0,
        "roll_rate": -1, "sideslip": 0, "heading_integral": 1, "sideslip_integral": 1, "model_frequency": -1, "model_damping": 0,
        "altitude_error_max": 1, "airspeed_error_max": 1, "anti_windup_rate": -1,
    }  # fmt: skip
    ratios = {
        field.name: getattr(slow, field.name) / getattr(quick, field.name)
        for field in fields(quick)
    }
    assert ratios == pytest.approx({name: 2.0**exponent for name, exponent in exponents.items()})


SCALES = {
    "airspeed": 2.0,
    "climb_rate": 2.0,
    "altitude": 4.0,
    "propeller_speed": 0.5,
    "heading_rate": 0.5,
    "p": 0.5,
    "q": 0.5,
    "r": 0.5,
}
"""A dynamically similar aircraft, four times as long: in the same gravity it flies twice as fast,
and all takes twice the time.
"""


def similar(model):
    """The linear model of the aircraft four times as long."""
    state = np.array([SCALES.get(name, 1.0) for name in model.state_labels])
    output = np.array([SCALES.get(name, 1.0) for name in model.output_labels])
    return replace(
        model,
        A=0.5 * state[:, None] * model.A / state,
        B=0.5 * state[:, None] * model.B,
        C=output[:, None] * model.C / state,
        D=output[:, None] * model.D,
    )


@pytest.mark.parametrize("name", ["x8", "aerosonde"])
def test_a_dynamically_similar_aircraft_gets_the_similar_autopilot(monkeypatch, designs, name):
    schedule = designs(name).design.schedule
    models = [row[LEVEL_GAINS] for row in schedule.models]
    bank, airspeed = schedule.envelope.bank, schedule.airspeeds[2]

    def designed(models, airspeed, level):
        bandwidths = reachable_bandwidths(models, bank)
        asked = design_weights(bandwidths, airspeed)
        return bandwidths, design_gains(
            models[2], level, asked, control_weights(models[2], bandwidths, asked)
        )

    level = schedule.level(2)
    bandwidths, gains = designed(models, airspeed, level)
    # The autopilot's steps are the only time that is not the aircraft's own.
    monkeypatch.setattr(weights, "loop_delay", lambda _: 2.0 * DELAY)
    larger = replace(level, airspeed=2.0 * level.airspeed)
    slower, scaled = designed([similar(model) for model in models], 2.0 * airspeed, larger)
    assert astuple(slower) == pytest.approx([0.5 * s for s in astuple(bandwidths)])
    # The same deflection for a deviation that is as large for the larger aircraft: gains are over
    # the deviation's scale.
    units = np.array(
        [
            SCALES[n] if n != "pitch" else 1.0
            for n in ("airspeed", "climb_rate", "q", "pitch", "altitude")
        ]
    )
    np.testing.assert_allclose(
        scaled.longitudinal * units, gains.longitudinal, rtol=1e-5, atol=1e-9
    )
    np.testing.assert_allclose(
        scaled.longitudinal_integral * 2.0 * np.array([2.0, 4.0]),
        gains.longitudinal_integral,
        rtol=1e-5,
    )
    np.testing.assert_allclose(
        scaled.lateral * np.array([0.5, 0.5, 1.0, 1.0]), gains.lateral, rtol=1e-5, atol=1e-9
    )
    assert scaled.heading_integral == pytest.approx(
        gains.heading_integral, rel=1e-5
    )  # heading is an angle
    assert 2.0 * scaled.sideslip_integral == pytest.approx(gains.sideslip_integral, rel=1e-5)
    np.testing.assert_allclose(
        0.5 * scaled.roll_rate_feedforward, gains.roll_rate_feedforward, rtol=1e-9
    )
    np.testing.assert_allclose(
        0.25 * scaled.roll_acceleration_feedforward, gains.roll_acceleration_feedforward, rtol=1e-9
    )
