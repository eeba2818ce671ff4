"""The gymnasium environment: gymnasium's own check, the paper's guidance as a policy, rewards, and
what is refused.
"""

import math
import re
import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from extensions.gym import ENVIRONMENT
from extensions.gym.observation import MEANINGS
from extensions.gym.reward import VIOLATION, CrossingReward
from scenarios import fly
from scenarios.errors import InputError

pytestmark = pytest.mark.slow

PROJECT = Path(__file__).parents[3]
SHORT = {"sweep.nu": [0.3, 0.6], "flight.crossings": 4}
KINEMATIC = SHORT | {"fidelity": "kinematic"}


def make(**keys):
    return gymnasium.make(ENVIRONMENT, keys=keys)


@pytest.fixture(scope="module")
def kinematic():
    """The environment with the kinematic vehicle, which is quick."""
    env = make(**KINEMATIC)
    yield env
    env.close()


def followed(env, flight_id):
    """Fly an episode as the guidance would; return the sum of rewards, the last information, and
    how it ended.
    """
    _, info = env.reset(options={"flight_id": flight_id})
    total, terminated, truncated = 0.0, False, False
    while not (terminated or truncated):
        _, reward, terminated, truncated, info = env.step(info["guidance"])
        total += reward
    return total, info, terminated


def column(env, name):
    return env.unwrapped.record.column(name)


def test_gymnasium_finds_it_in_a_process_of_its_own_as_the_page_says():
    # By its module and name alone; the other tests' environments are made after an import, the
    # page's other way.
    name = f"extensions.gym:{ENVIRONMENT}"
    script = f"import gymnasium; print(gymnasium.make({name!r}, keys={{'fidelity': 'kinematic'}}).spec.id)"
    found = subprocess.run(
        [sys.executable, "-c", script], cwd=PROJECT, capture_output=True, text=True, check=False
    )
    assert (found.stdout.split(), found.returncode) == ([ENVIRONMENT], 0), found.stderr
    page = (PROJECT / "extensions" / "gym" / "page.md").read_text(encoding="utf-8")
    assert all(
        words in page
        for words in (name, f'"{ENVIRONMENT}"', "import gymnasium", "import extensions.gym")
    )


def test_it_passes_gymnasiums_check(kinematic):
    with warnings.catch_warnings():
        # Actions are in SI, not normalised: extensions/gym/page.md says how to rescale them.
        warnings.filterwarnings(
            "ignore", message=".*we recommend using a symmetric and normalized space"
        )
        check_env(kinematic.unwrapped, skip_render_check=True)


@pytest.mark.usefixtures("x8_design")
def test_the_papers_guidance_as_a_policy_flies_the_flight_of_a_run_to_the_last_bit():
    env = make(**SHORT)
    # Whatever was flown before.
    env.reset(seed=1)
    env.step(env.action_space.high)
    total, info, terminated = followed(env, "nu_0.30")
    flown = fly("sweep_nu", flight_id="nu_0.30", **SHORT)
    commands = ("heading_rate_command_rad_s", "airspeed_command_mps")
    for name in ("time_s", "north_m", "east_m", "altitude_m", "roll_rad", *commands):
        assert np.array_equal(column(env, name), flown.history[name].to_numpy()), name
    assert terminated
    assert info["settled"]
    # The vessel sails north, so that the plume trails south. Samples are 0.1 s and 2 m apart, 1 %
    # of a crossing's distance.
    astern = column(env, "vessel_north_m") - column(env, "north_m")
    across = column(env, "east_m") - column(env, "vessel_east_m")
    crossed = astern[1:][(across[1:] * across[:-1] < 0.0) & (astern[1:] > 0.0)]
    assert info["crossings"] == len(crossed)
    assert total == pytest.approx(np.minimum(1.0, 200.0 / crossed).sum(), rel=0.02)


def test_flying_at_the_vessel_ends_in_the_keepout_area_with_its_reward(kinematic):
    observed, _ = kinematic.reset(options={"flight_id": "nu_0.30"})
    names, limit = list(MEANINGS), kinematic.action_space.high[0]
    rewards, terminated = [], False
    while not terminated:
        seen = dict(zip(names, observed, strict=True))
        course = math.atan2(seen["velocity_across_mps"], seen["velocity_along_mps"])
        turn = math.remainder(math.atan2(-seen["across_m"], -seen["along_m"]) - course, math.tau)
        observed, reward, terminated, truncated, _ = kinematic.step(
            np.array([np.clip(turn, -limit, limit), 19.42])
        )
        assert not truncated
        rewards.append(reward)
    assert rewards[-1] <= VIOLATION + 1.0
    assert dict(zip(names, observed, strict=True))["clearance_m"] < 0.0
    with pytest.raises(InputError, match="the episode is over; reset"):
        kinematic.step(kinematic.action_space.low)
    with pytest.raises(InputError, match=r"no record: .* a keep-out violation ended it"):
        _ = kinematic.unwrapped.record


def test_a_crossing_is_worth_the_keepout_radius_over_its_distance_and_weaving_or_passing_ahead_nothing():
    ahead, across = (
        (300.0, 300.0, 300.0, 310.0, 320.0, 150.0),
        (-50.0, -1.0, 1.0, 25.0, 60.0, -60.0),
    )
    reward = CrossingReward(200.0)
    # Nearer than the radius it is worth no more.
    assert [*map(reward.update, ahead, across)] == [0.0, 0.0, 200.0 / 300.0, 0.0, 0.0, 1.0]
    weaving = CrossingReward(200.0)
    assert sum(weaving.update(200.0, side * 15.0) for side in (-3, 1, -1, 1, -1, 1)) == 1.0
    ahead = CrossingReward(200.0)
    assert sum(ahead.update(-250.0, across) for across in (-50.0, 50.0)) == 0.0


def test_actions_outside_the_space_are_cut_and_the_guidance_knows_what_was_flown(kinematic):
    kinematic.reset(options={"flight_id": "nu_0.30"})
    loop, high = kinematic.unwrapped._episode.loop, kinematic.action_space.high
    # The kinematic vehicle follows at once: eq. (1).
    kinematic.unwrapped.step(10.0 * high)
    assert loop.vehicle.motion()[4] == high[0]
    assert loop.vehicle.air_data()[0] == high[1]
    with pytest.raises(InputError, match=r"the action is .*; give heading rate"):
        kinematic.unwrapped.step(np.array([math.nan, 19.0]))
    kinematic.unwrapped.step(0.5 * high)
    assert loop.vehicle.motion()[4] == 0.5 * high[0]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            dict.fromkeys(
                ("guidance.command_limit", "guidance.approach", "guidance.keepout_guard"), False
            ),
            "command_limit is false; an environment needs a limit",
        ),
        ({"sweep.nv": [0.3]}, "unknown key 'nv'"),
    ],
)
def test_what_cannot_be_an_environment_is_refused_in_a_line(keys, words):
    with pytest.raises(InputError, match=words) as caught:
        gymnasium.make(ENVIRONMENT, keys=KINEMATIC | keys)
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("x8_design")
def test_the_example_of_the_page_runs_as_it_stands(capsys):
    page = (PROJECT / "extensions" / "gym" / "page.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    exec(compile(example, "gym.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "crossings in" in printed
    assert "COMPLETED" in printed
