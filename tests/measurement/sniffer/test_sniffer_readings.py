"""What a sniffer reads: gains, other gases, pressure, noise, drift, range; presets; instruments of
one flight; bad figures.
"""

import math

import numpy as np
import pytest
from crossings import BACKGROUND, plain_sniffer, read, sniffer_of

from measurement.errors import MeasurementError
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Sniffer
from measurement.sniffer.spec import sensor_of, sensor_preset, sensor_presets

STILL = np.tile(BACKGROUND, (20_001, 1))


def test_a_steady_reading_is_gain_times_air_and_other_gases_with_pressure_and_zero():
    so2 = Channel(
        gas="so2",
        t90_s=5.0,
        noise=0.0,
        gain=1.1,
        zero=-2.0,
        cross={"no": 0.015, "no2": -1.6},
        pressure_effect=0.0015,
    )
    air = np.array([[30.0, 420.0, 1000.0, 50.0]] * 3)
    sniffer = Sniffer(sniffer_of(so2), generator=np.random.default_rng(0), time_step=1.0)
    reading = sniffer.advance(air, np.full(3, 2.0)).values
    # gain (c + sum k c) (1 + 0.15 %/hPa 2 hPa) + zero, as Channel says.
    np.testing.assert_allclose(reading[:, 0], 1.1 * (30.0 + 15.0 - 80.0) * 1.003 - 2.0, rtol=1e-12)
    assert np.isnan(reading[:, 1:]).all()


def test_noise_and_drift_have_the_size_that_is_stated():
    reading = read(sniffer_of(Channel(gas="so2", t90_s=5.0, noise=2.5)), STILL, step=1.0).values[
        :, 0
    ]
    # 20,000 readings: the standard deviation is known to 0.5 %; four times that.
    assert np.std(reading) == pytest.approx(2.5, rel=0.02)
    walks = [
        read(
            sniffer_of(Channel(gas="so2", t90_s=5.0, noise=0.0, random_walk=0.5), rate_hz=4.0),
            STILL[:401],
            seed=i,
            step=0.25,
        )
        for i in range(400)
    ]
    ends = np.array([walk.values[-1, 0] for walk in walks])
    # After 100 s a walk of 0.5 per root second is 5; 400 walks give 3.5 %, three times that.
    assert np.std(ends) == pytest.approx(5.0, rel=0.11)


def test_readings_are_rounded_and_cut_at_the_range():
    air = np.tile(BACKGROUND, (50, 1))
    air[:, 0] = np.linspace(-20.0, 60.0, 50)
    limits = {"resolution": 0.5, "range_low": -5.0, "range_high": 40.0}
    so2 = Channel(gas="so2", t90_s=1e-3, noise=0.0, **limits)
    reading = read(sniffer_of(so2), air, step=1.0).values[:, 0]
    assert (reading.min(), reading.max()) == (-5.0, 40.0)
    assert np.all(reading % 0.5 == 0.0)


def test_instruments_of_one_flight_scatter_as_the_analyst_knows_them():
    spec = sensor_preset("electrochemical")
    drawn = [spec.drawn(np.random.default_rng(i)).known("so2") for i in range(2000)]
    # 2000 draws know a standard deviation to 1.6 %; four times that.
    for name, sd in (("gain", 0.03), ("t90_s", 1.0), ("delay_s", 0.3), ("zero", 5.0)):
        assert np.std([getattr(channel, name) for channel in drawn]) == pytest.approx(
            sd, rel=0.065
        ), name
    assert np.std([channel.cross["no2"] for channel in drawn]) == pytest.approx(0.032, rel=0.065)
    assert np.mean([channel.cross["no2"] for channel in drawn]) == pytest.approx(
        -0.16, abs=4.0 * 0.032 / math.sqrt(2000)
    )
    assert drawn[0].gain_sd == drawn[0].t90_sd == drawn[0].delay_sd_s == 0.0
    assert spec.drawn(np.random.default_rng(7)) == spec.drawn(np.random.default_rng(7))


def test_every_preset_has_the_figures_of_its_source():
    # Data sheets of Alphasense's SO2-A4 and SO2-B4: t90 < 20 s and < 30 s, noise 15 and 5 ppb at
    # two standard deviations, NO2 < -160 %, NO < -1.5 % and < -2 %.
    for name, t90, noise, no in (
        ("alphasense_a4", 20.0, 7.5, -0.015),
        ("alphasense_b4", 30.0, 2.5, -0.02),
    ):
        so2 = sensor_preset(name).known("so2")
        assert (so2.t90_s, so2.noise, so2.cross) == (t90, noise, {"no": no, "no2": -1.6})
    for name in sensor_presets():
        spec = sensor_preset(name)
        assert {"so2", "co2"} <= set(spec.gases)
        assert spec.source
    # What a table leaves out is not known, also what else SO2 responds to.
    table = sensor_of({"channels": {"so2": {}, "co2": {"t90_s": 2.0}}}, "x")
    so2 = table.known("so2")
    assert math.isinf(so2.t90_sd)
    assert math.isnan(so2.noise)
    assert so2.cross_sd == sensor_preset("unspecified").known("so2").cross_sd
    assert table.known("co2").t90_sd == 0.1
    for cross, deviation in (({"no2": -0.16}, {"no2": pytest.approx(0.032)}), ({}, {})):
        stated = sensor_of({"channels": {"so2": {"cross": cross}}}, "x").known("so2")
        assert stated.cross_sd == deviation


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"t90_s": 0.0}, "t90 is 0 s; it must be positive"),
        ({"t90_s": math.inf}, "t90 is inf s"),
        ({"second_pole": 1.0}, "second_pole is 1; it must be 0 to 0.95"),
        ({"noise": -1.0}, "noise of so2 is -1 ppb"),
        ({"gain": 0.0}, "gain of so2 is 0; it must be 0.1 to 10"),
        ({"delay_s": -1.0}, "delay_s of so2 is -1"),
        ({"gain_sd": math.inf}, "gain_sd of so2 is inf"),
        (
            {"gas": "co2", "t90_sd": math.inf},
            "t90_sd of co2 is inf; .* t90 and delay of SO2 alone can be estimated from a record",
        ),
        ({"range_low": 5.0, "range_high": 5.0}, "range of so2 is 5 to 5"),
        ({"cross": {"so2": 0.1}}, "cross of so2 names 'so2'"),
        ({"cross": {"co": 0.1}}, "cross of so2 names 'co'"),
        ({"cross": {"no": 60.0}}, "cross of so2 to no is 60"),
        ({"pressure_effect": 1.0}, "pressure_effect of so2 is 1 1/hPa; it must be -0.1 to 0.1"),
        ({"gas": "o3"}, "gas is 'o3'; it must be one of so2, co2, no, no2"),
    ],
)
def test_figures_out_of_range_are_refused_in_one_line(fields, message):
    with pytest.raises(MeasurementError, match=message) as caught:
        Channel(**{"gas": "so2", "t90_s": 5.0, "noise": 1.0, **fields})
    assert "\n" not in str(caught.value)


SO2 = Channel(gas="so2", t90_s=5.0, noise=1.0)
STILL_AIR = Sniffer(plain_sniffer(), generator=np.random.default_rng(0), time_step=0.1)


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (lambda: sniffer_of(SO2, SO2), "one per gas at most"),
        (lambda: sniffer_of(SO2, rate_hz=0.0), "rate of 'test' is 0 Hz"),
        (lambda: sensor_preset("nose"), "instrument is 'nose'; there are alphasense_a4"),
        (
            lambda: sensor_preset("unspecified").drawn(np.random.default_rng(0)),
            "give its t90_s, delay_s and noise to fly it",
        ),
        (lambda: plain_sniffer().known("no"), "'test' has no NO channel; it has so2, co2"),
        (lambda: STILL_AIR.advance(np.full((3, 4), np.nan)), "concentration"),
        (lambda: STILL_AIR.advance(np.zeros((3, 3))), "concentration"),
        (
            lambda: Sniffer(plain_sniffer(), generator=np.random.default_rng(0), time_step=2.0),
            r"time step is 2 s; .* record the air more often",
        ),
        (lambda: sensor_of({}, "x"), "has no channels"),
        (lambda: sensor_of({"channels": {"so2": {}}, "colour": 1}, "x"), "has the key 'colour'"),
        (lambda: sensor_of({"channels": {"ozone": {}}}, "x"), "channel 'ozone' of instrument 'x'"),
        (lambda: sensor_of({"channels": {"so2": {"t80_s": 1}}}, "x"), "has the key 't80_s'"),
        (lambda: sensor_of({"channels": {"so2": {"t90_s": "fast"}}}, "x"), "must be a number"),
        (lambda: sensor_of({"channels": {"so2": {"cross": 0.1}}}, "x"), "must be a table"),
        (lambda: sensor_of({"rate_hz": True, "channels": {"so2": {}}}, "x"), "rate_hz of x is"),
    ],
)
def test_sniffers_and_air_that_cannot_be_are_refused(refused, message):
    with pytest.raises(MeasurementError, match=message):
        refused()
