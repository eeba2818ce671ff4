"""A sniffer that is read in flight reads what it reads after the flight, and fails as its fault
says.
"""

import numpy as np
import pytest

from measurement.gases import GASES
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import load_study
from scenarios.vehicles.vehicle_setup import kinematic_setup
from scenarios.world.noise import PAYLOAD, Noise, own_generator

QUICK = (
    "fidelity=kinematic",
    "reports.interval_s=[0,0]",
    "sensors={}",
    "following={}",
    "flight.duration_max_s=60",
)
CO2 = GASES.index("co2")


def sniffer(*overrides):
    """Return the sniffer of a flight, as fresh as its random numbers."""
    scenario = load_study("sulphur", (*QUICK, *overrides))
    plan = plan_flight(scenario, flight_id="a", seed=3, setup=kinematic_setup(scenario))
    return SnifferOnBoard(scenario, plan.world, own_generator(Noise(3), PAYLOAD))


def path(duration=40.0, step=0.1):
    """Return the columns of a record that swings through the smoke 200 m astern, and climbs."""
    time = step * np.arange(round(duration / step) + 1)
    swing = 2.0 * np.pi / 8.0
    return {
        "time_s": time,
        "north_m": -200.0 + 40.0 * np.sin(swing * time),
        "east_m": 12.0 * time - 130.0,
        "altitude_m": 40.0 + 0.5 * time,
        "velocity_north_mps": 40.0 * swing * np.cos(swing * time),
        "velocity_east_mps": np.full(len(time), 12.0),
        "climb_rate_mps": np.full(len(time), 0.5),
        "airspeed_mps": np.full(len(time), 19.0),
    }


def followed(instrument, columns):
    """Return all readings that come while the path is flown."""
    read = []
    names = ("north_m", "east_m", "velocity_north_mps", "velocity_east_mps")
    for i, time in enumerate(columns["time_s"].tolist()):
        motion = (*(float(columns[name][i]) for name in names), 0.0)
        sample = (
            float(columns["altitude_m"][i]),
            float(columns["airspeed_mps"][i]),
            0.0,
            float(columns["climb_rate_mps"][i]),
        )
        read += instrument.follow(time, motion, sample)
    return np.array(read)


@pytest.mark.parametrize("sensor", ["fast", "electrochemical"])
def test_the_same_seed_reads_the_same_in_flight_as_after_it(sensor):
    columns, settled_at = path(), 1e9
    after, during = sniffer(f"payload.sensor={sensor}"), sniffer(f"payload.sensor={sensor}")
    expected = after.evaluate(columns.__getitem__, settled_at).columns
    read = followed(during, columns)
    known = after.readings(0.0)
    # To the bit, for readings are rounded to the channel's resolution. The last ones may not have
    # come yet.
    assert np.array_equal(read[:, 0], known.time[: len(read)])
    assert np.array_equal(read[:, 1], known.values[: len(read), CO2])
    assert known.time[-1] - read[-1, 0] <= 1.0 + 1e-9
    assert np.ptp(read[:, 1]) > 5.0
    # The plume is computed in other parts, which differ by rounding.
    assert np.allclose(
        during.evaluate(columns.__getitem__, settled_at).columns,
        expected,
        rtol=1e-9,
        atol=1e-9,
        equal_nan=True,
    )


def test_readings_come_within_a_second_and_in_their_order():
    columns, instrument = path(duration=10.0), sniffer("payload.sensor=fast")
    arrived = []
    for i, time in enumerate(columns["time_s"].tolist()):
        sample = (float(columns["altitude_m"][i]), 19.0, 0.0, 0.5)
        arrived += [
            (time, at)
            for at, _ in instrument.follow(
                time, (-200.0, float(columns["east_m"][i]), 0.0, 12.0, 0.0), sample
            )
        ]
    times = [at for _, at in arrived]
    # Ten seconds at the rate of the sensor, but for what is still on its way.
    assert len(times) > 8.0 * instrument.spec.rate_hz
    assert times == sorted(times)
    assert all(0.0 < now - at < 1.0 for now, at in arrived)


@pytest.mark.parametrize(
    ("kind", "expected"), [("sniffer_dead", None), ("sniffer_saturated", 20000.0)]
)
def test_a_sniffer_that_fails_reads_on_without_saying_anything(kind, expected):
    read = followed(sniffer("payload.sensor=fast", f"fault.kind={kind}", "fault.at_s=20"), path())
    good, bad = read[read[:, 0] < 20.0, 1], read[read[:, 0] >= 20.0, 1]
    # 20000 ppm is the end of the fast preset's range; a dead one repeats its last reading.
    assert set(bad.tolist()) == {good[-1] if expected is None else expected}
    assert len(set(good.tolist())) > 20
