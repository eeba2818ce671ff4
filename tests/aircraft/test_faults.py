"""Faults of several aircraft, flown without an autopilot; with one: tests/innerloop."""

import pytest

from aircraft.faults import ENGINE, Faults, failable_root
from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.model import copy_model
from aircraft.state import RigidBodyState


@pytest.fixture
def failable(tmp_path):
    """A function from a name and airspeed [m/s] to an aircraft in flight that can fail."""

    def make(name, airspeed):
        spec = find_spec(name)
        copy_model(spec.files, tmp_path / "own")
        fdm = Fdm(spec, failable_root(spec, tmp_path / "own", tmp_path / "failable"))
        faults = Faults(fdm)
        fdm.command({"elevator": 0.1, "aileron": 0.05, "rudder": -0.1, "throttle": 0.8})
        fdm.hold(
            RigidBodyState(altitude=300.0, roll=0.0, pitch=0.0, velocity_body=(airspeed, 0.0, 0.0)),
            round(spec.settle_time / fdm.time_step),
        )
        faults.store_trim_positions()
        return fdm, faults

    return make


@pytest.mark.parametrize(
    ("name", "airspeed", "aileron", "play"),
    # Half the hysteresis of the elevator's servo of JSBSim's Cessna, 0.05 rad in its file; this
    # project's Aerosonde has none.
    [
        ("aerosonde", 25.0, "fcs/aileron-pos-rad", 0.0),
        ("c172x", 55.0, "fcs/left-aileron-pos-rad", 0.025),
    ],
)
def test_each_surface_follows_its_command_until_it_sticks_at_trim(
    failable, name, airspeed, aileron, play
):
    fdm, faults = failable(name, airspeed)
    positions = {
        "elevator": "fcs/elevator-pos-rad",
        "aileron": aileron,
        "rudder": "fcs/rudder-pos-rad",
    }
    for surface, position in positions.items():
        trim = fdm.read(position)
        with fdm.frozen():
            fdm.command({surface: 0.8})
            fdm.step(60)
            assert abs(fdm.read(position) - trim) > 0.05  # rad
            faults.fail(surface)
            fdm.step(60)
            # Half a second behind servos of 25 ms and less: back to exp(-20).
            stuck = fdm.read(position)
            assert stuck == pytest.approx(trim, abs=play + 1e-8)
            fdm.command({surface: -0.8})
            fdm.step(60)
        assert fdm.read(position) == pytest.approx(stuck, abs=1e-8)
    assert faults.failed == list(positions)


@pytest.mark.parametrize(
    ("name", "airspeed"), [("aerosonde", 25.0), ("c172x", 55.0), ("T38", 200.0)]
)
def test_a_lost_engine_of_any_kind_gives_no_thrust_until_it_is_repaired(failable, name, airspeed):
    fdm, faults = failable(name, airspeed)
    thrust = [
        f"propulsion/engine[{i}]/thrust-lbs"
        for i in range(len(fdm.spec.input("throttle").commands))
    ]
    assert all(fdm.read(engine) > 0.1 for engine in thrust)
    faults.fail(ENGINE)
    fdm.command({"throttle": 1.0})
    with fdm.frozen():
        fdm.step(1200)
    assert all(fdm.read(engine) <= 0.0 for engine in thrust)
    # Nor does it come to life while it wind-mills.
    assert all(fdm.read(running) == 0.0 for running in fdm.spec.engine_flags)
    faults.clear()
    fdm.reset()
    fdm.command({"throttle": 0.8})
    fdm.hold(
        RigidBodyState(altitude=300.0, roll=0.0, pitch=0.0, velocity_body=(airspeed, 0.0, 0.0)),
        round(fdm.spec.settle_time / fdm.time_step),
    )
    assert all(fdm.read(engine) > 0.1 for engine in thrust)
