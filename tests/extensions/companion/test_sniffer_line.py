"""Readings of a sniffer on board: lines, and their way to the estimator and the verdict."""

import math
import socket

import numpy as np
import pandas as pd
import pytest

from extensions.companion.ports import opened
from extensions.companion.sniffer_line import ReceivedSniffer, reading_line, reading_of
from scenarios.scenario.files import load_study
from tests.extensions.companion.served import companion, free_port, served


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("0.5,12.5,421,,", (0.5, [12.5, 421.0, math.nan, math.nan])),
        (",12.5,421", (0.0, [12.5, 421.0, math.nan, math.nan])),
        ("0,,421,3,4", (0.0, [math.nan, 421.0, 3.0, 4.0])),
    ],
)
def test_a_line_is_a_reading(line, found):
    age, values = reading_of(line)
    assert age == found[0]
    assert values == pytest.approx(found[1], nan_ok=True)


@pytest.mark.parametrize(
    "line",
    ["age_s,so2_ppb,co2_ppm", "", "3", "0,1,2,3,4,5", "-1,2,3", "inf,2,3", "0,inf,3", "0;1;2"],
)
def test_other_lines_are_none(line):
    assert reading_of(line) is None


def test_what_is_written_is_read():
    values = [12.345, 412.5, math.nan, 3.25]
    age, read = reading_of(reading_line(0.25, values).decode())
    assert (age, read) == (0.25, pytest.approx(values, nan_ok=True))


def test_readings_have_the_time_at_which_they_were_true(tmp_path):
    scenario = load_study("sulphur", [])
    address = f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}"
    line = opened("--sniffer", f"udpin://{address}", listening=False)
    sender = opened("--sniffer", f"udp://{address}", listening=False)
    try:
        sniffer = ReceivedSniffer(line, scenario)
        (peer,) = sender.connected()
        for text in (b"age_s,so2_ppb,co2_ppm\n0.5,10,450\n0.25,11,", b"460\nrubbish\n0.3,1,1\n"):
            sender.send(text, peer)
            sniffer.receive(20.0)
        # Of 19.7 s, when 19.75 s is there already, and the header and the rubbish.
        assert sniffer.unreadable == 3
        read = sniffer.readings(0.0)
        assert read.time.tolist() == [19.5, 19.75]
        assert read.values[:, :2].tolist() == [[10.0, 450.0], [11.0, 460.0]]
        assert list(sniffer.follow(19.6, None, ())) == [(19.5, 450.0)]
        assert list(sniffer.follow(20.0, None, ())) == [(19.75, 460.0)]
        found = sniffer.evaluate(lambda _: np.array([19.0, 19.5, 19.7, 19.8]), 30.0)
        assert found.columns[:, 1] == pytest.approx([math.nan, 450.0, 450.0, 460.0], nan_ok=True)
    finally:
        line.close()
        sender.close()


@pytest.mark.slow
def test_readings_of_a_vehicle_reach_estimate_and_verdict(tmp_path):
    settings = ("fidelity=kinematic", "reports.interval_s=[2,2]", "flight.after_settling_s=60",
                "guidance.rate_hz=10", "flight.until=verdict")  # fmt: skip
    address = f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}"
    with served("sulphur", *settings, sniffer=f"udp://{address}") as vehicle:
        ended = companion(vehicle, "sulphur", tmp_path / "run", "--lockstep", "--no-report",
                          "--sniffer", f"udpin://{address}", settings=settings)  # fmt: skip
    assert ended.status in (0, 1), ended
    row = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]
    # The scenario's fuel has 0.1 %; an electrochemical sniffer is true to some 0.03 % after minutes.
    assert row["fsc_percent"] == pytest.approx(0.1, abs=4.0 * row["fsc_uncertainty_percent"])
    assert row["sulphur_verdict"] in ("above", "below", "open")
    assert row["verdict_looks"] > 0
