"""JSBSim's own aircraft in the wrapper: engines run, gear is up, fuel stays, and places are reached
again.
"""

import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.state import RigidBodyState, body_velocity

pytestmark = pytest.mark.slow

# m/s, each somewhere in its flight manual's range.
AIRSPEEDS = {"c172x": 55.0, "c310": 75.0, "T37": 80.0, "737": 150.0}


@pytest.fixture(scope="module", params=AIRSPEEDS)
def placed(request):
    """An aircraft that has been placed in flight, and its state."""
    name = request.param
    fdm = Fdm(find_spec(name))
    state = RigidBodyState(
        altitude=1000.0,
        roll=0.0,
        pitch=0.05,
        velocity_body=body_velocity(AIRSPEEDS[name], 0.05, 0.0),
    )
    fdm.command({"elevator": 0.0, "aileron": 0.0, "throttle": 0.7, "rudder": 0.0})
    fdm.place(state)
    return name, fdm, state


def test_an_engine_that_jsbsim_does_not_start_at_once_is_started_by_its_starter():
    # The Mustang's: asked to run at once, its running flag stays 0.
    fdm = Fdm(find_spec("p51d"))
    fdm.command({"throttle": 0.7})
    fdm.place(
        RigidBodyState(
            altitude=1000.0, roll=0.0, pitch=0.05, velocity_body=body_velocity(110.0, 0.05, 0.0)
        )
    )
    assert fdm.cranked
    assert fdm.read("propulsion/engine/set-running") == 1.0
    assert fdm.read("propulsion/starter_cmd") == 0.0
    assert fdm.read("fcs/throttle-cmd-norm") == 0.7  # as it was commanded before


def test_the_gear_is_up_and_neither_fuel_nor_mass_changes_in_flight(placed):
    _, fdm, state = placed
    fdm.place(state)
    assert fdm.read("gear/gear-pos-norm") == 0.0
    weight = fdm.read("inertia/weight-lbs")
    with fdm.frozen():
        fdm.step(1200)
    # Ten seconds of a 737's engines would be 15 kg.
    assert fdm.read("inertia/weight-lbs") == weight
