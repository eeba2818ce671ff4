"""Ends of a record and of its parts, where channels of different delays have not all read the same
air.
"""

import math

import numpy as np
import pytest
from crossings import BACKGROUND, changed, crossings, plain_sniffer, read, sniffer_of

from measurement.estimate.estimator import estimate, over_time
from measurement.estimate.record import checked_record
from measurement.estimate.signals import make_signals
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings

pytestmark = pytest.mark.slow

NOT_STATED = {"t90_sd": math.inf, "delay_sd_s": math.inf}


def late(fsc, delay, duration):
    """Return a sniffer whose SO2 comes so late [s], and the air of passes every 12 s."""
    spec = plain_sniffer(3.0, 2.0, so2_noise=1.0, co2_noise=0.5, delay_s=delay)
    return spec, crossings(fsc, duration=duration, interval=12.0, meander=0.3, width=1.0, first=4.0)


def test_where_the_background_explains_all_that_is_known_there_is_no_result():
    # Of parts of 32 s a channel that is 32 s late leaves less than the background takes up: 0 % was
    # found, "below", quality A.
    spec = sniffer_of(
        Channel(gas="so2", t90_s=4.0, noise=0.5),
        Channel(gas="co2", t90_s=3.0, noise=0.5, delay_s=32.0),
    )
    readings = read(
        spec, crossings(0.25, duration=600.0, interval=34.0, meander=0.0, width=2.0), seed=1
    )
    inside = readings.time % 34.0 < 31.5
    found = estimate(Readings(readings.time[inside], readings.values[inside]), spec)
    assert math.isnan(found.fsc_percent)
    assert found.quality == "C"


def test_a_gas_that_comes_later_takes_samples_away_only_where_it_corrects_so2():
    plain, corrected = (
        sniffer_of(
            Channel(gas="so2", t90_s=15.0, noise=1.0, cross=cross),
            Channel(gas="co2", t90_s=3.0, noise=0.5),
            Channel(gas="no", t90_s=5.0, noise=5.0, delay_s=60.0),
        )
        for cross in ({}, {"no": 0.01})
    )
    air = crossings(0.25, duration=300.0, interval=30.0, meander=0.0, width=2.0)
    record = checked_record(read(plain, air), plain)
    assert make_signals(record, plain).known.all()
    assert np.count_nonzero(make_signals(record, corrected).known == 0.0) == 60
    # Ten passes, of which two are before NO has its first or after the last reading that it is for.
    found = estimate(read(corrected, air), corrected)
    assert len(found.pass_percent) == len(found.pass_deviation_percent) >= 6
    assert np.array(found.pass_percent) == pytest.approx(0.25, rel=0.1)
    assert not math.isnan(found.agreement)


@pytest.mark.parametrize(
    ("fsc", "delay", "verdicts"),
    [
        # Of 0.25 % the first 25 s were "below", quality B, before its SO2 had arrived.
        (0.25, 25.0, ["open", "open", "open", "above"]),
        (0.25, 3.0, ["above", "above", "above", "above"]),
        # Of a clean fuel nothing arrives: half of the CO2 must be older than any delay.
        (0.0, 3.0, ["open", "open", "open", "below"]),
    ],
)
def test_without_a_stated_delay_no_fuel_is_below_a_limit_before_its_so2_can_have_arrived(
    fsc, delay, verdicts
):
    spec, air = late(fsc, delay, 90.0)
    readings, unknown = read(spec, air), changed(spec, "so2", **NOT_STATED)
    table = over_time(readings, unknown, elapsed_s=(15, 20, 25, 90))
    assert table["verdict_0.1"].tolist() == verdicts


def test_so2_that_may_have_come_in_a_gap_is_waited_for():
    # Two passes, then a gap in which the SO2 came, and five minutes of clean air: 0.25 % was
    # "below", quality B.
    spec, passes = late(0.25, 25.0, 22.0)
    readings = read(spec, np.vstack([passes, np.tile(BACKGROUND, (3230, 1))]), seed=1)
    kept = (readings.time < 22.0) | (readings.time > 51.0)
    unknown = changed(spec, "so2", **NOT_STATED)
    found = estimate(Readings(readings.time[kept], readings.values[kept]), unknown)
    assert [verdict.verdict for verdict in found.verdicts] == ["open", "open"]
