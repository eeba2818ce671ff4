"""The table of the premises of the keep-out guard."""

import math

import pandas as pd
import pytest

from common.premises import TERMS, ratio_column
from scenarios.statistics.estimates import premise_table


def rows():
    """Return four flights of half an hour, two of them in turbulence."""
    found = pd.DataFrame(
        {
            "flight_id": ["a", "b", "c", "d"],
            "turbulence": ["none", "none", "light", "light"],
            "duration_s": 1800.0,
            **{ratio_column(term): math.nan for term in TERMS},
        }
    )
    found[ratio_column("wind")] = [0.1, 0.5, 0.4, 1.5]
    found[ratio_column("drift")] = [math.nan, 2.0, math.nan, math.nan]
    return found


def test_each_case_and_term_has_its_median_its_largest_and_what_is_to_be_expected():
    table = premise_table(rows(), ["calm", "calm", "gusty", "gusty"], per_hour=0.1)
    table = table.set_index(["case", "term"])
    # Terms without a ratio have no row.
    assert list(table.index) == [("calm", "wind"), ("calm", "drift"), ("gusty", "wind")]
    calm, gusty = table.loc[("calm", "wind")], table.loc[("gusty", "wind")]
    assert (calm["ratio_median"], calm["ratio_max"], calm["flight_id"]) == (0.3, 0.5, "b")
    assert (calm["flights_above"], calm["flights_above_expected"]) == (0, 0.0)
    # An hour in turbulence.
    assert (gusty["flights_above"], gusty["flights_above_expected"]) == (1, pytest.approx(0.1))
    assert table.loc[("calm", "drift"), "flights"] == 1
