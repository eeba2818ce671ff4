"""Flights over the link beside those of the study: the same where the link is perfect, and what
becomes of one whose link, pilot or vehicle is not.
"""

import math
import re
import signal
import subprocess
import sys

import pandas as pd
import pytest

from extensions.companion.plane import PlaneMode
from tests.extensions.companion.served import HOME, companion, served
from tests.in_process import assert_refused, run_command

pytestmark = pytest.mark.slow

STEADY = ("comparison.nu=[]", "sweep.nu=[0.5]", "flight.crossings=8")
KINEMATIC = (*STEADY, "fidelity=kinematic")


def row(out):
    return pd.read_csv(out / "summary.csv").iloc[0]


@pytest.fixture(scope="module")
def perfect(tmp_path_factory):
    """A flight of the JSBSim aircraft over a perfect link, in lockstep."""
    out = tmp_path_factory.mktemp("perfect") / "run"
    with served("sim3", *STEADY) as vehicle:
        ended = companion(vehicle, "sim3", out, "--lockstep", settings=STEADY)
    assert ended.status == 0, ended
    return out, vehicle


@pytest.fixture(scope="module")
def flown_in_study(tmp_path_factory):
    """The same flight in the study."""
    out = tmp_path_factory.mktemp("study") / "run"
    keys = [word for key in STEADY for word in ("--set", key)]
    run_command("scenarios.run", "sim3", "--out", out, "--no-report", "--jobs", "1", *keys)
    return out


def test_a_perfect_link_flies_the_flight_of_the_study(perfect, flown_in_study):
    out, _ = perfect
    linked, flown = row(out), row(flown_in_study)
    # The study hands the guidance exact numbers; telemetry has a place in steps of 11 mm, velocities
    # in steps of 1 cm/s, and the rate of yaw in place of that of the course. Of the issue: 2 % and
    # 2 m. Measured over 30 crossings: 0.01 ms in the mean interval, 6 mm in the error.
    interval = "crossing_interval_mean_s"
    assert linked[interval] == pytest.approx(flown[interval], rel=1e-4)
    assert linked["tracking_error_rms_m"] == pytest.approx(flown["tracking_error_rms_m"], abs=0.05)
    assert linked["min_distance_m"] == pytest.approx(flown["min_distance_m"], abs=0.1)
    crossed = [pd.read_csv(of / "crossings.csv") for of in (out, flown_in_study)]
    for column, tolerance in (("time_s", 0.01), ("distance_m", 0.3), ("angle_deg", 0.5)):
        assert crossed[0][column].to_numpy() == pytest.approx(crossed[1][column], abs=tolerance)


def test_nothing_is_armed_and_no_mode_is_changed(perfect):
    _, vehicle = perfect
    kinds = {message.get_type() for _, message in vehicle.heard}
    assert "SET_MODE" not in kinds
    commands = {
        m.command for _, m in vehicle.heard if m.get_type() in ("COMMAND_INT", "COMMAND_LONG")
    }
    # Intervals of messages, place to retreat to, airspeed, altitude.
    assert commands <= {511, 192, 43000, 43001}
    assert not [m for _, m in vehicle.heard if m.get_type() == "COMMAND_INT" and m.command == 192
                and int(m.param2)]  # fmt: skip


@pytest.mark.parametrize("link", ["", "latency=0.2,jitter=0.05,loss=0.05"])
def test_a_course_link_flies_it_as_well(tmp_path, link):
    with served("sim3", *KINEMATIC) as vehicle:
        ended = companion(vehicle, "sim3", tmp_path / "run", "--lockstep", "--by", "course",
                          "--link", link, "--simulate-link", "1", "--no-report",
                          settings=KINEMATIC)  # fmt: skip
    assert ended.status == 0, ended
    assert vehicle.count("SET_ATTITUDE_TARGET") == 0
    assert row(tmp_path / "run")["outcome"] == "completed"
    # The paper's 9.5 s; the orbit touches r_min, from which the lag of a course takes metres. The
    # limit is that of the scenario's criterion.
    assert row(tmp_path / "run")["tracking_error_rms_m"] < 1.5
    assert row(tmp_path / "run")["crossing_interval_mean_s"] == pytest.approx(9.5, abs=0.1)
    # A heading is sticky, and a place to retreat to would end it: there is one at the end alone.
    over = max(at for at, m in vehicle.heard if is_command(m, 43002))
    assert all(at >= over for at, m in vehicle.heard if is_command(m, 192))
    assert vehicle.count("COMMAND_INT", after=over) > 0


def is_command(message, number):
    return message.get_type() == "COMMAND_INT" and message.command == number


REPORTED = ("reports.interval_s=[10,10]", "flight.crossings=4", "fidelity=kinematic", "flights=1",
            "vessel.speed_mps=5", "wind.speed_mps=5", "wind.from_deg=20", "draws=[]",
            "guidance.rate_hz=10")  # fmt: skip
"""A vessel that is known by its reports, with a margin for their errors."""


class ClosestApproach:
    """Notes when a vehicle has passed its first closest approach within 400 m, and acts then.

    Attributes
    ----------
    at : when that was, infinite before [s]
    """

    def __init__(self, act=lambda _: None):
        self.at, self._act = math.inf, act

    def __call__(self, simulation):
        # The distance has grown again since the last step.
        grown = simulation.closest_at < simulation.time - 1e-6
        if self.at == math.inf and simulation.closest < 400.0 and grown:
            self.at = simulation.time
            self._act(simulation)


def afterwards(simulation, seconds=180.0):
    """Fly on without commands; return the least distance of the whole flight [m]."""
    for _ in range(round(seconds / simulation.plane.time_step)):
        simulation.step()
    return simulation.closest


def test_telemetry_that_is_silent_at_the_closest_approach_ends_outside(tmp_path):
    approach, now = ClosestApproach(), [0.0]

    def at_step(simulation):
        now[0] = simulation.time
        approach(simulation)

    def change(message):
        return None if approach.at <= now[0] < approach.at + 30.0 else message

    with served("sea_wind", *REPORTED, at_step=at_step, change=change) as vehicle:
        ended = companion(vehicle, "sea_wind", tmp_path / "run", "--lockstep", "--no-report",
                          settings=REPORTED)  # fmt: skip
        simulation = vehicle.simulation
        assert simulation.closest_at == pytest.approx(approach.at, abs=0.1)
        assert afterwards(simulation) > 200.0
        assert simulation.plane.mode is PlaneMode.GUIDED
    # A second, and up to two steps of 0.1 s.
    assert re.search(r"given back: telemetry was silent for 1\.[0-2] s", ended.out)


def test_a_companion_that_is_killed_at_the_closest_approach_leaves_the_vehicle_outside(tmp_path):
    """The last roll is flown for GUIDED_TIMEOUT, which is in the margin where it is declared."""
    processes = []
    approach = ClosestApproach(lambda _: processes[0].kill())
    with served("sea_wind", *REPORTED, at_step=approach) as vehicle:
        keys = [word for key in REPORTED for word in ("--set", key)]
        program = "import sys; from scenarios.cli.main import main; sys.exit(main())"
        processes.append(
            subprocess.Popen(
                [sys.executable, "-c", program, "companion", "sea_wind", "--connect", vehicle.url,
                 "--out", str(tmp_path / "run"), "--lockstep", "--link", "silence=3", *keys],
                stdout=subprocess.DEVNULL,
            )
        )  # fmt: skip
        assert processes[0].wait() == -signal.SIGKILL
        simulation = vehicle.simulation
        assert afterwards(simulation) > 200.0
        assert simulation.plane.mode is PlaneMode.GUIDED
    last = max(at for at, message in vehicle.heard if message.get_type() == "SET_ATTITUDE_TARGET")
    assert last <= approach.at


def test_a_pilot_who_takes_the_mode_at_the_closest_approach_is_outside(tmp_path):
    approach = ClosestApproach(lambda simulation: simulation.plane.set_mode(PlaneMode.LOITER))
    with served("sea_wind", *REPORTED, at_step=approach) as vehicle:
        ended = companion(vehicle, "sea_wind", tmp_path / "run", "--lockstep", "--no-report",
                          settings=REPORTED)  # fmt: skip
        simulation = vehicle.simulation
        assert simulation.plane.mode is PlaneMode.LOITER
        # The vehicle loiters where the pilot took it; where the vessel goes then is the pilot's.
        assert afterwards(simulation, 10.0) > 200.0
    assert "given back: the pilot took over (mode LOITER)" in ended.out


def test_a_vehicle_that_restarts_gets_no_command(tmp_path):
    def change(message):
        if message.get_type() == "GLOBAL_POSITION_INT" and message.time_boot_ms > 20000:
            message.time_boot_ms = 50
        return message

    with served("sim3", *KINEMATIC, change=change) as vehicle:
        ended = companion(vehicle, "sim3", tmp_path / "run", "--lockstep", "--no-report",
                          settings=KINEMATIC)  # fmt: skip
    assert "given back: the vehicle's clock jumped: it was restarted" in ended.out
    assert vehicle.count("SET_ATTITUDE_TARGET", after=20.2) == 0


def test_a_bad_link_is_reckoned_with(tmp_path):
    link = "latency=0.2,jitter=0.05,loss=0.05"
    settings = ("reports.interval_s=[10,10]", "flight.crossings=4", "fidelity=kinematic", "flights=1",
                "vessel.speed_mps=5", "wind.speed_mps=5", "wind.from_deg=20", "draws=[]",
                "guidance.rate_hz=10")  # fmt: skip
    margins, closest = [], []
    for declared in ("", link):
        out = tmp_path / ((declared and "bad") or "perfect")
        with served("sea_wind", *settings) as vehicle:
            ended = companion(vehicle, "sea_wind", out, "--lockstep", "--no-report", "--link", declared,
                              "--simulate-link", "1", settings=settings)  # fmt: skip
        assert ended.status == 0, ended
        margins.append(row(out)["keepout_margin_m"])
        closest.append(vehicle.simulation.closest)
    # A dead time of 0.475 s at 19.42 m/s alone is 9 m, on the way in and out of a turn less.
    assert margins[1] > margins[0] + 3.0
    assert min(closest) > 200.0


def test_a_vehicle_that_does_not_follow_is_given_back_and_not_flown_into_the_sea(tmp_path):
    def deaf(simulation):
        simulation.plane.set_attitude = lambda _: None

    with served("sea_wind", *REPORTED, at_step=ClosestApproach(deaf)) as vehicle:
        ended = companion(vehicle, "sea_wind", tmp_path / "run", "--lockstep", "--no-report",
                          settings=REPORTED)  # fmt: skip
        assert afterwards(vehicle.simulation, 30.0) > 200.0
    assert "given back: control lost" in ended.out
    assert row(tmp_path / "run")["message"].startswith("control lost, by the heading rate at ")
    assert row(tmp_path / "run")["outcome"] == "not_settled"
    heights = [m.z for _, m in vehicle.heard if is_command(m, 43001) or is_command(m, 192)]
    assert heights
    assert min(heights) > 50.0


HULL = ("vessel.length_m=300", "vessel.beam_m=40", "vessel.stack_from_bow_m=250",
        "vessel.antenna_from_bow_m=30")  # fmt: skip


def test_the_flight_is_about_the_funnel_of_a_ship_whose_antenna_is_far_ahead(tmp_path):
    settings = (*REPORTED, *HULL)
    told = []

    def change(message):
        told.append(message)
        return message

    with served("sea_wind", *settings, change=change) as vehicle:
        ended = companion(vehicle, "sea_wind", tmp_path / "run", "--lockstep", "--no-report",
                          settings=settings)  # fmt: skip
    assert ended.status == 0, ended
    # The simulation measures from the funnel, which is 220 m behind the place that is reported.
    assert vehicle.simulation.closest > 200.0
    # Reports of 5 m and 0.15 m/s, one sigma of a coordinate, up to 10 s old.
    recorded = row(tmp_path / "run")["min_distance_m"]
    assert recorded == pytest.approx(vehicle.simulation.closest, abs=30.0)
    first = next(message for message in told if message.get_type() == "AIS_VESSEL")
    metres_per_degree = 111_195.0
    # The vessel goes north, and its funnel begins at the scenario's origin.
    ahead = metres_per_degree * (1e-7 * first.lat - math.degrees(HOME[0]))
    assert ahead == pytest.approx(220.0, abs=25.0)


def test_a_ship_whose_antenna_is_elsewhere_than_the_scenario_says_is_refused(tmp_path):
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    def change(message):
        if message.get_type() == "AIS_VESSEL":
            message.flags |= mavlink.AIS_FLAGS_VALID_DIMENSIONS
            message.dimension_bow, message.dimension_stern = 200, 100
            message.dimension_port, message.dimension_starboard = 20, 20
        return message

    settings = (*REPORTED, *HULL)
    with served("sea_wind", *settings, change=change) as vehicle:
        ended = companion(vehicle, "sea_wind", tmp_path / "run", "--lockstep", "--no-report",
                          settings=settings)  # fmt: skip
    assert ended.status == 1, ended
    assert "antenna is 200 m from the bow" in row(tmp_path / "run")["message"]
    assert vehicle.count("SET_ATTITUDE_TARGET") == 0


def refused(tmp_path, *words, settings=KINEMATIC, options=(), **vehicle):
    with served("sim3", *settings, **vehicle) as told:
        ended = companion(told, "sim3", tmp_path / "run", "--lockstep", "--no-report", "--wait", "3",
                          *options, settings=settings)  # fmt: skip
    assert_refused(ended, *words)
    assert told.count("SET_ATTITUDE_TARGET") == 0


def test_limits_that_do_not_fit_are_refused(tmp_path):
    roll = {"ROLL_LIMIT_DEG": 30.0}
    refused(tmp_path, "ROLL_LIMIT_DEG is 30.0 deg", "bank_deg", parameters=roll)
    refused(tmp_path / "airspeed", "AIRSPEED_MAX", parameters={"AIRSPEED_MAX": 20.0})


def test_another_type_of_vehicle_is_refused(tmp_path):
    def copter(message):
        if message.get_type() == "HEARTBEAT":
            message.type = 2
        return message

    refused(tmp_path, "MAV_TYPE 2", change=copter)

    def px4(message):
        if message.get_type() == "HEARTBEAT":
            message.autopilot = 12
        return message

    refused(tmp_path / "other", "MAV_AUTOPILOT 12", change=px4)


def test_simulated_parts_are_refused(tmp_path):
    faults = ("sea_wind", "wind.from_deg=20", "wind.speed_mps=5", "vessel.speed_mps=5", "draws=[]",
              "flights=1", "fidelity=kinematic")  # fmt: skip
    scenario, *settings = faults
    with served(scenario, *settings) as vehicle:
        ended = companion(vehicle, scenario, tmp_path / "run", "--lockstep", settings=settings)
    assert_refused(ended, "knows the vessel exactly", "reports.interval_s")


def failed(tmp_path, *words, **vehicle):
    """Fly, and have the flight end before it began."""
    with served("sim3", *KINEMATIC, **vehicle) as told:
        ended = companion(told, "sim3", tmp_path / "run", "--lockstep", "--no-report", "--wait", "3",
                          settings=KINEMATIC)  # fmt: skip
    assert ended.status == 1, ended
    for word in words:
        assert word in row(tmp_path / "run")["message"]
    assert told.count("SET_ATTITUDE_TARGET") == 0


def test_a_place_of_zero_is_none(tmp_path):
    def nowhere(message):
        if message.get_type() == "GLOBAL_POSITION_INT":
            message.lat = message.lon = 0
        return message

    failed(tmp_path, "reports no place but 0/0", change=nowhere)


def test_a_vessel_that_is_another_one_is_refused(tmp_path):
    def faster(message):
        if message.get_type() == "AIS_VESSEL":
            message.velocity += 200
        return message

    failed(tmp_path, "off the velocity that this scenario knows", change=faster)


def test_without_guided_nothing_is_commanded(tmp_path):
    failed(tmp_path, "the vehicle was not in GUIDED", mode="LOITER")


def test_a_second_companion_is_refused(tmp_path):
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    def change(message):
        return message

    with served("sim3", *KINEMATIC, change=change) as vehicle:
        import socket

        host, port = vehicle.url.removeprefix("tcp://").split(":")
        with socket.create_connection((host, int(port))) as other:
            beat = mavlink.MAVLink_heartbeat_message(
                mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3
            )
            packer = mavlink.MAVLink(None, srcSystem=1, srcComponent=191)
            import threading

            over = threading.Event()

            def beating():
                while not over.wait(0.1):
                    other.sendall(beat.pack(packer))

            thread = threading.Thread(target=beating)
            thread.start()
            try:
                ended = companion(vehicle, "sim3", tmp_path / "run", "--lockstep", "--no-report",
                                  settings=KINEMATIC)  # fmt: skip
            finally:
                over.set()
                thread.join()
    assert "another companion (1/191)" in ended.errors + ended.out + (
        str(row(tmp_path / "run")["message"]) if (tmp_path / "run").exists() else ""
    )
    assert vehicle.count("SET_ATTITUDE_TARGET") == 0


def test_in_real_time_it_commands_once_a_step_at_most(tmp_path):
    settings = (*KINEMATIC, "flight.duration_max_s=6", "guidance.rate_hz=10")
    with served("sim3", *settings, lockstep=False, scheme="udp") as vehicle:
        ended = companion(vehicle, "sim3", tmp_path / "run", "--no-report", settings=settings)
    assert "given back: the flight is over" in ended.out
    sent = [at for at, m in vehicle.heard if m.get_type() == "SET_ATTITUDE_TARGET"]
    flown = [at for at in sent if at <= sent[0] + 6.0]
    # Steps of 0.1 s. How many of them a busy machine leaves out is not tested.
    assert 1 < len(flown) <= 64
    assert math.isfinite(vehicle.simulation.closest)
