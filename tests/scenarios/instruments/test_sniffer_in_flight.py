"""A sniffer that is read in flight reads what it reads after the flight: all gases, and its faults."""

import numpy as np
import pytest
from flight_cases import flown_study

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
CHANNELS = (
    "payload.sensor=fast",
    "payload.channels.ch4={t90_s=1.5,delay_s=0.4,noise=4,gain_sd=0.02,range_high=90000}",
    "payload.channels.bc={t90_s=3,delay_s=0.4,noise=30,gain_sd=0.1}",
    "payload.channels.pn={t90_s=1,delay_s=0.2,noise=500,gain_sd=0.05}",
)
SHIP = (
    "emission.methane_slip_percent=6.4",
    "emission.black_carbon_g_kg=0.3",
    "emission.particle_number_1e15_kg=8",
)


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
        altitude, airspeed, climb = (
            float(columns[name][i]) for name in ("altitude_m", "airspeed_mps", "climb_rate_mps")
        )
        came = instrument.follow(time, motion, (altitude, airspeed, 0.0, climb))
        # Readings come within a second.
        assert all(0.0 <= time - at < 1.0 for at, _ in came)
        read += came
    return np.array(read)


@pytest.mark.parametrize("given", [("payload.sensor=electrochemical",), (*CHANNELS, *SHIP)])
def test_the_same_seed_reads_the_same_in_flight_as_after_it(given):
    columns, settled_at = path(), 1e9
    after, during = sniffer(*given), sniffer(*given)
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
    found = during.evaluate(columns.__getitem__, settled_at).columns
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("kind", "expected"), [("sniffer_dead", None), ("sniffer_saturated", 20000.0)]
)
def test_a_sniffer_that_fails_reads_on_without_saying_anything(kind, expected):
    read = followed(sniffer("payload.sensor=fast", f"fault.kind={kind}", "fault.at_s=20"), path())
    good, bad = read[read[:, 0] < 20.0, 1], read[read[:, 0] >= 20.0, 1]
    # 20000 ppm is the end of the fast preset's range; a dead one repeats its last reading.
    assert set(bad.tolist()) == {good[-1] if expected is None else expected}
    assert len(set(good.tolist())) > 20


EMITTED = {"ch4": (6.4, "percent"), "bc": (0.3, "g_kg"), "pn": (8.0, "1e15_kg")}
"""Per fuel; a slip of 6.4 % is ICCT's mean of four-stroke engines (FUMES, 2024)."""


def columns_of(instrument):
    columns = path()
    found = instrument.evaluate(columns.__getitem__, 1e9).columns
    return dict(zip(instrument.COLUMNS, found.T, strict=True))


def test_gases_disperse_as_co2_does_and_in_the_ratio_of_the_fuel():
    instrument = sniffer(*CHANNELS, *SHIP)
    read = columns_of(instrument)
    excess = read["co2_ppm"] - read["co2_background_ppm"]
    inside = excess > 1.0
    assert inside.sum() > 10
    # Worked by hand, per kg of gas oil: 0.8750 kg of carbon (CO2 of 3.206 kg/kg) are 72.85 mol, and
    # 64 g of methane are 3.989 mol; a mole of air has 23.645 l at 15 deg C.
    co2 = 3.206 / 0.044009 - 0.064 / 0.016043
    expected = {
        "ch4_ppb": (1900.0, 1e3 * (0.064 / 0.016043) / co2),
        "bc_ngm3": (50.0, 0.3e9 / (1e6 * 0.023645 * 3.206 / 0.044009)),
        "pn_cm3": (400.0, 8e15 / (1e12 * 0.023645 * 3.206 / 0.044009)),
    }
    for name, (clean, ratio) in expected.items():
        found = (read[name] - clean)[inside] / excess[inside]
        assert found == pytest.approx(np.full(inside.sum(), ratio), rel=2e-3), name


def test_a_ship_that_emits_none_is_read_as_clean_air_and_other_gases_are_not_moved():
    silent, without = columns_of(sniffer(*CHANNELS)), columns_of(sniffer(CHANNELS[0]))
    assert set(silent["ch4_ppb"]) == {1900.0}
    assert {name for name in silent if name not in without} == {
        f"{gas}_{word}{unit}"
        for gas, unit in (("ch4", "ppb"), ("bc", "ngm3"), ("pn", "cm3"))
        for word in ("", "reading_")
    }
    for name in ("so2_ppb", "co2_ppm", "no_ppb", "no2_ppb"):
        assert np.array_equal(silent[name], without[name]), name


@pytest.mark.parametrize(("kind", "expected"), [("sniffer_dead", None), ("sniffer_saturated", 9e4)])
def test_a_fault_of_the_sniffer_is_one_of_each_channel(kind, expected):
    read = columns_of(sniffer(*CHANNELS, *SHIP, f"fault.kind={kind}", "fault.at_s=20"))
    failed = read["ch4_reading_ppb"][path()["time_s"] > 21.0]
    assert len(set(failed)) == 1
    assert expected is None or failed[0] == expected


@pytest.mark.slow
def test_a_flight_reads_back_what_the_ship_emits():
    keys = (*CHANNELS, *SHIP, "payload.exact=true", "flight.duration_max_s=900")
    row = flown_study("sulphur", *QUICK, *keys, "flight.after_settling_s=200").row
    for gas, (emitted, end) in EMITTED.items():
        assert row[f"{gas}_emitted_{end}"] == emitted
        assert row[f"{gas}_quality"] == "A"
        assert row[f"{gas}_low_{end}"] < emitted < row[f"{gas}_high_{end}"]
        # Noise is far below the gains, which are stated to 2, 10 and 5 %.
        assert row[f"{gas}_uncertainty_{end}"] < 0.15 * emitted
    # Carbon that leaves as methane is missing in the CO2: a perfect instrument reads more sulphur.
    carbon = 3.206 * 12.011 / 44.009
    burnt = carbon - 0.064 * 12.011 / 16.043
    perfect = 0.1 * 0.97753 * 0.87 / burnt
    assert row["fsc_expected_percent"] == pytest.approx(perfect, rel=1e-4)
