"""A program gets what the command line gets: the same rows, crossings and time histories, byte for
byte.
"""

import csv

import pandas as pd
import pytest

from scenarios import fly, run
from scenarios.api.scenario import load
from scenarios.errors import InputError
from tests.in_process import run_command

pytestmark = pytest.mark.slow

SHORT = """
title = "Two short flights"
fidelity = "kinematic"
guidance.rate_hz = 10.0
seed = 7

[sweep]
nu = [0.3, 0.5]

[flight]
crossings = 4

[comparison]
nu = [0.5]
variants = [{ name = "no_guard", set = { "guidance.keepout_guard" = false } }]
"""

TIMED = "wall_time_s"
"""The column that differs between repetitions of a flight."""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(SHORT, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def by_command(file):
    out = file.parent / "by_command"
    words = ("--out", out, "--set", "guidance.look_ahead_m=55", "--jobs", "1", "--no-report")
    ended = run_command("scenarios.run", file, *words)
    assert ended.status == 0, ended
    return out


@pytest.fixture(scope="module")
def by_program(file):
    return run(file, out=file.parent / "by_program", jobs=2, guidance={"look_ahead_m": 55})


def rows(path):
    with path.open(encoding="utf-8", newline="") as table:
        return [
            {name: cell for name, cell in row.items() if name != TIMED}
            for row in csv.DictReader(table)
        ]


def test_files_of_a_run_are_the_same(by_command, by_program):
    paths = [path for path in by_command.rglob("*") if path.suffix in (".csv", ".parquet")]
    names = {path.relative_to(by_command) for path in paths}
    # Two swept speed ratios, and the comparison at one of them.
    assert sum(name.suffix == ".parquet" for name in names) == 3
    for name in names:
        theirs, mine = by_command / name, by_program.directory / name
        if name.name in ("summary.csv", "comparison.csv"):
            assert rows(theirs) == rows(mine), name
        else:
            assert theirs.read_bytes() == mine.read_bytes(), name


def test_a_single_flight_is_that_of_the_run(file, by_program, tmp_path):
    flight_id = "nu_0.50_no_guard"
    # It has its time history, however few a study keeps.
    flight = fly(file, flight_id=flight_id, histories=0, guidance={"look_ahead_m": 55})
    its = by_program.flights[flight_id]
    pd.testing.assert_series_equal(flight.row.drop(TIMED), its.row.drop(TIMED), check_exact=True)
    exported = [of.export(tmp_path / f"{i}.parquet") for i, of in enumerate((flight, its))]
    assert exported[0].read_bytes() == exported[1].read_bytes()
    assert flight.crossings.equals(its.crossings)
    assert len(flight.crossings) == 4


def test_a_scenario_is_changed_as_by_the_command_line(file):
    scenario = load(file).set(nu=0.4, wind={"speed_mps": 3.0}, **{"guidance.rate_hz": 10})
    assert scenario.changes == ("sweep.nu=[0.4]", "wind.speed_mps=3.0", "guidance.rate_hz=10")
    assert scenario["wind.speed_mps"] == 3.0
    assert scenario["comparison.variants.0.name"] == "no_guard"
    for unknown in ("wind.sped_mps", "comparison.variants.1.name", "title.0"):
        with pytest.raises(InputError, match="unknown key"):
            scenario[unknown]
    assert load(file).changes == ()
