"""The one loop: what it records, payload, plume elevation, and where a flight is released."""

import math

import numpy as np
import pytest
from flight_cases import ASTERN, SPEED, fly, plan, scenario

from scenarios.flight import closed_loop
from scenarios.flight.closed_loop import release
from scenarios.instruments.instrument import payload
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.vehicle_setup import kinematic_setup

SHORT = {
    "start": ASTERN,
    "flight": {"crossings": 0, "duration_max_s": 60.0},
    "criteria": {"settles": False},
}


def tracking(**changes):
    return Scenario.model_validate(
        {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}} | SHORT | changes
    )


def flown(given, instruments=(), **how):
    flight, setup = plan(given), kinematic_setup(given)
    return closed_loop.fly(flight, release(flight, setup), instruments, **how)


MISSIONS = pytest.mark.parametrize(
    "given", [scenario(**SHORT), tracking()], ids=["following", "tracking"]
)


@payload("distance_meter_of_this_test")
class DistanceMeter:
    """Reads its distance from the origin, and a number that is random."""

    COLUMNS = ("reading_m", "noise_ppb")

    def __init__(self, _scenario, world, generator):
        self._world, self._generator = world, generator

    def read(self, time, motion, _sample):
        vessel = self._world.vessel.motion(time)
        return math.hypot(motion[0] - vessel[0], motion[1] - vessel[1]), self._generator.random()


def test_what_an_instrument_reads_is_in_the_time_history():
    history, again = (
        fly(payload=("distance_meter_of_this_test",), **SHORT).history for _ in range(2)
    )
    distance = np.hypot(
        *(history[f"{axis}_m"] - history[f"vessel_{axis}_m"] for axis in ("north", "east"))
    )
    np.testing.assert_allclose(history["reading_m"], distance, rtol=1e-14)  # the last bit of a root
    # Its own random numbers, by the flight's seed; and nothing else of the flight changes with
    # them.
    assert history["noise_ppb"].nunique() == len(history)
    np.testing.assert_array_equal(history["noise_ppb"], again["noise_ppb"])
    without = fly(**SHORT).history
    np.testing.assert_array_equal(history[without.columns], without)


@MISSIONS
def test_to_record_every_step_changes_nothing_of_a_flight(given):
    sampled, every = flown(given), flown(given, every_step=True)
    np.testing.assert_array_equal(every.history, sampled.history)
    np.testing.assert_array_equal(every.every_step[::2], sampled.history)
    assert len(every.every_step) == 1201
    assert sampled.every_step is sampled.history


def test_a_kinematic_vehicle_is_released_at_the_start_of_its_plan_in_its_wind():
    given = scenario(
        wind={"speed_mps": 5.0, "from_deg": 180.0}, start=ASTERN | {"course_deg": 90.0}
    )
    flight = plan(given)
    vehicle = release(flight, kinematic_setup(given))
    assert isinstance(vehicle, KinematicVehicle)
    # Eastbound at its airspeed, in a wind that blows to the north.
    assert vehicle.motion() == pytest.approx(
        (flight.start.north, flight.start.east, 5.0, SPEED, 0.0), abs=1e-12
    )
    assert vehicle.sample()[0] == flight.altitude == 60.0
