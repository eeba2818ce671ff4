"""The report of flights with a sniffer: one as a client reads it, several as a method is judged."""

import base64
import json
import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from report_parts import assert_axes_read_quantity_and_unit, flown, named_charts, numbers_on_page_1
from scipy.stats import beta

from reports.document.blocks import Table
from reports.measurement import flights, method
from reports.measurement.data import flown_facts
from reports.registry import content
from reports.render import plotly_charts
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=10",
    "reports.interval_s=[0,0]", "sensors={}", "following={}", "start.place_m=[-250,-120]",
    "start.course_deg=-90", "wind.speed_mps=2", "wind.from_deg=0", "vessel.speed_mps=10", "flight.after_settling_s=40",
)  # fmt: skip


@pytest.fixture(scope="module")
def several_path(tmp_path_factory):
    sweeps = (
        'sweep.payload.sensor=["fast","laser"]',
        "sweep.emission.sulphur_percent=[0.05,0.1,0.5]",
        "sweep.guidance.bank_deg=[45]",
        "flights=1",
    )
    return flown(tmp_path_factory, "sulphur", (*QUICK, *sweeps))


@pytest.fixture(scope="module")
def several(several_path):
    with pytest.MonkeyPatch.context() as patch:
        # Of each fuel and sensor one flight: too few for a curve that anybody is to read.
        patch.setattr("reports.measurement.method._FEW", 6)
        patch.setattr("reports.measurement.method._OF_EACH_MIN", 1)
        return content(read_run(several_path))


def test_several_flights_are_judged_as_a_method(several):
    charts = named_charts(several)
    assert {"sulphur-errors", "operating-curve", "sulphur-trajectory"} <= set(charts)
    assert_axes_read_quantity_and_unit(charts.values())
    (section,) = [section for section in several.sections if section.anchor == "sulphur"]
    verdicts, accuracy, calls, hits = [
        block for block in section.blocks if isinstance(block, Table)
    ]
    assert [row[:2] for row in verdicts.rows] == [["0.1", "fast"], ["0.1", "laser"]]
    assert sum(int(cell) for row in verdicts.rows for cell in row[2:]) == 6
    assert [row[:3] for row in accuracy.rows] == [
        ["fast", "equalise and regress", "3"], ["fast", "areas of passes", "3"],
        ["laser", "equalise and regress", "3"], ["laser", "areas of passes", "3"],
    ]  # fmt: skip
    fuels = [(row[0], row[1], row[4]) for row in calls.rows]
    # 0.05 % is never above 0.1 %, and 0.5 % always is, with the noise of these sensors.
    assert ("laser", "0.05", "0\N{NO-BREAK SPACE}%") in fuels
    assert ("laser", "0.5", "100\N{NO-BREAK SPACE}%") in fuels
    assert any(
        row[0].startswith("Crossings of the plume's mean axis, with smoke or without")
        for row in hits.rows
    )
    names = [card.name for card in several.verdict.cards]
    assert {"Relative error, fast, median", "Relative error, laser, median"} <= set(names)
    (fact,) = several.facts
    # Titles of measurement/sniffer/presets/*.toml.
    assert re.fullmatch(r".+ \(fast\); .+ \(laser\)", fact.value)


def test_every_number_on_page_1_of_several_flights_is_that_of_the_summary(several_path, tmp_path):
    rows = pd.read_csv(several_path / "summary.csv")
    verdict = json.loads((several_path / "verdict.json").read_text(encoding="utf-8"))
    called, expected = rows["sulphur_verdict"], rows["fsc_expected_percent"]
    above = rows["fsc_fuel_percent"] > rows["sulphur_limit_percent"]
    right = ((called == "above") & above) | ((called == "below") & ~above)
    decided = called != "open"
    held = rows["fsc_low_percent"].le(expected) & expected.le(rows["fsc_high_percent"])
    errors = (rows["fsc_percent"] / expected - 1.0).abs().groupby(rows["sensor"])
    # Exact upper limit of a proportion with no event, or with some (Clopper and Pearson).
    wrong = int((decided & ~right).sum())
    most = beta.ppf(0.975, wrong + 1, int(decided.sum()) - wrong)
    counts = verdict["whole"]["counts"]
    known = {
        *(f"{len(of)}" for of in (rows, rows[decided], rows[~decided], rows[held], rows[right])),
        f"{wrong}",
        *(f"{100.0 * error:.3g}" for error in (*errors.median(), *errors.max())),
        f"{100.0 * most:.3g}",
        *(f"{counts[name]}" for name in ("kept_out", "completed", "done", "planned")),
        # Confidence, the limit, and that no flight is without a result.
        *("95", "0.10", "0"),
    }
    failures = set(
        re.findall(r"\d+(?:\.\d+)?", " ".join(content(read_run(several_path)).verdict.failures))
    )
    assert numbers_on_page_1(several_path, tmp_path) <= known | failures


def test_a_verdict_is_right_or_wrong_by_the_fuel_that_was_simulated():
    fuels = [(0.5, "above"), (0.1, "below"), (0.1, "above"), (0.5, "below"), (0.5, "open")]
    rows = [{**ROW, "fsc_fuel_percent": fuel, "sulphur_verdict": called} for fuel, called in fuels]
    rows.append({**ROW, "fsc_percent": float("nan"), "sulphur_verdict": "open"})
    run = SimpleNamespace(summary=pd.DataFrame(rows))
    assert flights.sulphur_headline(run) == (
        "Verdicts on the sulphur limit from 6 flights: 2 right, 2 wrong, 1 open, 1 without a result"
    )


ROW = {
    "fsc_percent": 0.5, "fsc_low_percent": 0.461, "fsc_high_percent": 0.539, "sulphur_limit_percent": 0.1, "probability_above": 1.0,
    "sulphur_verdict": "above", "sulphur_quality": "A", "sulphur_reason": "", "fsc_fuel_percent": 0.5, "fsc_expected_percent": 0.49,
    "duration_s": 600.0, "sensor": "fast",
}  # fmt: skip
"""Of a flight that measured the fuel, in the summary."""


@pytest.mark.parametrize(
    ("called", "judgement", "tone"),
    [
        ("above", "✗ above the limit of 0.10 %", "missed"),
        ("below", "✓ below the limit of 0.10 %", "met"),
        ("open", "? not shown to be above or below the limit of 0.10 %", "open"),
    ],
)
def test_the_tile_of_a_verdict_has_a_colour_of_its_own_and_only_below_is_green(
    called, judgement, tone
):
    row = {**ROW, "fsc_percent": 0.1, "sulphur_verdict": called, "probability_above": 0.5}
    run = SimpleNamespace(summary=pd.DataFrame([row]))
    card = flights.sulphur_cards(run)[1]
    assert (card.judgement.replace("\N{NO-BREAK SPACE}", " "), card.tone) == (judgement, tone)
    assert flights.sulphur_below(run) == (called == "below")
    words = {"above": "Above the limit", "below": "Below the limit", "open": "Inconclusive"}
    assert flights.sulphur_headline(run).startswith(f"{words[called]}: fuel sulphur 0.100 % (")


def test_a_sniffer_without_a_result_is_said_on_page_1():
    run = SimpleNamespace(
        summary=pd.DataFrame([{"fsc_percent": float("nan"), "duration_s": 600.0}])
    )
    assert flights.sulphur_headline(run) == "No fuel sulphur content from 1 flight with a sniffer"
    run.summary["sulphur_reason"] = "no pass through a plume"
    assert (
        flights.sulphur_headline(run)
        == "No fuel sulphur content from 1 flight with a sniffer: no pass through a plume"
    )
    # All is left to be said of the fuel: not green.
    assert not flights.sulphur_below(run)
    assert flights.sulphur_below(SimpleNamespace(summary=pd.DataFrame([{"duration_s": 600.0}])))


@pytest.mark.parametrize(
    ("own", "minutes"),
    [(None, [4.0, 9.0]), (60.0, [1.0, 1.0]), ("swept", [1.0, 2.25]), (600.0, [6.0, 10.0])],
)
def test_noise_of_a_minute_follows_from_the_time_that_was_evaluated(own, minutes):
    """Flights of 6 and 11 minutes settle after 2; the last ``flight.measured_s`` may be all that is
    evaluated [min].
    """
    rows = pd.DataFrame({
        "flight_id": ["a", "b"], "trial": "t", "sensor": "fast", "duration_s": [360.0, 660.0], "settling_time_s": 120.0,
        "fsc_noise_percent": 0.02, "areas_fsc_noise_percent": 0.03, "fsc_expected_percent": 0.1, "fsc_percent": 0.1,
        "areas_fsc_percent": 0.1, "nu": 0.5, "crossing_interval_mean_s": 6.0, "crossing_distance_mean_m": 260.0,
    })  # fmt: skip
    values = zip(rows["flight_id"], (60.0, 135.0), strict=True)
    swept = {name: {"flight.measured_s": value} for name, value in values}
    run = SimpleNamespace(
        manifest={"trials": {"t": {"flight": {"measured_s": None if own == "swept" else own}}}},
        draws=pd.DataFrame({"flight_id": ["a", "b"], "guidance.bank_deg": 30.0}),
        overrides=swept if own == "swept" else {},
    )
    regression, areas = (
        panel.lines[0].y for panel in method.trajectory_chart(run, rows).panels[:2]
    )
    assert regression == pytest.approx(0.02 * np.sqrt(minutes))
    assert areas == pytest.approx(0.03 * np.sqrt(minutes))


def test_page_1_has_place_and_time_where_the_scenario_has_them():
    rows = pd.DataFrame({
        "sensor": ["fast", "fast", None], "duration_s": [600.0, 700.0, 9000.0], "start_utc": ["2026-06-01T10:00:00Z"] * 3,
        "place_latitude_deg": [56.9, 56.9, 1.0], "place_longitude_deg": [11.5, 11.5, 1.0],
    })  # fmt: skip
    found = dict(flown_facts(SimpleNamespace(summary=rows)))
    assert found["Place"] == "56.90000° N, 11.50000° E (the ship at time 0, by the scenario)"
    # The longer one of the flights that measured takes 11 min 40 s.
    assert found["Time (UTC)"] == "2026-06-01 10:00:00 to 10:11:40 UTC (by the scenario)"
    found = dict(
        flown_facts(SimpleNamespace(summary=rows.assign(place_latitude_deg=[56.9, 57.0, 1.0])))
    )
    assert (
        found["Place"]
        == "56.90000° N, 11.50000° E, and 1 more (the ship at time 0, by the scenario)"
    )
    # Beside a ship from AIS flights have place and time even without a sniffer; beside others they
    # have no facts.
    without = rows.drop(columns=["sensor"])
    assert {"Place", "Time (UTC)"} == dict(flown_facts(SimpleNamespace(summary=without))).keys()
    assert not flown_facts(SimpleNamespace(summary=without[["duration_s"]]))


def test_error_bars_are_the_intervals_and_not_symmetric_where_these_are_cut():
    rows = pd.DataFrame(
        {
            "sensor": ["fast"],
            "fsc_expected_percent": [0.01],
            "fsc_percent": [0.01],
            "areas_fsc_percent": [-0.01],
        }
    )
    for of, low, high in (("fsc", 0.0, 0.03), ("areas_fsc", 0.0, 0.02)):
        rows = rows.assign(**{f"{of}_low_percent": low, f"{of}_high_percent": high})
    chart = method.error_chart(rows)
    bars = [panel.lines[0].error.ravel() for panel in chart.panels]
    np.testing.assert_allclose(bars, [[0.01, 0.02], [0.0, 0.03]], atol=1e-12)
    drawn = plotly_charts.draw(chart)["panels"][0]["data"][0]["error_y"]
    assert [
        np.frombuffer(base64.b64decode(drawn[end]["bdata"]), dtype="<f4")[0]
        for end in ("arrayminus", "array")
    ] == (pytest.approx([0.01, 0.02]))


def _results(expected, found):
    columns = {"fsc_expected_percent": expected, "sensor": "fast"}
    for of in ("fsc", "areas_fsc"):
        columns |= {
            f"{of}_percent": found,
            f"{of}_low_percent": 0.0,
            f"{of}_high_percent": np.abs(found) + 0.02,
        }
    return pd.DataFrame(columns)


def test_results_below_a_logarithmic_scale_stand_at_its_edge_and_are_counted():
    chart = method.error_chart(_results([0.05, 0.1, 1.0], [-0.02, 0.001, 1.0]))
    assert "results below the scale, 2 by regression, 2 by areas" in chart.caption
    for panel in chart.panels:
        inside, below, _ = panel.lines
        assert (list(inside.x), list(below.x)) == ([1.0], [0.05, 0.1])
        assert all(panel.y_range[0] < y < 1.2 * panel.y_range[0] for y in below.y)
        # What reaches from the edge up is the interval that the flight states.
        np.testing.assert_allclose((below.y + below.error[1]), [0.04, 0.021])
