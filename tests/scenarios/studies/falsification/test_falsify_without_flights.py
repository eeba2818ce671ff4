"""A search that finds nothing to fly ends, and says so in one line."""

import itertools
import re
from types import SimpleNamespace

import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies import falsify as falsification
from scenarios.studies.base import run_study

SEARCH = """
study = "falsify"
title = "short"
fidelity = "kinematic"
[search]
population = 16
[[draws]]
key = "start.range_m"
uniform = [400.0, 1200.0]
[flight]
crossings = 0
duration_max_s = 4.0
[criteria]
required = "keep_out"
settles = false
"""

BEYOND = """
class Centre:
    exhausted = False
    batches = 0

    def __init__(self, space, settings, generator):
        self.space = space

    def ask(self, found, room):
        self.batches += 1
        if self.batches > 50:
            raise RuntimeError("the search does not end")
        return [[0.5] * self.space.dimension]

    def tell(self, clearances):
        pass
"""


def refused(directory, *overrides):
    """Run the search; return the one line that it is refused in."""
    path = directory / "short.toml"
    path.write_text(SEARCH, encoding="utf-8")
    with pytest.raises(InputError) as error:
        run_study(load_study(str(path), overrides), "short", directory / "run", overrides=overrides)
    line = str(error.value)
    assert "\n" not in line
    return line


def test_a_search_by_time_ends_where_no_point_is_within_the_declared_ranges(tmp_path, monkeypatch):
    # The search's time advances by a second whenever it is looked at.
    ticks = itertools.count()
    monkeypatch.setattr(
        falsification, "time", SimpleNamespace(monotonic=lambda: float(next(ticks)))
    )
    (tmp_path / "beyond.py").write_text(BEYOND, encoding="utf-8")
    # A turn of 4.5 deg/s at 8 m/s is 0.63 m/s2, whatever is sampled. Of turns that are not, the
    # study would be refused at once.
    turns = (
        "vessel.manoeuvres=[{at_s=1.0,turn_deg=60.0}]", "following.vessel_acceleration_mps2=0.05",
        'draws=[{key="vessel.manoeuvres.0.turn_rate_deg_s",uniform=[4.5,5.0]}]',
    )  # fmt: skip
    line = refused(
        tmp_path, "search.time_s=6", f'search.methods=["{tmp_path / "beyond.py"}:Centre"]', *turns
    )
    assert line.startswith("none of the ")
    assert (
        "within speed_ratio and following.vessel_acceleration_mps2, and none was flown: widen these"
        in line
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Unmade", "Unmade() failed: KeyError: 'mutations' (own.py:"),
        ("Raising", "ask(16) failed: RuntimeError: boom (own.py:"),
    ],
)
def test_a_method_of_ones_own_that_raises_is_named_with_its_file(tmp_path, name, words):
    made = "    def __init__(self, *_):\n        {}['mutations']\n"
    asked = "    def __init__(self, *_):\n        pass\n    def ask(self, *_):\n        raise RuntimeError('boom')\n"
    text = f"{BEYOND}\nclass Unmade(Centre):\n{made}\nclass Raising(Centre):\n{asked}"
    (tmp_path / "own.py").write_text(text, encoding="utf-8")
    method = f"{tmp_path / 'own.py'}:{name}"
    line = refused(tmp_path, f'search.methods=["{method}"]')
    assert line.startswith(f"search.methods: search method '{method}': {words}")


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (
            "search.generations=5",
            r"'search\.generations' has no effect here: .*: leave search\.time_s out",
        ),
        ("search.methods=[]", r"search\.methods is \[\]"),
        ("search.mutation=[1.0,0.5]", "its first value must not exceed its second"),
        ("search.time_s=0", r"search\.time_s"),
    ],
)
def test_a_search_that_cannot_be_is_refused_in_one_line(tmp_path, override, words):
    assert re.search(
        words,
        refused(tmp_path, override, *(["search.time_s=60"] if "generations=5" in override else [])),
    )
