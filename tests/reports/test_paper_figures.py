"""Figures of the paper's study, made of flights of another one."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from common.run_layout import time_history_path
from reports.paper.content import sim_3_charts
from reports.run.run_data import read_run
from reports.run.time_history import keepout_distance

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def sim_3(small_run, tmp_path_factory):
    """Return a run whose only flight is called as the paper's third simulation."""
    run = read_run(shutil.copytree(small_run, tmp_path_factory.mktemp("paper") / "run"))
    config = json.loads(json.dumps(run.manifest["trials"]["steady"]))
    history = run.history("steady_00000")
    # Well above the funnel's mouth, so that a sphere's distance is another than a cylinder's.
    raised = history.assign(altitude_m=history["altitude_m"] + 60.0)
    raised.to_parquet(run.path / time_history_path("sim3_kinematic"))
    tables = {name: getattr(run, name) for name in ("summary", "crossings")}
    tables = {
        name: rows[rows["flight_id"] == "steady_00000"].assign(flight_id="sim3_kinematic")
        for name, rows in tables.items()
    }
    return replace(run, manifest=run.manifest | {"config": config}, **tables)


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
def test_figure_9_shows_the_distance_that_the_keep_out_area_is_about(sim_3, shape):
    sim_3 = replace(sim_3, overrides={"sim3_kinematic": {"keepout.shape": shape}})
    figure_9 = sim_3_charts(sim_3)[1]
    _, flown, crossed = figure_9.panels[0].lines
    history = sim_3.history("sim3_kinematic")
    config = sim_3.manifest["config"] | {"keepout": {"shape": shape}}
    expected = np.interp(flown.x, history["time_s"], keepout_distance(history, config))
    assert flown.y == pytest.approx(expected, abs=1e-9)
    # As the flight was flown it crossed at the height of the mouth, where both distances are one.
    table = sim_3.crossings_of("sim3_kinematic")["distance_m"].to_numpy()
    assert crossed.y == pytest.approx(table, abs=0.1)
    on_curve = np.interp(crossed.x, flown.x, flown.y)
    # 200 m and more away, and 60 m higher. Within 0.2 s it turns.
    assert (
        (np.abs(on_curve - crossed.y).max() < 0.5)
        if shape == "cylinder"
        else (on_curve - crossed.y).min() > 5.0
    )
