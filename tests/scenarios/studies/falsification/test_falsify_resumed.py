"""A search that is resumed: after lost flights, and with a limit of time."""

import itertools
from types import SimpleNamespace

import pandas as pd
import pytest

from scenarios.studies import falsify as falsification
from tests.run_tables import manifest_of
from tests.scenarios.losing_executor import losing
from tests.scenarios.short_search import CONFIRMATIONS, KEPT, POPULATION, run, same_tables, tables

pytestmark = pytest.mark.slow

TURNS = "search.generations=4"
"""Each method's turn, and one more: what the first turns found decides the later ones."""


def clock(monkeypatch):
    """Have the search's time advance by a second whenever it is looked at."""
    ticks = itertools.count()
    monkeypatch.setattr(
        falsification, "time", SimpleNamespace(monotonic=lambda: float(next(ticks)))
    )


def test_a_search_is_resumed_after_a_lost_flight_on_which_others_depend(search, tmp_path):
    out = tmp_path / "run"

    def interrupt(_doing, done, _):
        if done == 3 * POPULATION:
            raise KeyboardInterrupt

    # The eighth flight of the first turn: what the third turn proposes depends on it.
    assert run(search, out, TURNS, factory=losing(7), progress=interrupt).verdict.interrupted
    result = run(search, out, TURNS, resume=True)
    searched = tables(out)[0].set_index("flight_id")
    assert "short_00007" not in searched.index[searched["min_distance_m"].notna()]
    assert result.verdict.counts.done == result.verdict.counts.planned
    assert not result.all_met
    # It stays its method's, and is not the nearest of any.
    assert searched.loc["short_00007", "search_method"] == "corners"
    assert not any("1000000" in line or line.startswith("  :") for line in result.lines)
    # A search that was not interrupted goes the same way.
    run(search, tmp_path / "whole", TURNS, factory=losing(7))
    same_tables(tmp_path / "whole", out)


def test_a_lost_flight_on_which_no_other_depends_is_tried_again(search, tmp_path):
    found = tmp_path / "found"
    run(search, found, TURNS)
    last = len(tables(found)[0]) - 1
    run(search, tmp_path / "run", TURNS, factory=losing(last))
    assert run(search, tmp_path / "run", TURNS, resume=True).all_met
    same = [
        pd.read_csv(out / "summary.csv").drop(columns="wall_time_s")
        for out in (found, tmp_path / "run")
    ]
    pd.testing.assert_frame_equal(*(rows[: last + 1] for rows in same), check_exact=True)


def test_a_search_by_time_ends_after_it_and_a_resumed_one_continues_for_as_long(
    search, tmp_path, monkeypatch
):
    clock(monkeypatch)
    out = tmp_path / "run"
    assert run(search, out, "search.time_s=4").all_met
    before, repeats = tables(out)
    assert len(repeats) == KEPT * CONFIRMATIONS
    clock(monkeypatch)
    assert run(search, out, "search.time_s=4", resume=True).all_met
    after, repeats_after = tables(out)
    assert len(after) > len(before)
    first = after.iloc[: len(before)].drop(columns="wall_time_s")
    pd.testing.assert_frame_equal(first, before.drop(columns="wall_time_s"), check_exact=True)
    worst = {entry["flight_id"] for entry in manifest_of(out)["search"]["worst"]}
    # What the first run repeated stays in the tables, also where it is not among the worst any
    # more.
    assert set(repeats_after["confirms"]) == worst | set(repeats["confirms"])
    assert manifest_of(out)["flights_planned"] == len(after) + len(repeats_after)
    assert len(list((out / "worst").iterdir())) == KEPT
