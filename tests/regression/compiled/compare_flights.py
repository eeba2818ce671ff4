"""`make fast` runs these tests: flights of the compiled guidance are those of its sources, to the
last bit.
"""

import os
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pandas as pd
import pytest
from study_runs import AT_THE_SHIP
from test_corners import ORDINARY_REPORTS, SILENT_BRAKING, WITHOUT_SATELLITES

ENGINE_FAILS = [
    "sea_wind", "draws=[]", "flights=1", *AT_THE_SHIP, "reference.standoff_radius_m=9000", "vessel.speed_mps=15",
    "start.range_m=421.05", "start.aspect_deg=180", "start.course_deg=180", "fault.kind=engine", "fault.at_s=[0.749,0.749]",
    "flight.duration_max_s=60", "flight.crossings=0",
]  # fmt: skip
"""A turn away that is predicted at two speeds."""

IN_WIND = ["sea_wind", "draws=[]", "flights=1", "flight.crossings=6"]

IN_CALM_AIR = ["sweep_nu", "sweep.nu=[0.5]", "comparison.variants=[]", "flight.crossings=6"]

LOOKING_AHEAD = f"guidance.law={Path(__file__).parent}/law_that_looks_ahead.py:LooksAhead"

OWN_SHAPE = f"reference.shape={Path(__file__).parent}/shape_of_lists.py:ShapeOfLists"

OWN_INSTRUMENT = f'payload=["{Path(__file__).parent}/instrument_of_lists.py:InstrumentOfLists"]'

STUDIES = {
    "calm air": [
        "sweep_nu",
        "sweep.nu=[0.1,0.5,0.95]",
        "flight.crossings=4",
        "start.spread_deg=180",
    ],
    "the paper": ["paper"],
    "a fast oscillation": [*IN_CALM_AIR, "reference.shape=fastest"],
    "a loiter": [*IN_CALM_AIR, "sweep.nu=[0.1]", "reference.shape=loiter"],
    "samples": ["monte_carlo", "flights=6", "flight.duration_max_s=200"],
    "silent braking": SILENT_BRAKING,
    "ordinary reports": ORDINARY_REPORTS,
    "no satellites": WITHOUT_SATELLITES,
    "a failing engine": ENGINE_FAILS,
    "a stuck surface": [
        "sea_faults",
        "flights=2",
        "fault.kind=left_elevon",
        "flight.duration_max_s=300",
    ],
    "a law that copies its reference": [*IN_WIND, LOOKING_AHEAD],
    "a law that copies it in calm air": [*IN_CALM_AIR, LOOKING_AHEAD],
    "a shape that answers in lists": [*IN_WIND, OWN_SHAPE],
    "a shape that does in calm air": [*IN_CALM_AIR, OWN_SHAPE],
    "an instrument that answers in lists": [*IN_CALM_AIR, OWN_INSTRUMENT],
    "a search": ["sulphur", "following.plume=estimated", "flight.duration_max_s=200"],
}


def rows_and_histories(path, name, *overrides, **environment):
    """Fly a study in a separate process; return its summary, crossings and time histories."""
    words = [word for override in overrides for word in ("--set", override)]
    fly = [sys.executable, "-m", "scenarios.run", name, "--jobs", "2", "--no-report", "--out", path]
    run = subprocess.run(
        [*fly, *words],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    # 1: a flight did not meet what is required of it.
    assert run.returncode in {0, 1}, run.stderr
    tables = {
        file: pd.read_csv(path / file).drop(columns="wall_time_s", errors="ignore")
        for file in ("summary.csv", "crossings.csv")
    }
    histories = sorted((path / "flights").glob("*.parquet"))
    return tables | {file.name: pd.read_parquet(file) for file in histories}


@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_a_flight_is_the_same_whichever_form_of_the_guidance_flies_it(study, tmp_path):
    compiled = rows_and_histories(tmp_path / "compiled", *study, PLUME_FLIGHT_SOURCES="")
    sources = rows_and_histories(tmp_path / "sources", *study, PLUME_FLIGHT_SOURCES="1")
    assert list(compiled) == list(sources)
    assert len(compiled) > 2
    for name, table in compiled.items():
        pd.testing.assert_frame_equal(table, sources[name], check_exact=True, obj=name)


def test_the_guidance_that_is_compiled_is_the_one_that_flies():
    code = "import gnc.guard.guard as module; print(module.__file__)"
    for asked, ending in (("", EXTENSION_SUFFIXES[0]), ("1", ".py")):
        environment = {**os.environ, "PLUME_FLIGHT_SOURCES": asked}
        run = subprocess.run(
            [sys.executable, "-c", code],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert run.stdout.strip().endswith(ending)
