"""The view of JSBSim: properties, placing, holding, silence, FlightGear and the clock."""

import math
import shutil
from dataclasses import replace

import pytest

from aircraft.fdm import CLOCK, TIME_STEP, Fdm
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.spec import MODELS, AircraftError
from aircraft.state import RigidBodyState, body_velocity
from common.geodesy import LocalFrame
from common.physics import METRES_PER_FOOT

SOMEWHERE = RigidBodyState(
    latitude=0.2,
    longitude=-0.3,
    altitude=120.0,
    roll=0.3,
    pitch=0.1,
    yaw=1.234,
    velocity_body=body_velocity(20.0, 0.04, -0.02),
    rates_body=(0.3, -0.2, 0.1),
)


def velocity_body(fdm):
    return [METRES_PER_FOOT * fdm.read(f"velocities/{name}-aero-fps") for name in "uvw"]


def rates_body(fdm):
    return [fdm.read(f"velocities/{name}-rad_sec") for name in "pqr"]


@pytest.mark.parametrize("use", ["read", "node", "writable_node"])
def test_a_misspelt_property_is_refused_by_name_on_reading(x8_fdm, use):
    with pytest.raises(AircraftError, match="'aero/alpha-rd'"):
        getattr(x8_fdm, use)("aero/alpha-rd")


@pytest.mark.parametrize(
    "name", ["aero/alpha rad", "", "/aero", "aero//alpha-rad", "aero/alpha-rad "]
)
def test_what_is_not_a_property_name_is_refused_before_it_can_end_the_process(x8_fdm, name):
    with pytest.raises(AircraftError):
        x8_fdm.read(name)


def test_a_root_without_the_model_gets_one_line_that_names_file_and_remedy(tmp_path):
    with pytest.raises(AircraftError, match=r"x8\.xml; check") as caught:
        Fdm(X8, tmp_path)
    assert "\n" not in str(caught.value)
    assert str(tmp_path) in str(caught.value)


def test_a_root_without_the_engine_files_gets_one_line_with_the_file_that_is_missing(tmp_path):
    shutil.copytree(MODELS / "aircraft", tmp_path / "aircraft")
    with pytest.raises(AircraftError, match="Could not open file: x8_motor") as caught:
        Fdm(X8, tmp_path)
    assert "\n" not in str(caught.value)


def test_a_placed_aircraft_is_where_and_as_it_was_asked(x8_fdm):
    x8_fdm.place(SOMEWHERE)
    # Feet and quaternions in between: twelve digits survive.
    assert x8_fdm.read("position/lat-geod-rad") == pytest.approx(0.2, abs=1e-12)
    assert x8_fdm.read("position/long-gc-rad") == pytest.approx(-0.3, abs=1e-12)
    # A metre in 6.4 million, twice.
    assert x8_fdm.read("position/h-sl-meters") == pytest.approx(120.0, abs=1e-6)
    assert velocity_body(x8_fdm) == pytest.approx(SOMEWHERE.velocity_body, abs=1e-11)
    assert rates_body(x8_fdm) == pytest.approx(SOMEWHERE.rates_body, abs=1e-12)
    for name, angle in (("phi", 0.3), ("theta", 0.1), ("psi", 1.234)):
        assert x8_fdm.read(f"attitude/{name}-rad") == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("latitude", [0.0, 0.9])
@pytest.mark.parametrize("yaw", [0.0, 1.234, -2.5])
def test_hold_releases_at_the_asked_place_with_the_asked_yaw_and_motion(x8_fdm, latitude, yaw):
    state = replace(SOMEWHERE, latitude=latitude, yaw=yaw)
    x8_fdm.hold(state, 240)
    frame = LocalFrame(latitude, state.longitude, state.altitude)
    north, east = frame.to_local(
        x8_fdm.read("position/lat-geod-rad"), x8_fdm.read("position/long-gc-rad")
    )
    # In two seconds the equator turns away by 930 m; 0.1 m is a thousandth of a percent of a plume
    # crossing of kilometres.
    assert math.hypot(north, east) < 0.1
    assert x8_fdm.read("position/h-sl-meters") == pytest.approx(120.0, abs=0.1)
    # The earth turns by 1.5e-4 rad meanwhile: an attitude held against the stars instead would be
    # that far off.
    off = x8_fdm.read("attitude/psi-rad") - yaw
    assert math.remainder(off, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert x8_fdm.read("attitude/phi-rad") == pytest.approx(0.3, abs=1e-6)
    assert x8_fdm.read("attitude/theta-rad") == pytest.approx(0.1, abs=1e-6)
    assert velocity_body(x8_fdm) == pytest.approx(state.velocity_body, abs=1e-6)
    assert rates_body(x8_fdm) == pytest.approx(state.rates_body, abs=1e-6)


@pytest.mark.parametrize("throttle", [0.5, 0.9])
def test_a_slow_engine_settles_where_it_would_at_its_own_pace(throttle):
    # The Cessna's piston engine changes its speed in a second: from 0.7 of its throttle it takes a
    # thousand steps and more.
    fdm = Fdm(find_spec("c172x"))
    fdm.command({"throttle": 0.7})
    velocity = body_velocity(50.0, 0.05, 0.0)
    fdm.place(RigidBodyState(altitude=500.0, roll=0.0, pitch=0.05, velocity_body=velocity))
    with fdm.frozen():
        assert fdm.settle(2e-9)
        fdm.command({"throttle": throttle})
        before, began = fdm.acceleration_body()[0], fdm.read(CLOCK)
        steps, run = [], fdm.run
        fdm.run = lambda: steps.append(run())
        assert fdm.settle(2e-9)
        # After 120 steps it is sped up eightfold: in less than half of the steps that the time
        # takes.
        assert len(steps) < 0.5 * (fdm.read(CLOCK) - began) / TIME_STEP
        settled = fdm.acceleration_body()[0], fdm.read("propulsion/engine/engine-rpm")
        fdm.step(2400)
        # Twenty seconds more change nothing: 2e-9 m/s^2 a step is 2e-7 from the end, of an
        # acceleration that changed by 1e-1.
        assert abs(settled[0] - before) > 0.1
        assert fdm.acceleration_body()[0] == pytest.approx(settled[0], abs=2e-7)
        assert fdm.read("propulsion/engine/engine-rpm") == pytest.approx(settled[1], rel=1e-7)
    # Flight goes on with its own time step.
    clock = fdm.read(CLOCK)
    fdm.step(120)
    assert fdm.read(CLOCK) - clock == pytest.approx(1.0)


def test_a_flight_that_is_shown_is_the_same_to_the_last_bit():
    shown, alone = Fdm(X8), Fdm(X8)
    shown.stream('<output name="127.0.0.1" type="FLIGHTGEAR" port="9" protocol="UDP" rate="30"/>')
    for fdm in (shown, alone):
        fdm.place(SOMEWHERE)
        fdm.step(30)
    names = (
        "position/lat-geod-rad",
        "position/long-gc-rad",
        "attitude/phi-rad",
        "velocities/vt-fps",
    )
    assert [shown.read(name) for name in names] == [alone.read(name) for name in names]
