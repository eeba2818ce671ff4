"""The control law in Python is the one that JSBSim flies: same states in, same commands out.

The body is held at random states (``Fdm.frozen``), with every integral held at 0 or running, and
the commands of the autopilot inside JSBSim, before its limits, are compared with
``ControlLaw.evaluate``. Margins are computed from the latter.
"""

import math

import numpy as np
import pytest

from aircraft.state import RigidBodyState, body_velocity
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE, RESET, write_root
from innerloop.law import STATES, ControlLaw, measurements, operating_point
from innerloop.schedule import LATERAL

NAMES = ("x8", "aerosonde")
MEASURED = {
    "airspeed": "autopilot/airspeed-mps",
    "climb_rate": "autopilot/climb-rate-mps",
    "altitude": "position/h-sl-meters",
    "pitch": "attitude/theta-rad",
    "roll": "attitude/phi-rad",
    "beta": "aero/beta-rad",
    "heading_rate": HEADING_RATE,
    **{name: f"velocities/{name}-rad_sec" for name in "pqr"},
}
REMEMBERED = {name: f"autopilot/{name.replace('_', '-')}" for name in STATES}
DIGITS = 2e-7
"""Tables and gains are written with nine digits; commands are of size 1, and sums of ten terms up
to 10.
"""


@pytest.fixture(scope="module", params=NAMES)
def flown(request, designs, tmp_path_factory):
    """A schedule, its law, and the aircraft that flies it."""
    schedule = designs(request.param).design.schedule
    root = write_root(schedule, tmp_path_factory.mktemp(request.param))
    return schedule, ControlLaw(schedule), AutopilotedAircraft(schedule.spec, root)


def random_state(rng, schedule):
    """A state and commands in the envelope and a little past its bank, with unclipped errors."""
    weights, envelope = schedule.weights, schedule.envelope
    commanded = rng.uniform(envelope.airspeed_min, envelope.airspeed_max)
    airspeed = commanded + 0.9 * weights.airspeed_error_max * rng.uniform(-1.0, 1.0)
    altitude = schedule.altitude + 0.9 * weights.altitude_error_max * rng.uniform(-1.0, 1.0)
    state = RigidBodyState(
        altitude=altitude,
        roll=1.05 * envelope.bank_max * rng.uniform(-1.0, 1.0),
        pitch=rng.uniform(-0.1, 0.2),
        yaw=rng.uniform(-3.0, 3.0),
        velocity_body=body_velocity(airspeed, rng.uniform(0.0, 0.12), rng.uniform(-0.05, 0.05)),
        rates_body=tuple(rng.uniform(-0.5, 0.5, 3).tolist()),
    )
    turn_max = 9.8 * math.tan(envelope.bank_max) / airspeed
    return state, {
        "airspeed_command": commanded,
        "altitude_command": schedule.altitude,
        "heading_rate_command": 0.9 * turn_max * rng.uniform(-1.0, 1.0),
    }


def held(flown, rng, computed):
    """Hold a random state; return commands, measurements and the autopilot's states.

    The integrals are ``computed`` that many times.
    """
    schedule, _, aircraft = flown
    fdm, period = aircraft.fdm, schedule.period
    state, commands = random_state(rng, schedule)
    aircraft.command_airspeed(commands["airspeed_command"])
    aircraft.command_altitude(commands["altitude_command"])
    aircraft.command_heading_rate(commands["heading_rate_command"])
    fdm.write(RESET, -1.0)
    fdm.place(state)
    remembered = {
        name: prop
        for name, prop in REMEMBERED.items()
        if name != "rudder_integral" or "rudder" in schedule.controls
    }
    with fdm.frozen():
        fdm.step(3 * period)
        fdm.write(RESET, 0.0 if computed else -1.0)
        fdm.step(period * max(0, computed - 1))
        before = dict.fromkeys(STATES, 0.0) | {
            name: fdm.read(prop) for name, prop in remembered.items()
        }
        fdm.step(period)
    # Integrals act a period after they are gathered; the model's own states at once.
    states = before | {
        name: fdm.read(REMEMBERED[name]) for name in ("model_rate", "model_acceleration")
    }
    measured = {name: fdm.read(MEASURED[name]) for name in measurements(schedule)}
    return commands, measured, states


def with_flown_jerk(flown, commands, states):
    """The commands at which the law has the jerk of this period.

    JSBSim computes the jerk before its model moves.
    """
    schedule, _, aircraft = flown
    frequency, damping = schedule.weights.model_frequency, schedule.weights.model_damping
    jerk = aircraft.fdm.read("autopilot/model-jerk")
    target = (
        jerk + 2.0 * damping * frequency * states["model_acceleration"]
    ) / frequency**2 + states["model_rate"]
    return commands | {"heading_rate_command": target}


@pytest.mark.parametrize("computed", [0, 1, 30])
def test_at_random_states_jsbsim_asks_for_the_controls_that_the_law_computes(flown, computed):
    schedule, law, aircraft = flown
    rng = np.random.default_rng(20 + computed)
    compared = 0
    for _ in range(25):
        commands, measured, states = held(flown, rng, computed)
        if abs(aircraft.fdm.read("autopilot/bank-unlimited-rad")) > schedule.envelope.bank_max:
            continue  # the law has no limits
        _, expected = law.evaluate(with_flown_jerk(flown, commands, states), measured, states)
        found = {
            name: aircraft.fdm.read(f"autopilot/{name}-unlimited") for name in schedule.controls
        }
        assert found == pytest.approx(expected, rel=DIGITS, abs=DIGITS)
        compared += 1
    assert compared > 8


def test_at_random_states_the_integrals_grow_as_the_law_says(flown):
    schedule, law, aircraft = flown
    read = aircraft.fdm.read
    rng = np.random.default_rng(1)
    integrals = [name for name in schedule.controls if name != "aileron"]
    for _ in range(25):
        commands, measured, states = held(flown, rng, 1)
        expected, _ = law.evaluate(commands, measured, states)
        # What is left is back-calculation, which the law has not: it follows a control past its
        # limit.
        back = schedule.weights.anti_windup_rate
        found = {
            f"{name}_integral": read(f"autopilot/{name}-integral-rate")
            - back * (read(f"autopilot/{name}-command") - read(f"autopilot/{name}-unlimited"))
            for name in integrals
        }
        assert found == pytest.approx(
            {name: expected[name] for name in found}, rel=DIGITS, abs=DIGITS
        )
        assert read("autopilot/bank-integral-rate") == pytest.approx(
            expected["bank_integral"], rel=DIGITS, abs=DIGITS
        )


@pytest.mark.parametrize("name", NAMES)
def test_in_every_equilibrium_the_law_asks_for_its_controls_and_its_integrals_stand_still(
    designs, name
):
    schedule = designs(name).design.schedule
    law = ControlLaw(schedule)
    for i in range(len(schedule.airspeeds)):
        for j in range(len(schedule.gain_banks)):
            t, gains = schedule.gain_trim(i, j), schedule.gains[i][j]
            point = operating_point(law, t)
            rates, controls = law.evaluate(point, point, point)
            # The law damps all of the roll rate, and a nose-up turn has its own, -yaw rate times
            # sin(pitch): what aileron and rudder then lack, the integral of the heading rate adds.
            lacks = -gains.lateral[:, LATERAL.index("p")] * t.rates_body[0]
            by_roll_rate = dict(zip(("aileron", "rudder"), lacks, strict=True))
            # At its own nodes a table is exact, and every error is 0.
            for control_name, value in t.inputs.items():
                assert controls[control_name] == pytest.approx(
                    value + by_roll_rate.get(control_name, 0.0), abs=1e-9
                )
            assert rates["bank_integral"] == 0.0
            assert max(abs(rates["elevator_integral"]), abs(rates["throttle_integral"])) == 0.0
            assert rates["model_acceleration"] == pytest.approx(0.0, abs=1e-12)
