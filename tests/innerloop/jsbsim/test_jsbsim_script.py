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


def fly_in_python(root, schedule, commands, duration):
    """Fly commands from Python; return the script's columns and the time [s] after every step."""
    aircraft, start = AutopilotedAircraft(schedule.spec, root), schedule.level(MIDDLE)
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    names = columns(aircraft.fdm)
    nodes = [aircraft.fdm.node(name) for name in names]
    rows = [[node.get_double_value() for node in nodes]]
    for step in range(round(duration * STEPS_PER_SECOND)):
        for command in commands:
            if round(command.time * STEPS_PER_SECOND) == step:
                aircraft.fdm.write(command.name, command.value)
        aircraft.fdm.step()
        rows.append([node.get_double_value() for node in nodes])
    return pd.DataFrame(rows, columns=names).assign(Time=np.arange(len(rows)) / STEPS_PER_SECOND)


@pytest.mark.parametrize("name", ["x8", "aerosonde"])
def test_jsbsim_alone_flies_the_trajectory_that_python_flies(designs, name, tmp_path):
    schedule, root, away = designs(name).design.schedule, tmp_path / "root", tmp_path / "away"
    away.mkdir()
    script = write_script(schedule, write_root(schedule, root))
    places = f"--root={root}", f"--outputpath={away}", f"--script=scripts/{script.name}"
    command = [sys.executable, "-m", "jsbsim.script", "--nohighlight", *places]
    subprocess.run(command, cwd=away, check=True, capture_output=True, timeout=60)
    # To the last bit, which pandas' own reader of numbers need not do.
    alone = pd.read_csv(away / f"{script.stem}.csv", dtype=str).map(float)
    commands = demonstration(schedule.envelope, schedule.level(MIDDLE))
    python = fly_in_python(root, schedule, commands, alone["Time"].iloc[-1])
    # From the release on; JSBSim's clock has rounding in it.
    alone = alone[alone["Time"] > -1e-6].reset_index(drop=True)
    same = python.iloc[:: STEPS_PER_SECOND // 20].reset_index(drop=True)
    assert len(alone) == len(same) == 95 * 20 + 1
    # JSBSim adds up 12000 steps and prints ten digits.
    np.testing.assert_allclose(alone["Time"], same["Time"], atol=1e-9)
    assert set(alone) == set(python)
    for column in set(python) - {"Time"}:
        # To the last bit: 18 digits are printed, one more than a number has, and both set the same
        # state in the same order.
        np.testing.assert_array_equal(alone[column], same[column], err_msg=column)
