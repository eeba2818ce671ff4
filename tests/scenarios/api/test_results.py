"""What a program has of flights and runs: tables, exports, parts as objects, and the scripts of
docs/scripts.
"""

import gc
import math
import runpy
import tempfile
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pyarrow.feather
import pytest

import scenarios
from scenarios import fly, run
from scenarios.api.scenario import load
from scenarios.errors import InputError

SHORT = {
    "title": "Short <b>flights</b>",
    "fidelity": "kinematic",
    "sweep": {"nu": [0.3, 0.5]},
    "guidance": {"rate_hz": 5.0},
    "flight": {"crossings": 2, "log_rate_hz": 5.0},
    "criteria": {"crossing_interval_error": False, "tracking_error_rms_m": False},
}


@pytest.fixture(scope="module")
def flight():
    return fly(SHORT, nu=0.5)


def test_a_flight_says_how_it_ended(flight):
    assert flight.met
    assert flight.kept_out
    assert flight.reasons == ()
    criteria = {"crossing_distance_m": [1.0, 2.0], "tracking_error_end_m": 1e-9}
    strict = fly(SHORT, nu=0.5, criteria=criteria)
    assert not strict.met
    assert len(strict.reasons) == 2
    assert strict.kept_out


def test_a_flight_that_cannot_be_flown_is_a_flight_with_its_reason():
    # A vessel that outruns the UAV has no solution.
    infeasible = fly(SHORT, nu=1.5)
    assert infeasible.row["outcome"] == "infeasible"
    assert infeasible.reasons == (infeasible.row["message"],)
    uses = (lambda: infeasible.history, infeasible.plot, lambda: infeasible.export("flight.kmz"))
    for use in uses:
        with pytest.raises(InputError, match="has no time history"):
            use()
    assert "infeasible" in infeasible._repr_html_()


def test_a_time_history_is_exported_whole(flight, tmp_path):
    read_arrow = pyarrow.feather.read_feather
    readers = {"csv": pd.read_csv, "parquet": pd.read_parquet, "arrow": read_arrow}
    for suffix, read in readers.items():
        found = read(flight.export(tmp_path / f"flight.{suffix}"))
        pd.testing.assert_frame_equal(found, flight.history, check_exact=True)
    table = pyarrow.feather.read_table(tmp_path / "flight.arrow")
    assert table.schema.field("airspeed_mps").metadata[b"unit"] == b"m/s"


def test_nothing_is_left_on_disk_nor_printed(capfd, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    flown = fly(SHORT, nu=0.5)
    directory = flown.run.directory
    assert directory.parent == tmp_path
    assert flown.history is not None
    with pytest.raises(InputError, match=r"did you mean 'nu_0\.50'"):
        fly(SHORT, flight_id="nu_0.5")
    assert list(tmp_path.iterdir()) == [directory]
    del flown
    gc.collect()
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def test_the_public_names_are_these():
    assert scenarios.__all__ == [
        "Flight",
        "InputError",
        "Run",
        "Scenario",
        "Statistics",
        "fly",
        "load",
        "read_ais",
        "run",
    ]
    assert set(scenarios.__all__) <= set(dir(scenarios))


ONE = {
    "title": "One short flight",
    "fidelity": "kinematic",
    "sweep": {"nu": [0.5]},
    "flight": {"crossings": 2},
    "criteria": {"crossing_interval_error": False, "tracking_error_rms_m": False},
}


@dataclass(frozen=True, kw_only=True)
class Pursuit:
    """The law of docs/howto/extending.md."""

    gain: float = 1.2
    lead_s: float = 1.0

    def heading_rate(self, reference, own, air):
        lead = self.lead_s * reference.speed
        sight = math.atan2(
            reference.east - own.east + lead * math.sin(reference.course),
            reference.north - own.north + lead * math.cos(reference.course),
        )
        return self.gain * math.remainder(sight - own.course, math.tau) + reference.heading_rate


@pytest.mark.slow
def test_a_law_as_an_object_flies_as_the_one_of_the_file():
    scenario = load(ONE, law=Pursuit(gain=1.5))
    assert (scenario["guidance.law"], scenario["guidance.gain"]) == ("Pursuit", 1.5)
    named = fly(ONE, law=f"{__file__}:Pursuit", **{"guidance.gain": 1.5})
    given = fly(ONE, law=Pursuit(gain=1.5))
    assert given.history.equals(named.history)
    assert not given.history.equals(fly(ONE, law=Pursuit).history)


@pytest.mark.slow
def test_laws_are_compared_and_swept_in_other_processes():
    laws = {
        "sweep.guidance.law": ["cascade", Pursuit],
        "comparison.variants": [{"name": "soft", "set": {"guidance.law": Pursuit}}],
    }
    study = run(ONE, jobs=2, **laws)
    assert list(study.flights) == [
        "nu_0.50_law_cascade", "nu_0.50_law_Pursuit", "nu_0.50_law_cascade_soft",
        "nu_0.50_law_Pursuit_soft",
    ]  # fmt: skip
    soft = study.flights["nu_0.50_law_cascade_soft"].history
    assert soft.equals(study.flights["nu_0.50_law_Pursuit"].history)


SCRIPTS = Path(__file__).parents[3] / "docs" / "scripts"

PRINTED = {
    "one_flight": ("nu_0.50", "6 crossings", "rad"),
    "own_law": ("criteria_met", "0.3", "True"),
    "ship_from_ais": ("from 2026-06-01T10:00:00", "keep-out violations: 0"),
    "aircraft_directory": ("fleet/heavy", "0.3", "0.6", "True"),
    # Simulation 3: pi/omega_0 and r_CO at nu = 0.5.
    "paper_sim_3": ("every 9.5 s at 214 m from the vessel",),
    "monte_carlo": ("0 of 6 flights", "at 95% confidence", "median of the closest approach"),
}

WRITTEN = {
    "paper_sim_3": set(),
    "one_flight": {"flight.png", "flight.kmz", "flight.parquet"},
    "own_law": set(),
    "ship_from_ais": {"wind.csv", "flight.kmz"},
    "aircraft_directory": {"fleet"},
    "monte_carlo": {"report.html"},
}


@pytest.mark.slow
def test_every_script_is_tested():
    assert {path.stem for path in SCRIPTS.glob("*.py")} == set(PRINTED)


@pytest.mark.slow
@pytest.mark.usefixtures("x8_design", "heavy_design", "sketched")
@pytest.mark.parametrize("name", PRINTED)
def test_a_script_runs_and_writes_what_it_says(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
    printed = capsys.readouterr().out
    for words in PRINTED[name]:
        assert words in printed
    assert {path.name for path in tmp_path.iterdir()} == WRITTEN[name]
