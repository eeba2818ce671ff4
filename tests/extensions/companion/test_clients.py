"""Programs of others on the link: mavutil as a ground station, and mavlogdump on telemetry logs."""

import json
import math
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.extensions.companion.served import companion, served

pytestmark = pytest.mark.slow

FLIGHT = ("comparison.nu=[]", "sweep.nu=[0.5]", "fidelity=kinematic", "flight.crossings=2")

PATIENCE = 60.0
"""Longest wait for an answer of a vehicle whose clock waits [s]."""


class GroundStation:
    """A client by mavutil, which sets the clock of a vehicle in lockstep.

    Attributes
    ----------
    messages : that it has read
    """

    def __init__(self, url):
        address = "tcp:" + url.removeprefix("tcp://")
        self.link = mavutil.mavlink_connection(
            address,
            source_system=255,
            source_component=mavlink.MAV_COMP_ID_ONBOARD_COMPUTER,
            dialect="ardupilotmega",
        )
        self.messages, self._request = [], 0

    def close(self):
        self.link.close()

    def advance(self, seconds):
        """Have the clock go on to a time [s], and read everything up to then."""
        self._request += 1
        self.link.mav.system_time_send(self._request, round(1e3 * seconds))
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            message = self.link.recv_match(blocking=True, timeout=1.0)
            if message is None:
                continue
            self.messages.append(message)
            kind = message.get_type()
            if kind == "SYSTEM_TIME" and message.time_unix_usec == self._request:
                return
        pytest.fail(f"the vehicle did not come to {seconds} s")

    def kinds(self):
        return {message.get_type() for message in self.messages}

    def last(self, kind):
        return [message for message in self.messages if message.get_type() == kind][-1]


def test_mavutil_reads_every_message_that_the_vehicle_sends():
    with served("sim3", *FLIGHT) as vehicle, closing(GroundStation(vehicle.url)) as station:
        link = station.link
        station.advance(2.0)
        assert (link.target_system, link.flightmode) == (1, "GUIDED")
        link.param_fetch_all()
        link.mav.timesync_send(0, 123)
        link.mav.mission_request_list_send(1, 1)
        asked = mavlink.MAV_CMD_REQUEST_MESSAGE
        link.mav.command_long_send(
            1, 1, asked, 0, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION, 0, 0, 0, 0, 0, 0
        )
        link.set_mode("LOITER")
        station.advance(5.0)
        assert link.flightmode == "LOITER"
        assert link.params["ROLL_LIMIT_DEG"] > 0.0
        here, state = station.last("GLOBAL_POSITION_INT"), vehicle.simulation.state()
        # In 1e-7 deg, and up to 0.25 s old at 20 m/s.
        assert 1e-7 * here.lat == pytest.approx(math.degrees(state.latitude), abs=1e-4)
        assert station.last("TIMESYNC").ts1 == 123
    assert station.kinds() == {
        "HEARTBEAT", "SYS_STATUS", "GPS_RAW_INT", "WIND", "SYSTEM_TIME", "ATTITUDE", "VFR_HUD",
        "GLOBAL_POSITION_INT", "AIS_VESSEL", "ADSB_VEHICLE", "STATUSTEXT", "COMMAND_ACK",
        "PARAM_VALUE", "AUTOPILOT_VERSION", "MISSION_COUNT", "TIMESYNC",
    }  # fmt: skip


def dumped(path):
    """Return the messages of a log as mavlogdump reads it: types, and times since 1970 [s]."""
    program = Path(sys.executable).with_name("mavlogdump.py")
    ended = subprocess.run(
        [sys.executable, program, "--format", "json", path],
        check=False,
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr
    read = [json.loads(line) for line in ended.stdout.splitlines() if line.startswith("{")]
    return [each["meta"]["type"] for each in read], [each["meta"]["timestamp"] for each in read]


def test_the_logs_of_both_sides_are_read_by_mavlogdump(tmp_path):
    began = time.time()
    logs = {side: tmp_path / f"{side}.tlog" for side in ("vehicle", "companion")}
    with served("sim3", *FLIGHT, log=logs["vehicle"]) as vehicle:
        ended = companion(vehicle, "sim3", tmp_path / "run", "--lockstep", "--no-report", "--log",
                          logs["companion"], settings=FLIGHT)  # fmt: skip
    assert ended.status == 0, ended
    read = {side: dumped(path) for side, path in logs.items()}
    for kinds, times in read.values():
        # Of both directions.
        assert {"HEARTBEAT", "GLOBAL_POSITION_INT", "SET_ATTITUDE_TARGET", "COMMAND_INT"} <= set(
            kinds
        )
        assert not {kind for kind in kinds if kind.startswith(("BAD", "UNKNOWN"))}
        assert times == sorted(times)
        assert began - 1.0 <= times[0] <= times[-1] <= time.time() + 1.0
    # What one side sends the other one reads.
    for kind in ("SET_ATTITUDE_TARGET", "GLOBAL_POSITION_INT"):
        assert read["vehicle"][0].count(kind) == read["companion"][0].count(kind) > 100
