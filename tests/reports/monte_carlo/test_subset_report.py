"""What a report shows of a subset simulation, of made-up ones with statistics as the study itself
writes them.
"""

import numpy as np
import pandas as pd
import pytest

from reports.document.blocks import Table
from reports.document.chart import Chart
from reports.monte_carlo.content import percent
from reports.monte_carlo.subset import subset_headline, subset_sections
from scenarios.measures.columns import DERIVED_COLUMNS
from scenarios.statistics.subset_simulation import input_shifts, near_event, subset_statistics
from tests.scenarios.statistics.rare_events import DIMENSION, linear, simulated
from tests.scenarios.study_rows import study_rows

REPEATS = 3

CLEARANCE = DERIVED_COLUMNS["clearance_m"]


def statistics_of(value, **settings):
    simulations = [
        simulated(value, [20261203, i], flights=100, **settings)[0] for i in range(REPEATS)
    ]
    first = np.concatenate([one.levels[0].points for one in simulations])
    near = np.concatenate(
        [one.levels[-1].points[chosen] for one, chosen in near_event(simulations)]
    )
    names = ["wind.speed_mps", *(f"input_{i}" for i in range(2, DIMENSION)), "turbulence.level"]
    frames = [pd.DataFrame(at, columns=names) for at in (first, near)]
    for frame in frames:
        frame["turbulence.level"] = np.where(frame["turbulence.level"] < 0.5, "none", "light")
    flown = sum(level.counts.evaluated for one in simulations for level in one.levels)
    return subset_statistics(
        study_rows(flown)[0], simulations, input_shifts(*frames, (first, near)), confidence=0.95
    )


@pytest.fixture(scope="module")
def reached():
    return statistics_of(linear(1e-6))


@pytest.fixture(scope="module")
def unreached():
    return statistics_of(linear(1e-12), levels=4)


def blocks_of(statistics, kind):
    return [
        block
        for section in subset_sections(statistics, {}, CLEARANCE)
        for block in section.blocks
        if isinstance(block, kind)
    ]


def test_the_headline_is_about_what_the_simulation_bounds(reached, unreached):
    found = reached["violation"]
    assert subset_headline(reached) == (
        f"Keep-out violation with a probability of {percent(found['estimate'])} in a flight, at most"
        f" {percent(found['pessimistic']['upper'])} at {percent(0.95)} confidence, by subset simulation"
    )
    assert subset_headline(unreached).startswith(
        "Subset simulation reached no keep-out violation: a probability of at most "
    )
    plain = unreached["violation"]["first_levels"]
    # Clopper and Pearson, none of 300: 1 - 0.05^(1/300) = 0.994 %.
    sections = subset_sections(unreached, {}, DERIVED_COLUMNS["clearance_m"])
    (table,) = (
        block for block in sections[0].blocks if isinstance(block, Table) and block.head[0] == "By"
    )
    assert table.rows[1][1:3] == ["300", "0"]
    assert table.rows[1][-1] == percent(plain["upper"])
    assert percent(plain["upper"]).startswith("0.994")


def test_the_curve_rises_with_the_distance_and_lies_within_its_band(reached):
    (curve,) = (chart for chart in blocks_of(reached, Chart) if chart.name == "rare-curve")
    lines = {line.label: line for line in curve.panels[0].lines}
    estimate, band = lines["estimate"], lines["interval"].y
    count = len(estimate.y)
    assert (band[:count] <= estimate.y).all()
    assert (estimate.y <= band[count:][::-1]).all()
    # From the event's probability, 1e-6 within the scatter of three small simulations, to that of
    # nearly all flights.
    assert 1e-8 < estimate.y[0] < 1e-4
    assert estimate.y[-1] > 0.5
