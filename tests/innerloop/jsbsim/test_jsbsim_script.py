"""The script that flies the autopilot in JSBSim alone, against the same flight from Python."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.script import columns, demonstration, write_script
from innerloop.jsbsim.system import write_root

pytestmark = pytest.mark.slow

MIDDLE = 2
STEPS_PER_SECOND = 120


def run_jsbsim(*arguments, directory):
    """Run JSBSim's standalone program in a directory."""
    command = [sys.executable, "-m", "jsbsim.script", "--nohighlight", *arguments]
    subprocess.run(command, cwd=directory, check=True, capture_output=True, timeout=60)


def read_result(path):
    """Read a result to the last bit, which pandas' own reader of numbers need not do."""
    return pd.read_csv(path, dtype=str).map(float)


def fly_in_python(root, schedule, commands, duration):
    """Fly commands from Python; return the script's columns and the time [s] after every step."""
    aircraft, start = AutopilotedAircraft(schedule.spec, root), schedule.level(MIDDLE)
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    names = columns(aircraft.fdm)
    nodes = [aircraft.fdm.node(name) for name in names]
    due = {}
    for command in commands:
        due.setdefault(round(command.time * STEPS_PER_SECOND), []).append(command)
    rows = [[node.get_double_value() for node in nodes]]
    for step in range(round(duration * STEPS_PER_SECOND)):
        for command in due.get(step, ()):
            aircraft.fdm.write(command.name, command.value)
        aircraft.fdm.step()
        rows.append([node.get_double_value() for node in nodes])
    return pd.DataFrame(rows, columns=names).assign(Time=np.arange(len(rows)) / STEPS_PER_SECOND)


def fly_both(schedule, tmp_path_factory):
    """A schedule, and its demonstration flown by JSBSim alone and from Python."""
    root, away = tmp_path_factory.mktemp("root"), tmp_path_factory.mktemp("away")
    script = write_script(schedule, write_root(schedule, root))
    run_jsbsim(
        f"--root={root}", f"--outputpath={away}", f"--script=scripts/{script.name}", directory=away
    )
    alone = read_result(away / f"{script.stem}.csv")
    duration = alone["Time"].iloc[-1]
    return (
        schedule,
        alone,
        fly_in_python(
            root, schedule, demonstration(schedule.envelope, schedule.level(MIDDLE)), duration
        ),
    )


@pytest.fixture(scope="module", params=["x8", "aerosonde"])
def flights(request, designs, tmp_path_factory):
    return fly_both(designs(request.param).design.schedule, tmp_path_factory)


@pytest.fixture(scope="module")
def jet_flight(designs, tmp_path_factory):
    """JSBSim's own T-37, a jet whose engines need no starter."""
    return fly_both(designs("T37").design.schedule, tmp_path_factory)


def released(alone):
    """Return the rows from release on; JSBSim's clock has rounding in it."""
    return alone[alone["Time"] > -1e-6].reset_index(drop=True)


def test_jsbsim_alone_flies_the_trajectory_that_python_flies(flights):
    _, alone, python = flights
    alone = released(alone)
    same = python.iloc[:: STEPS_PER_SECOND // 20].reset_index(drop=True)
    assert len(alone) == len(same) == 95 * 20 + 1
    # JSBSim adds up 12000 steps and prints ten digits.
    np.testing.assert_allclose(alone["Time"], same["Time"], atol=1e-9)
    assert set(alone) == set(python)
    for name in set(python) - {"Time"}:
        # To the last bit: 18 digits are printed, one more than a number has, and both set the same
        # state in the same order.
        np.testing.assert_array_equal(alone[name], same[name], err_msg=name)


def test_a_stock_aircraft_is_flown_by_jsbsim_alone_as_from_python_but_for_its_engines_last_breath(
    jet_flight,
):
    schedule, alone, python = jet_flight
    alone = released(alone)
    same = python.iloc[:: STEPS_PER_SECOND // 20].reset_index(drop=True)
    assert len(alone) == len(same)
    start = schedule.level(MIDDLE)
    # Python places the aircraft twice, to run its engines up in between, and the script holds it
    # all the time: engines are released in states that differ by what is left of spooling after 10
    # s. Measured 2e-9 m/s, 2e-8 m, 1e-11 and 1e-10 rad; a hundred times that is let go, for another
    # platform's rounding decides when an engine settles.
    tolerances = {
        "autopilot/airspeed-mps": 2e-7,
        "position/h-sl-meters": 2e-6,
        "attitude/phi-rad": 1e-9,
        "attitude/theta-rad": 1e-8,
    }
    for name, tolerance in tolerances.items():
        assert np.abs(alone[name] - same[name]).max() < tolerance, name
    # It flew: the turn to the right by a quarter of the bank's turn, and the climb.
    rate = demonstration(schedule.envelope, start)[0].value
    assert alone["autopilot/heading-rate-rad_sec"][300] == pytest.approx(rate, rel=0.05)
    assert alone["position/h-sl-meters"].max() > start.altitude + 0.4 * start.airspeed
