"""A design: what is judged, drawn, listed and said."""

import json
import math

import numpy as np
import pypdfium2
import pytest
from report_parts import blocks_of, built, numbers_on_page_1
from snapshots import assert_reads_as_before

from reports.build import build_reports
from reports.design.charts import disk_region, margin_chart, turned
from reports.design.data import bank_deg, complete, down, where
from reports.design.verdict import design_verdict
from reports.document.blocks import Table
from reports.errors import ReportError
from reports.registry import content
from reports.run.run_data import read_run
from tests.run_tables import write_manifest

pytestmark = pytest.mark.slow


MANIFEST = {
    "format": 1,
    "study": "design",
    "name": "x8",
    "title": "Autopilot of the X8",
    "overrides": [],
    "state": "complete",
    "config": {"aircraft": "x8", "altitude_m": 60.0, "description": "Designed at 60 m."},
    "git_revision": "ba78b23",
    "packages": {"numpy": "2.0", "jsbsim": "1.2.3"},
    "python": "3.11",
    "platform": "Linux x86_64",
    "wall_time_s": 61.2,
}


@pytest.fixture
def path(record, tmp_path):
    """A directory as the design command leaves it."""
    for file in ("aircraft/x8/x8.xml", "systems/x8_autopilot.xml", "scripts/x8.xml"):
        (tmp_path / "model" / file).parent.mkdir(parents=True)
        (tmp_path / "model" / file).write_text("<xml/>", encoding="utf-8")
    write_manifest(tmp_path, MANIFEST)
    (tmp_path / "innerloop.json").write_text(json.dumps(record), encoding="utf-8")
    return tmp_path


@pytest.fixture
def report(path):
    return content(read_run(path))


def test_both_reports_are_built_from_disk_alone_and_print_takes_six_pages(path):
    assert "Autopilot of the X8" in built(path)
    document = pypdfium2.PdfDocument(path / "report.pdf")
    assert len(document) <= 6
    document.close()


def test_the_margin_table_has_the_worst_of_each_loop_and_where(report, record):
    table = blocks_of(report, Table, "margins")[0]
    rows = {row[0]: row[1:] for row in table.rows}
    assert list(rows) == [loop.replace("_", " ") for loop in dict.fromkeys(
        row["loop"] for row in record["margins"]
    )]  # fmt: skip
    elevator = [row for row in record["margins"] if row["loop"] == "elevator"]
    for cell, key in ((0, "gain_db"), (2, "phase_deg")):
        least = min(elevator, key=lambda row: row[key])
        # Rounded down, never up to what is required.
        shown = f"{math.floor(10.0 * least[key]) / 10.0:.1f}"
        assert rows["elevator"][cell : cell + 2] == [shown, where(least)]
    # The throttle bears any gain; of all controls at once there are disk margins only.
    assert rows["throttle"][0] == "∞"
    assert (rows["all controls"][0], rows["all controls"][2]) == ("–", "–")


def test_curves_of_margins_are_the_worst_over_the_other_axis(record):
    design = complete(record)
    airspeeds, banks = (
        sorted({of(row) for row in record["margins"] if not row["between"]})
        for of in (lambda row: row["airspeed_mps"], bank_deg)
    )
    row = next(
        row
        for row in design["margins"]
        if row["loop"] == "aileron"
        and (row["airspeed_mps"], bank_deg(row)) == (airspeeds[3], banks[-2])
    )
    row["gain_db"] = 0.5
    chart = margin_chart(design)
    by_airspeed, by_bank = (
        next(line for line in chart.panels[i].lines if line.label == "aileron") for i in (0, 2)
    )
    for line, place in ((by_airspeed, airspeeds[3]), (by_bank, banks[-2])):
        assert line.y.min() == line.y[list(line.x).index(place)] == 0.5
        assert np.sum(line.y < 1.0) == 1


def test_a_disk_margin_of_6_db_keeps_a_loop_37_degrees_from_the_critical_point():
    phase, gain = disk_region(20.0 * math.log10(2.0))
    assert gain.max() == pytest.approx(20.0 * math.log10(2.0))
    assert gain.min() == pytest.approx(-20.0 * math.log10(2.0))
    # c = (2 - 1)/(2 + 1): 2 atan(1/3) = 36.87 deg, as Seiler, Packard and Gahinet print for a disk
    # of that gain. The outline has points every 2 degrees, and unit gain at a quarter turn is one
    # of them.
    quarter = np.argmin(np.abs(gain[:90]))
    assert abs(phase[quarter] + 180.0) == pytest.approx(36.87, abs=0.01)
    # Another form of the same: the margin is the least abs(1/(S - T)), and S - T = (1 - L)/(1 + L).
    loop = 10.0 ** (gain / 20.0) * np.exp(1j * np.radians(phase))
    assert np.abs((1.0 + loop) / (1.0 - loop)) == pytest.approx(1.0 / 3.0)


def test_a_phase_written_a_whole_turn_too_high_is_drawn_at_the_same_place(record):
    loop = record["loops"][0]
    higher = {**loop, "phase_deg": [phase + 360.0 for phase in loop["phase_deg"]]}
    assert turned(higher) == pytest.approx(turned(loop))
    assert -360.0 < turned(loop)[np.argmin(np.abs(loop["gain_db"]))] <= 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [("{", "holds no design record that can be read"), ('{"poles": []}', "is damaged")],
)
def test_a_damaged_design_is_refused_in_one_line(text, words, path):
    (path / "innerloop.json").write_text(text, encoding="utf-8")
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(path)
    assert "\n" not in str(refusal.value)


def test_every_number_on_page_1_is_that_of_the_record(path, record, tmp_path):
    design = record
    margins = [
        abs(math.floor(10.0 * row[key] + 1e-6) / 10.0)
        for row in [*design["margins"], *design["robustness"]]
        for key in ("gain_db", "phase_deg", "disk_gain_db", "disk_phase_deg")
        if row.get(key) is not None
    ]
    points = {
        (row["airspeed_mps"], round(math.degrees(row["bank_rad"]), 1)) for row in design["margins"]
    }
    flown, model = (
        next(
            r["overshoot"]
            for r in design["responses"]
            if (r["kind"], r["command"]) == (kind, "heading_rate")
        )
        for kind in ("flown", "model")
    )
    on_grid = {
        (row["airspeed_mps"], row["bank_rad"]) for row in design["margins"] if not row["between"]
    }
    expected = {
        *(f"{value:.1f}" for value in margins),
        *(f"{abs(value):g}" for point in points for value in point),
        *(f"{value:g}" for value in design["required"].values()),
        f"{len(on_grid)}",
        f"{len(points) - len(on_grid)}",
        f"{len({row['case'] for row in design['robustness'] if not row['periods_late']})}",
        f"{sum(bool(t['limits']) for t in design['trims'])}",
        f"{design['heading_rate_lag_s']:.2f}",
        f"{100.0 * max(0.0, flown - model):.1f}",
        # Per cent of the perturbations.
        "20",
    }
    assert numbers_on_page_1(path, tmp_path) <= expected


def test_a_design_reads_as_before(report):
    assert_reads_as_before("design", report)


POINTS = 75
"""Points of the X8's grid, 25, and between them and at its largest bank, 50."""


@pytest.fixture
def judged(record):
    """A function from changes of the first row of named lists to the verdict."""

    def judge(**rows):
        for name, change in rows.items():
            record[name][0] |= change
        return design_verdict(complete(record))

    return judge


def test_one_margin_too_small_is_named_and_never_rounded_up_to_what_is_required(judged, record):
    verdict = judged(margins={"gain_db": 5.96})
    assert (verdict.holds, verdict.complete) == (True, False)
    assert verdict.headline == "Stable everywhere, but short of 6 dB and 45° in elevator"
    at = where(record["margins"][0])
    assert verdict.failures == [
        f"elevator: gain margin 5.9 dB at {at}, required 6 dB; short at 1 of {POINTS} points"
    ]


def test_a_point_between_those_of_the_grid_counts_as_much(judged, record):
    row = next(row for row in record["margins"] if row["between"] and row["loop"] == "aileron")
    row["phase_deg"] = 44.0
    (failure,) = judged().failures
    assert failure.startswith(f"aileron: phase margin 44.0 deg at {where(row)}")


def test_a_perturbed_aircraft_that_falls_short_is_named(judged, record):
    verdict = judged(robustness={"phase_deg": 29.0})
    assert (verdict.holds, verdict.complete) == (True, False)
    # Less is required of it than of the aircraft as modelled.
    assert verdict.headline == (
        "Every loop has 6 dB and 45° everywhere, but is short of 4 dB and 30° under a perturbation"
    )
    (failure,) = verdict.failures
    assert failure.startswith(f"{record['robustness'][0]['case']}: phase margin 29.0 deg of ")
    assert failure.endswith("required 30 deg")


def test_a_limit_cycle_by_play_in_servos_is_said_with_period_and_amplitudes(judged, record):
    assert "play" not in judged().detail
    record["limit_cycle"] = {
        "is_flown": True, "period_s": 5.165, "altitude_m": 0.306, "bank_rad": 0.00494,
        "counted_from": {"altitude_m": 0.05, "bank_rad": 0.00175},
    }  # fmt: skip
    verdict = judged()
    # 0.00494 rad are 0.283 deg.
    assert "limit cycle of 5.2 s, altitude ±0.31 m and bank ±0.28°" in verdict.detail
    # It has no margin to meet: the design is judged as before.
    assert (verdict.holds, verdict.complete) == (True, True)
    record["limit_cycle"] |= {"is_flown": False, "period_s": None, "altitude_m": 0.02}
    assert "no sustained oscillation from 0.05 m" in judged().detail


def test_an_unstable_point_is_worse_than_any_margin(judged, record):
    verdict = judged(poles={"closed_loop": [[0.02, 0.0], [-1.0, 0.0]]})
    assert not verdict.holds
    assert verdict.headline == f"Unstable at 1 of {POINTS} points"
    assert verdict.failures[0] == f"unstable at {where(record['poles'][0])}"


def test_a_point_that_says_it_is_unstable_has_no_margin_to_show(judged, record):
    between = next(row for row in record["margins"] if row["between"])
    between["stable"] = False
    verdict = judged(robustness={"stable": False})
    assert not verdict.holds
    at, required = where(between), {"gain": "dB at", "phase": "deg at"}
    assert verdict.failures[0] == f"unstable at {at}"
    assert [failure.partition(", required")[0] for failure in verdict.failures[1:3]] == [
        f"{between['loop']}: {name} margin 0.0 {unit} {at}" for name, unit in required.items()
    ]
    assert verdict.failures[3].startswith(f"{record['robustness'][0]['case']}: unstable at 1 of")


@pytest.mark.parametrize(
    ("value", "text"), [(5.99, "5.9"), (5.7, "5.7"), (6.0, "6.0"), (-0.3, "−0.3"), (None, "∞")]
)
def test_margins_are_rounded_down(value, text):
    assert down(value) == text
