"""The tables of docs/actuation_bounds.md hold what is computed."""

import re
from pathlib import Path

import numpy as np
import pytest
from bounds_cases import LIMIT, fastest, largest_head_on
from gnc_cases import SPEED

from gnc.analysis.bounds import heading_rate_bound
from gnc.analysis.worst_case_search import largest_heading_rate
from gnc.errors import InfeasibleError
from gnc.paper import look_ahead

DOCS = (Path(__file__).parents[3] / "docs" / "actuation_bounds.md").read_text(encoding="utf-8")


def rows_of(heading):
    """Return the cells of the table under a heading of the documentation, without its head."""
    section = DOCS.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in section.splitlines()
        if re.match(r"\|\s*[\d.]", line)
    ]


def test_the_documentation_prints_the_tightness_that_is_computed():
    rows = rows_of("How tight it is")
    assert len(rows) >= 7
    for row in rows:
        epsilon, radius, turn, steering_max = (float(cell) for cell in row[:4])
        design = {"speed": SPEED, "reference_heading_rate_max": turn, "steering_max": steering_max}
        parameters, generator = look_ahead(epsilon, radius), np.random.default_rng(1)
        found = largest_heading_rate(
            parameters, **design, gain=1.5, samples=10_000, generator=generator
        )
        bound = heading_rate_bound(parameters, **design)
        least = largest_head_on(parameters, **design, gain=1.5)
        # As printed, which another machine's rounding may change by one in the last digit.
        assert [float(cell) for cell in row[4:7]] == pytest.approx(
            [least, found, bound], rel=0.0, abs=2e-4
        )
        assert float(row[7]) == pytest.approx(bound / found, rel=0.0, abs=2e-5)


def test_the_documentation_prints_the_costs_that_are_computed():
    rows = rows_of("What a guarantee costs")
    assert len(rows) >= 7
    for row in rows:
        turn = float(row[1])
        if "infeasible" in row[7]:
            with pytest.raises(InfeasibleError):
                fastest(1.0 - turn / LIMIT)
            continue
        found = fastest(1.0 - turn / LIMIT)
        epsilon, radius, steering_max, bound, duration = (float(cell) for cell in row[2:7])
        # Printed to three or four digits; the search stops at 1e-4 of its shares, and time is flat
        # there.
        assert (epsilon, radius, steering_max) == pytest.approx(
            (*found.look_ahead, found.steering_max), rel=5e-3
        )
        assert (bound, duration) == pytest.approx((found.bound, found.convergence_time), rel=1e-3)
        assert float(row[0]) == pytest.approx(100.0 * (1.0 - turn / LIMIT), abs=0.06)
