"""The scripts of docs/scripts run as they stand, and say what they are for."""

import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

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


def test_every_script_is_tested():
    assert {path.stem for path in SCRIPTS.glob("*.py")} == set(PRINTED)


@pytest.mark.usefixtures("x8_design", "heavy_design")
@pytest.mark.parametrize("name", PRINTED)
def test_a_script_runs_and_writes_what_it_says(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
    printed = capsys.readouterr().out
    for words in PRINTED[name]:
        assert words in printed
    assert {path.name for path in tmp_path.iterdir()} == WRITTEN[name]
