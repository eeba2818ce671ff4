"""The paper's three simulations (section V), on its kinematic vehicle and on the X8: the study
``paper``, flown once for this file.

The paper prints neither gains nor starts; tested are the numbers it publishes and what it says of
each figure.
"""

import json
import re

import numpy as np
import pandas as pd
import pytest

from reports.build import build_reports
from reports.document.blocks import Table
from reports.registry import content
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies import paper
from scenarios.studies.base import run_study
from tests.run_tables import rows_of

pytestmark = pytest.mark.slow

FEW_RESERVES = (0.0, 0.015, 0.2, 0.4, 0.6)
"""Of the reserves at which a run prices a guarantee: each takes a search of a tenth of a second."""

BOTH = pytest.mark.parametrize("fidelity", ["kinematic", "six_dof"])


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    path = tmp_path_factory.mktemp("paper") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paper, "SEARCH_STATES", 50_000)
        patch.setattr(paper, "RESERVES", FEW_RESERVES)
        result = run_study(load_study("paper"), "paper", path, executor_factory=InProcessExecutor)
    assert result.verdict.counts.planned == result.verdict.counts.done == len(rows_of(path)) == 8
    assert all(row["criteria_met"] for row in rows_of(path))
    return path


@pytest.fixture(scope="module")
def rows(directory):
    return {row["flight_id"]: row for _, row in pd.read_csv(directory / "summary.csv").iterrows()}


@pytest.fixture
def history(directory):
    return lambda flight_id: pd.read_parquet(directory / "flights" / f"{flight_id}.parquet")


def distance(history):
    return np.hypot(
        history["reference_north_m"] - history["north_m"],
        history["reference_east_m"] - history["east_m"],
    ).to_numpy()


@pytest.mark.parametrize(("fidelity", "share"), [("kinematic", 0.005), ("six_dof", 0.02)])
def test_sim_3_crosses_every_9_5_s_at_214_m_and_never_enters_the_keep_out_area(
    rows, fidelity, share
):
    # Section V, to the 0.5 % kinematic and 2 % in six degrees of freedom. Figure 9: never
    # inside 200 m.
    row = rows[f"sim3_{fidelity}"]
    assert row["crossing_interval_mean_s"] == pytest.approx(9.5, rel=share)
    assert row["crossing_distance_mean_m"] == pytest.approx(214.0, rel=share)
    assert row["keepout_violations"] == 0
    assert row["min_distance_m"] >= 200.0


@pytest.mark.parametrize("case", ["sim1", "sim2_delta"])
def test_sims_1_and_2_end_on_the_reference(rows, case):
    # Issue: below 0.1 m at the end, kinematic. The X8 gets there too: on a circle nothing changes
    # any more.
    assert rows[f"{case}_kinematic"]["tracking_error_end_m"] < 0.1
    assert rows[f"{case}_six_dof"]["tracking_error_end_m"] < 0.1


@BOTH
def test_sim_1_is_figures_4_and_5(history, fidelity):
    flown = history(f"sim1_{fidelity}")
    phi, phi_r, d = (
        np.abs(flown["phi_rad"].to_numpy()),
        np.abs(flown["phi_r_rad"].to_numpy()),
        distance(flown),
    )
    # The headings are opposite at first; phi goes to zero before phi_r and the distance do.
    assert phi[0] > 1.5
    assert np.nonzero(phi > 0.05)[0][-1] < np.nonzero(phi_r > 0.05)[0][-1]
    # Equation (35): while |phi| <= |phi_r| the distance does not rise, before it does. With the X8
    # the relation is that of its actual course, which slips by its airspeed error, 0.05 m/s: over a
    # sample of 0.1 s that is 5 mm.
    rises = np.diff(d)
    inside = np.maximum(phi[:-1], phi[1:]) <= np.minimum(phi_r[:-1], phi_r[1:])
    assert np.max(rises[inside]) <= (1e-9 if fidelity == "kinematic" else 5e-3)
    assert np.sum(rises[~inside & (rises > 0.0)]) > 10.0


def test_sim_1_has_saddle_points_where_phi_and_phi_r_vanish_together(history):
    flown = history("sim1_kinematic")
    settled = flown[flown["time_s"] > 60.0]
    phi, phi_r, d = (
        settled["phi_rad"].to_numpy(),
        settled["phi_r_rad"].to_numpy(),
        distance(settled),
    )
    zeros = np.nonzero(phi_r[:-1] * phi_r[1:] < 0.0)[0]
    # Figure 5: a row of them. phi is gone by 60 s; the distance falls before and after, and its
    # slope vanishes in between: V_1-dot = -V (rho + delta)(1 - cos phi_r), equation (33).
    assert np.max(np.abs(phi)) < 1e-3
    assert len(zeros) >= 5
    slope = np.gradient(d, settled["time_s"].to_numpy())
    for i in zeros[:5]:
        assert abs(slope[i]) < 0.05 * np.max(np.abs(slope[max(0, i - 80) : i + 80]))


@BOTH
def test_sim_2_the_delta_law_stays_within_omega_max_and_the_line_of_sight_does_not(rows, fidelity):
    # Figure 7. What the laws ask for, before any limit.
    delta, line_of_sight = rows[f"sim2_delta_{fidelity}"], rows[f"sim2_los_{fidelity}"]
    assert delta["heading_rate_demand_max_rad_s"] <= 0.503
    assert delta["heading_rate_demand_max_rad_s"] <= delta["heading_rate_bound_rad_s"] <= 0.503
    assert line_of_sight["heading_rate_demand_max_rad_s"] > 2.0 * 0.503


def test_sim_2_the_line_of_sight_is_near_sooner_but_never_on_the_reference(history, rows):
    # Section V: "despite the fast convergence of UAV 1".
    near = {
        name: np.nonzero(distance(history(f"sim2_{name}_kinematic")) > 30.0)[0][-1]
        for name in ("los", "delta")
    }
    assert near["los"] < near["delta"]
    assert rows["sim2_los_kinematic"]["tracking_error_end_m"] > 10.0


def test_bounds_stand_beside_the_worst_states_found(directory, rows):
    assert paper.SEARCH_STATES >= 1_000_000
    assert set(FEW_RESERVES) < set(paper.RESERVES)
    record = json.loads((directory / "bounds.json").read_text(encoding="utf-8"))
    assert record["samples"] == 50_000
    for row in record["flown"]:
        # Never exceeded, and tight: see docs/actuation_bounds.md.
        assert (
            row["largest_found_rad_s"] <= row["bound_rad_s"] <= 1.001 * row["largest_found_rad_s"]
        )
        if row["tuning"] == "bounded":
            assert row["bound_rad_s"] <= row["heading_rate_max_rad_s"]
        # The bound is for a speed that no flight exceeds; rounding of a hypotenuse.
        for flight_id in row["flights"]:
            assert rows[flight_id]["speed_max_mps"] <= row["speed_mps"] * (1.0 + 1e-12)
    assert any(row["flights"] for row in record["flown"])
    by_reserve = {row["reserve"]: row for row in record["guaranteed"]}
    # A reference that spends all of omega_max leaves no bound; every reserve that does has a price
    # that falls.
    assert "more of omega_max in reserve" in by_reserve[0.0]["message"]
    times = [
        row["convergence_time_s"] for row in record["guaranteed"] if "convergence_time_s" in row
    ]
    assert times == sorted(times, reverse=True)


@pytest.mark.usefixtures("sketched")
def test_its_report_has_every_figure_for_both_vehicles_and_every_published_number(directory, rows):
    html, pdf = build_reports(directory)
    assert pdf.read_bytes().startswith(b"%PDF")
    report = content(read_run(directory))
    # Its line of sight stays behind for good.
    assert "8 of the 9 numbers and statements of section V" in report.verdict.headline
    assert "not: the line of sight converges fast (" in report.verdict.headline
    assert report.verdict.tone == "warn"
    assert "not reproduced" in html.read_text(encoding="utf-8")
    blocks = [block for section in report.sections for block in section.blocks]
    charts = {block.name: block for block in blocks if hasattr(block, "panels")}
    # Figures 3 to 9 of the paper, each on the kinematic vehicle and on the aircraft.
    for number in range(3, 10):
        assert len(charts[f"fig{number}"].panels) == 2
        for panel in charts[f"fig{number}"].panels:
            assert re.fullmatch(r".+ \[[^\]]+\]", panel.x_label)
            assert all(np.isfinite(line.y).all() and len(line.y) for line in panel.lines)
    (section,) = (section for section in report.sections if section.anchor == "numbers")
    numbers = {
        row[1]: row[2:]
        for row in next(block for block in section.blocks if isinstance(block, Table)).rows
    }
    # Beside the printed number the reproduced ones, as in the summary.
    for what, printed, column in (
        ("smoke plume measurements every", "9.5 s", "crossing_interval_mean_s"),
        ("distance from the vessel there", "214 m", "crossing_distance_mean_m"),
    ):
        cells = numbers[what]
        assert cells[0] == printed
        for cell, fidelity in zip(cells[1:3], ("kinematic", "six_dof"), strict=True):
            # Printed to two to four digits.
            assert float(cell.split()[0]) == pytest.approx(
                rows[f"sim3_{fidelity}"][column], rel=1e-4
            )
