"""Experiments on any scenario, in any study: what was once refused in calm air or in wind flies in
both.
"""

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.run_tables import manifest_of, rows_of

pytestmark = pytest.mark.slow

SLOW_STEPS = ("fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5")
BOTH_LAWS = '[{name="line_of_sight", set={"guidance.law"="line_of_sight"}}, {name="lyapunov", set={"guidance.law"="lyapunov"}}]'


def flown(out, name, *overrides, outcome="completed", **beside):
    """Fly a study; return its rows, all with one outcome and outside the keep-out area."""
    run_study(
        load_study(name, overrides),
        name,
        out,
        overrides=overrides,
        executor_factory=InProcessExecutor,
        **beside,
    )
    rows = rows_of(out)
    for row in rows:
        assert (row["outcome"], row["keepout_violations"]) == (outcome, 0), row["message"]
    return rows


@pytest.fixture(scope="module")
def x8(tmp_path_factory):
    """One flight of the X8 with a rising plume, in wind and light turbulence."""
    out = tmp_path_factory.mktemp("x8") / "run"
    keys = ["sweep.nu=[0.5]", "comparison.variants=[]", "flight.crossings=4"]
    air = [
        "wind.speed_mps=5",
        "wind.from_deg=90",
        "turbulence.level=light",
        "plume.elevation_deg=10",
    ]
    (row,) = flown(out, "sweep_nu", *keys, *air)
    return row, pd.read_parquet(out / "flights" / "nu_0.50.parquet")


def test_the_sweep_flies_in_wind_and_turbulence(x8):
    row, history = x8
    assert (row["wind_speed_mps"], row["turbulence"], row["mode_at_end"]) == (
        5.0,
        "light",
        "tracking",
    )
    # The vessel goes north at 0.5 V_r, the wind comes from abeam: by Pythagoras, nu of the motion
    # through the air.
    assert row["nu"] == pytest.approx((0.5**2 + (5.0 / 19.42) ** 2) ** 0.5, rel=1e-9)
    assert row["vessel_speed_mps"] == pytest.approx(0.5 * 19.42)
    # Turbulence is felt, and a margin planned for it.
    assert history["airspeed_mps"].std() > 0.1
    assert row["spread_predicted_m"] > 0.0
    assert row["keepout_margin_m"] > 3.0


def test_operational_scenarios_are_compared_with_variants_of_the_same_seeds(tmp_path):
    keys = ["flights=3", f"comparison.variants={BOTH_LAWS}", "comparison.flights=2"]
    told = []
    given = ("sea_wind", *SLOW_STEPS, "flight.crossings=1", *keys)
    rows = flown(tmp_path / "run", *given, progress=lambda *report: told.append(report))
    # They take their time, too.
    assert told[1:] == [("flying", done, 7) for done in range(8)]
    variants = rows_of(tmp_path / "run", "comparison.csv")
    assert [row["variant"] for row in rows] == ["study"] * 3
    assert [row["variant"] for row in variants] == ["line_of_sight"] * 2 + ["lyapunov"] * 2
    same = [
        "seed",
        "nu",
        "wind_speed_mps",
        "wind_from_deg",
        "vessel_speed_mps",
        "start_distance_m",
        "start_aspect_deg",
    ]
    for number, variant in enumerate(variants):
        assert [variant[name] for name in same] == [rows[number % 2][name] for name in same]
        assert variant["flight_id"] == f"{variant['variant']}_{number % 2:05d}"
        assert variant["beside"] == rows[number % 2]["flight_id"]
    assert not any("beside" in row for row in rows)
    manifest = manifest_of(tmp_path / "run")
    assert manifest["flights_planned"] == 3
    study = load_study(given[0], given[1:])
    again = run_study(
        study,
        "sea_wind",
        tmp_path / "run",
        overrides=given[1:],
        executor_factory=InProcessExecutor,
        resume=True,
    )
    lines = [line for line in again.lines if "comparison" in line]
    for line, pair in zip(lines, (variants[:2], variants[2:]), strict=True):
        done = sum(row["outcome"] == "completed" for row in pair)
        assert line.startswith(
            f"  comparison {pair[0]['variant']}, not counted above: 2 planned, 2 flown, {done} completed"
        )


SAMPLED = (*SLOW_STEPS, "turbulence={}", "flights=4", "flight.duration_max_s=10", "histories=0")
TOO_SHORT = "not_settled"
WIND = '{key="wind.speed_mps", uniform=[0, 5]}'


def test_monte_carlo_samples_steering_laws_at_random(tmp_path):
    laws = '{key="guidance.law", choice=["cascade", "lyapunov"]}'
    rows = flown(
        tmp_path / "run", "monte_carlo", *SAMPLED, f"draws=[{WIND}, {laws}]", outcome=TOO_SHORT
    )
    inputs = rows_of(tmp_path / "run", "draws.csv")
    assert [row["flight_id"] for row in inputs] == [row["flight_id"] for row in rows]
    # A Sobol sequence halves every range evenly.
    assert sorted(row["guidance.law"] for row in inputs) == [
        "cascade",
        "cascade",
        "lyapunov",
        "lyapunov",
    ]
    assert (tmp_path / "run" / "statistics.json").is_file()


def test_monte_carlo_compares_steering_laws_at_the_same_points(tmp_path):
    compared = f"comparison.variants={BOTH_LAWS}"
    rows = flown(
        tmp_path / "run", "monte_carlo", *SAMPLED, f"draws=[{WIND}]", compared, outcome=TOO_SHORT
    )
    variants = rows_of(tmp_path / "run", "comparison.csv")
    assert len(rows) == 4
    for name in ("line_of_sight", "lyapunov"):
        of_variant = [row for row in variants if row["variant"] == name]
        assert [(row["seed"], row["wind_speed_mps"]) for row in of_variant] == [
            (r["seed"], r["wind_speed_mps"]) for r in rows
        ]
    assert {row["variant"] for row in rows_of(tmp_path / "run", "draws.csv")} == {
        "study",
        "line_of_sight",
        "lyapunov",
    }
