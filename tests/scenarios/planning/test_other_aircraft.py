"""Runs for aircraft other than the X8, as far as no flight of theirs is needed (tests/regression
flies them).
"""

import math

import pandas as pd
import pytest
import typer

from aircraft.fleet.aerosonde import AEROSONDE
from aircraft.spec import AircraftError
from common.verdict import read_verdict
from innerloop.store import DesignError
from scenarios.engine.processes import InProcessExecutor
from scenarios.run import command
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

SHORT = ["sweep.nu=[0.5]", "flight.crossings=2", "comparison.variants=[]"]

# Two crossings, right after settling, are too few for means over them.
LOOSE = ["criteria.crossing_interval_error=0.1", "criteria.tracking_error_rms_m=5.0"]


def run(path, *overrides, name="sweep_nu"):
    return run_study(
        load_study(name, [*SHORT, *overrides]), name, path, executor_factory=InProcessExecutor
    )


def exit_status(path, *overrides):
    with pytest.raises(typer.Exit) as ended:
        command("sweep_nu", out=path, jobs=1, overrides=[*SHORT, *overrides])
    return ended.value.exit_code


@pytest.fixture
def refuse(monkeypatch):
    """Return a function that lets every design fail with an error."""

    def refuse(error):
        def designed(*_):
            raise error

        monkeypatch.setattr("scenarios.vehicles.vehicle_setup.designed", designed)

    return refuse


@pytest.mark.parametrize(
    ("error", "drawn"),
    [
        (DesignError("aircraft 'x8': no design has 6 dB. It is not flown"), True),
        (AircraftError("aircraft 'x8' does not trim: not converged"), False),
    ],
)
def test_a_design_that_is_refused_is_rows_with_its_reason_and_exit_status_1(
    refuse, error, drawn, tmp_path, capsys, request
):
    if not drawn:
        request.getfixturevalue("sketched")
    refuse(error)
    out = tmp_path / "run"
    assert exit_status(out, "sweep.nu=[0.3, 0.5]") == 1
    printed = capsys.readouterr()
    assert printed.out.count(f"trim_failed: {error}") == 2
    assert "Traceback" not in printed.err
    summary = pd.read_csv(out / "summary.csv")
    assert list(summary["flight_id"]) == ["nu_0.30", "nu_0.50"]
    assert set(summary["outcome"]) == {"trim_failed"}
    assert set(summary["message"]) == {str(error)}
    assert not summary["criteria_met"].any()
    counts = read_verdict(out / "verdict.json").counts
    assert manifest_of(out)["state"] == "complete"
    assert (counts.outcomes["trim_failed"], counts.met) == (2, 0)
    # The reports are built all the same, and say why nothing was flown.
    html = (out / "report.html").read_text(encoding="utf-8")
    assert "Nothing was flown" in html
    assert "trim failed" in html
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF")


def test_the_kinematic_vehicle_flies_as_the_aircraft_that_is_named_would(designs, tmp_path):
    designs("aerosonde")
    out = tmp_path / "run"
    assert run(out, "fidelity=kinematic", "aircraft=aerosonde", *LOOSE).all_met
    flown = pd.read_parquet(out / "flights" / "nu_0.50.parquet")
    manifest = manifest_of(out)
    assert manifest["config"]["guidance"]["airspeed_mps"] == AEROSONDE.envelope.airspeed
    assert flown["airspeed_mps"].iloc[-1] == pytest.approx(
        25.0, abs=1.3
    )  # its own airspeed, trimmed by up to 1.29 m/s
    # omega_max of 45 degrees at 25 m/s.
    assert (
        flown["heading_rate_command_rad_s"].abs().max()
        <= 9.80665 * math.tan(math.radians(45.0)) / 25.0
    )
    # No autopilot takes part, and none lags: half a step of 20 Hz is all there is to preview.
    assert manifest["guidance_lag_s"] == 0.025
    assert not (out / "innerloop.json").exists()
