"""Figures of a flight that searched for its plume, against its time history."""

import math
import re

import numpy as np
import pytest
from report_parts import flown, numbers_on_page_1
from snapshots import assert_reads_as_before

from reports.finding.search_view import search_view
from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=10",
    "reports.interval_s=[0,0]", "sensors={}",
    "wind.speed_mps=3", "wind.from_deg=40", "vessel.speed_mps=8", "emission.sulphur_percent=1.5", "emission.load=0.6",
    "payload.sensor=fast", "flight.altitude_m=60", "flight.after_settling_s=30",
    "following={source_height_m=[20.0, 60.0], load=[0.2, 0.9], climb_gradient=0.08, plume='estimated'}",
)  # fmt: skip


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    variants = "comparison.variants=[{name='told', set={following={plume='told'}}}]"
    return flown(tmp_path_factory, "sulphur", (*QUICK, "flights=2", variants))


@pytest.fixture(scope="module")
def view(several):
    run = read_run(several)
    return search_view(run, run.summary.iloc[0])


def test_the_largest_reading_lies_within_the_plume_once_its_delay_is_taken_off(view):
    right, height, co2 = view.readings()
    x, y, across, up = view.true_plume()
    peak = int(np.argmax(co2))
    # At one moment the plume's centre is off its mean axis by its meander: three spreads hold both.
    assert math.hypot((right[peak] - x) / across, (height[peak] - y) / up) < 3.0
    assert len(right) == len(height) == len(co2)


def test_the_true_axis_is_where_the_passes_cross_it(view):
    x, y, _, _ = view.true_plume()
    # Behind a ship that keeps its course the axis is where the apparent wind takes it: the model's
    # parcels are straight.
    assert x == pytest.approx(0.0, abs=1.0)
    last = view.history.iloc[view.crossings[-1]]
    assert y == last["altitude_m"] - last["plume_above_m"]


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
    others = set(re.findall(r"\d+(?:\.\d+)?", failures))
    assert numbers_on_page_1(several, tmp_path) <= known | others


def test_a_search_for_the_plume_reads_as_before(several):
    assert_reads_as_before("search", content(read_run(several)))
