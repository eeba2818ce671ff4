"""Figures of a flight that searched for its plume, against its time history."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from report_parts import (
    assert_axes_read_quantity_and_unit,
    blocks_of,
    flown,
    named_charts,
    numbers_on_page_1,
)
from snapshots import assert_reads_as_before

from reports.document.blocks import Text
from reports.finding.search_view import search_view
from reports.finding.searches import _picked
from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=10",
    "reports.interval_s=[0,0]", "sensors={}", "start.place_m=[-250,-120]", "start.course_deg=-90",
    "wind.speed_mps=3", "wind.from_deg=40", "vessel.speed_mps=8", "emission.sulphur_percent=1.5", "emission.load=0.6",
    "payload.sensor=fast", "flight.altitude_m=60", "flight.after_settling_s=60",
    "following={source_height_m=[20.0, 60.0], load=[0.2, 0.9], climb_gradient=0.08, plume='estimated'}",
)  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return read_run(flown(tmp_path_factory, "sulphur", QUICK))


@pytest.fixture(scope="module")
def view(run):
    return search_view(run, run.summary.iloc[0])


def test_a_search_is_shown_in_height_and_in_cross_section(run):
    report = content(run)
    charts = {
        name: chart for name, chart in named_charts(report).items() if name.startswith("search-")
    }
    assert [name.rsplit("-", 1)[0].removeprefix("search-") for name in charts] == [
        "height-sulphur",
        "section-sulphur",
    ]
    assert_axes_read_quantity_and_unit(charts.values())
    (height, section) = charts.values()
    assert {"believed, 95 %", "believed, mean", "flown"} <= set(height.labels)
    assert section.scale_label == "CO2 read [ppm]"
    told = blocks_of(report, Text, "searches")[0].text
    assert told.startswith(
        f"Found {run.summary['time_to_find_s'].iloc[0]:.0f} s after the orbit was reached"
    )


def test_the_bands_are_the_modes_of_the_flight_without_gaps_in_each(run, view):
    modes = run.manifest["modes"]
    shown = sum(band.end - band.start for band in view.modes())
    known = {modes.index(band.label) for band in view.modes()}
    step = view.time[1] - view.time[0]
    # A band ends where the next mode begins: a sample less than there are of the last one.
    assert shown == pytest.approx(
        step * np.count_nonzero(view.history["mode"].isin(known)), abs=1.5 * step
    )
    # What it does once it has found the plume, most of the time, is not tinted.
    assert "searching" in {band.label for band in view.modes()}
    assert "found" not in {band.label for band in view.modes()}


def test_the_largest_reading_lies_within_the_plume_once_its_delay_is_taken_off(view):
    right, height, co2 = view.readings()
    x, y, across, up = view.true_plume()
    peak = int(np.argmax(co2))
    # At one moment the plume's centre is off its mean axis by its meander: three spreads hold both.
    assert math.hypot((right[peak] - x) / across, (height[peak] - y) / up) < 3.0
    assert len(right) == len(height) == len(co2)


def test_the_estimated_plume_is_that_of_the_time_history(view):
    _, height, across, up = view.estimated_plume()
    last = view.history.iloc[-1]
    assert (height, across, up) == tuple(
        last[name]
        for name in (
            "axis_height_estimated_m",
            "axis_spread_across_estimated_m",
            "axis_spread_estimated_m",
        )
    )


def test_the_true_axis_is_where_the_passes_cross_it(view):
    x, y, _, _ = view.true_plume()
    # Behind a ship that keeps her course the axis is where the apparent wind takes it: the model's
    # parcels are straight.
    assert x == pytest.approx(0.0, abs=1.0)
    last = view.history.iloc[view.crossings[-1]]
    assert y == last["altitude_m"] - last["plume_above_m"]


def test_a_flight_that_is_told_nothing_of_a_search_has_no_such_section(tmp_path_factory):
    run = read_run(
        flown(
            tmp_path_factory,
            "sulphur",
            (*QUICK, "following.plume=predicted", "flight.after_settling_s=20"),
        )
    )
    assert search_view(run, run.summary.iloc[0]) is None
    assert not {"searches", "finding"} & {section.anchor for section in content(run).sections}


@pytest.mark.parametrize(
    ("kept", "typical", "why"),
    [
        ([0, 3, 4], "3", "nearest to the median error"),
        ([2, 4], "2", "the median error"),
        ([4], "4", "nearest to the median error"),
    ],
)
def test_the_typical_search_is_at_the_median_of_all_errors_or_nearest_to_it(kept, typical, why):
    # Of these the median is 3 m, whichever of the flights have a time history.
    rows = pd.DataFrame(
        {"flight_id": list("01234"), "axis_height_error_3min_m": [-1.0, 2.0, 3.0, 3.5, -9.0]}
    )
    run = SimpleNamespace(
        with_history=lambda rows: rows["flight_id"].isin([str(i) for i in kept]).to_numpy()
    )
    picked = _picked(run, rows)
    assert picked[0][0]["flight_id"] == typical
    assert picked[0][1].startswith(why)
    # The largest error is that of the last flight, which is typical where it alone is left.
    assert [row["flight_id"] for row, _ in picked[1:]] == ["4"] * (typical != "4")


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    quick = [of for of in QUICK if not of.startswith(("start.place_m", "start.course_deg"))]
    variants = "comparison.variants=[{name='told', set={following={plume='told'}}}]"
    return flown(tmp_path_factory, "sulphur", (*quick, "flights=2", variants))


def test_page_1_says_in_how_many_flights_the_plume_was_found_beside_those_that_were_told(several):
    report = content(read_run(several))
    rows = read_run(several).summary
    found = rows["time_to_find_s"].notna().sum()
    assert report.verdict.headline.startswith(f"Plume found in {found} of 2 flights, median ")
    assert ", told " in report.verdict.headline
    assert report.verdict.cards[0][:2] == ("Flights that found the plume", f"{found} of 2")


def test_every_number_on_page_1_is_that_of_the_flights(several, tmp_path):
    run = read_run(several)
    times = run.summary["time_to_find_s"].fillna(math.inf).to_numpy()
    hits = [100.0 * of["hit_rate_found"].mean() for of in (run.summary, run.comparison)]
    verdict = run.verdict.whole
    closest = run.summary[run.summary["flight_id"] == verdict.closest.flight].iloc[0]
    known = {
        *(f"{time:.0f}" for time in (np.median(times), times.max())),
        *(f"{share:.3g}" for share in hits),
        *(f"{share:.4g}" for share in hits),
        f"{int(np.isfinite(times).sum())}",
        f"{closest['min_distance_m']:.1f}",
        f"{closest['horizontal_distance_min_m']:.1f}",
        f"{closest['keepout_radius_m']:g}",
        *(
            f"{getattr(verdict.counts, name)}"
            for name in ("kept_out", "beside", "completed", "done")
        ),
        # The time that a quantile is of, the time that is required, and the confidence of a bound.
        *("95", "300"),
    }
    failures = " ".join(content(run).verdict.failures)
    told = set(re.findall(r"\d+(?:\.\d+)?", failures))
    assert numbers_on_page_1(several, tmp_path) <= known | told


def test_a_search_for_the_plume_reads_as_before(several):
    assert_reads_as_before("search", content(read_run(several)))
