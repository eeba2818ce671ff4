"""What many measured flights show of the method."""

import numpy as np
import pandas as pd
import pytest

from scenarios.statistics.sulphur import COLUMNS, sulphur_statistics


def rows(errors, *, deviation=0.02, sensor="electrochemical", fuel=0.1, verdicts=None):
    expected = 0.972 * fuel
    found = expected + np.asarray(errors)
    table = pd.DataFrame(index=range(len(found)), columns=list(COLUMNS), dtype=object)
    table["flight_id"], table["seed"] = [f"a_{i}" for i in range(len(found))], range(len(found))
    table["sensor"], table["fsc_fuel_percent"], table["fsc_expected_percent"] = (
        sensor,
        fuel,
        expected,
    )
    table["sulphur_limit_percent"] = 0.1
    table["sulphur_verdict"] = verdicts or ["open"] * len(found)
    table["verdict_2min"] = "open"
    table["fsc_percent"], table["fsc_uncertainty_percent"], table["fsc_noise_percent"] = (
        found,
        deviation,
        0.5 * deviation,
    )
    table["fsc_low_percent"], table["fsc_high_percent"] = (
        found - 1.96 * deviation,
        found + 1.96 * deviation,
    )
    return table


def test_bias_spread_and_coverage_are_those_of_the_errors():
    errors = np.array([0.01, -0.03, 0.05, 0.01])
    found = sulphur_statistics(rows(errors), confidence=0.95)
    (entry,) = found["accuracy"]
    assert (entry["sensor"], entry["method"], entry["flights"]) == (
        "electrochemical",
        "regression",
        4,
    )
    assert entry["bias_percent"] == pytest.approx(0.01)
    assert entry["bias_relative"] == pytest.approx(0.01 / 0.0972)
    assert entry["spread_percent"] == pytest.approx(np.std(errors, ddof=1))
    # 0.05 alone lies beyond 1.96 times 0.02.
    assert entry["coverage"] == 0.75
    # Clopper and Pearson's interval of 3 of 4.
    assert entry["coverage_interval"] == pytest.approx([0.1941, 0.9937], abs=1e-4)


def test_sensors_are_apart_and_fuels_are_points_of_the_operating_curve():
    table = pd.concat([
        rows([0.0, 0.0], fuel=0.1, verdicts=["open", "below"]),
        rows([0.0, 0.0], fuel=0.5, verdicts=["above", "above"]),
        rows([0.0], sensor="fast", fuel=0.5, verdicts=["above"]),
    ])  # fmt: skip
    found = sulphur_statistics(table, confidence=0.9)
    curve = {
        (entry["sensor"], entry["fsc_fuel_percent"]): (entry["above"], entry["open"])
        for entry in found["operating_curve"]
    }
    assert curve == {
        ("electrochemical", 0.1): (0.0, 0.5),
        ("electrochemical", 0.5): (1.0, 0.0),
        ("fast", 0.5): (1.0, 0.0),
    }
    whole = [entry for entry in found["accuracy"] if entry["fsc_fuel_percent"] is None]
    assert {entry["sensor"]: entry["flights"] for entry in whole} == {
        "electrochemical": 4,
        "fast": 1,
    }


def test_flights_of_one_seed_are_one_sample():
    errors = np.array([0.01, -0.03, 0.05, 0.01])
    points = [
        rows(errors, fuel=fuel, verdicts=["above", "above", "open", "above"])
        for fuel in (0.08, 0.1, 0.12)
    ]
    swept = sulphur_statistics(pd.concat(points, ignore_index=True), confidence=0.95)
    (alone,) = sulphur_statistics(points[0], confidence=0.95)["accuracy"]
    whole, *of_fuels = swept["accuracy"]
    # The same four sniffers at three fuels say no more of the method than at one; each fuel by
    # itself says as much as before.
    for entry in (whole, *of_fuels):
        assert (
            entry["coverage_interval"]
            == alone["coverage_interval"]
            == pytest.approx([0.1941, 0.9937], abs=1e-4)
        )
        assert entry["bias_standard_error_percent"] == pytest.approx(
            alone["bias_standard_error_percent"]
        )
    assert (whole["flights"], whole["coverage"]) == (12, 0.75)
    assert all(
        entry["above_interval"] == alone["coverage_interval"] for entry in swept["operating_curve"]
    )
