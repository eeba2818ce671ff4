"""The one loop: what it records, payload, plume elevation, and where a flight is released."""

import math

import numpy as np
import pytest
from flight_cases import ASTERN, SPEED, fly, plan, scenario

from common.columns import unit_of
from scenarios.flight import closed_loop
from scenarios.flight.closed_loop import release
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.record import COLUMNS, HISTORY_COLUMNS
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
def test_both_missions_record_the_same_columns(given):
    record = flown(given)
    # And what a guard believes, where there is one.
    assert record.columns in (COLUMNS, (*COLUMNS, *GuardBelief.COLUMNS))
    assert record.history.shape == (601, len(record.columns))
    # 10 samples a second, from the start to the end.
    np.testing.assert_allclose(record.column("time_s"), 0.1 * np.arange(601), rtol=0.0, atol=1e-9)
    own = [
        name for name in COLUMNS[: COLUMNS.index("altitude_m")] if not name.startswith("centre_")
    ]
    assert all(np.isfinite(record.column(name)).all() for name in own if name != "speed_ratio")


@MISSIONS
def test_to_record_every_step_changes_nothing_of_a_flight(given):
    sampled, every = flown(given), flown(given, every_step=True)
    np.testing.assert_array_equal(every.history, sampled.history)
    np.testing.assert_array_equal(every.every_step[::2], sampled.history)
    assert len(every.every_step) == 1201
    assert sampled.every_step is sampled.history


def test_every_column_has_a_meaning_and_a_unit():
    assert all(column.meaning for column in HISTORY_COLUMNS.values())
    assert [unit_of(name) for name in ("time_s", "north_m", "heading_rate_rad_s", "airspeed_mps", "guard")] == [
        "s", "m", "rad/s", "m/s", "1",
    ]  # fmt: skip
    # A unit of two words is not its last one.
    names = (
        "dose_per_pass_ppm_s",
        "plume_s_per_minute",
        "crossings_per_minute",
        "served_per_hour",
        "l1_integrator_per_s",
    )
    assert [unit_of(name) for name in names] == ["ppm s", "s/min", "1/min", "1/h", "1/s"]


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


def test_a_following_flight_in_a_rising_plume_is_commanded_to_the_height_of_its_centre(monkeypatch):
    commanded = []
    monkeypatch.setattr(
        KinematicVehicle, "command_altitude", lambda _, altitude: commanded.append(altitude)
    )
    record = flown(scenario(plume={"elevation_deg": 10.0}, **SHORT))
    centre, seen = (
        [record.column(f"{of}_{axis}_m") for axis in ("north", "east")]
        for of in ("centre", "vessel_seen")
    )
    to_centre = np.hypot(*np.subtract(centre, seen))
    # Above the funnel's 60 m as the axis rises to the centre of oscillation.
    expected = 60.0 + math.tan(math.radians(10.0)) * to_centre
    climbs = np.diff(commanded) * 2.0
    # It follows in 20 s, no steeper than 5 % at 19.42 m/s; plans come every half a second.
    assert np.max(np.abs(climbs)) <= 0.05 * SPEED * (1.0 + 1e-9)
    assert commanded[0] == pytest.approx(60.0, abs=0.5)
    towards = np.sign(expected[-1] - 60.0)
    assert towards * (commanded[-1] - commanded[0]) > 25.0
    assert abs(commanded[-1] - expected[-1]) < 0.05 * abs(expected[-1] - 60.0)


def test_a_part_that_ends_the_steps_of_a_flight_is_no_record_of_it():
    # Python makes such an error of it by itself; where steps are compiled, the exception of the
    # part gets through.
    for value in (None, "stop"):
        with pytest.raises(RuntimeError, match="generator raised StopIteration"):
            closed_loop.record_of(StopIteration(value))
    record = flown(tracking())
    assert closed_loop.record_of(StopIteration(record)) is record
