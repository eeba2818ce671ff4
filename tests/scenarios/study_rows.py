"""A made-up Monte Carlo study: rows as in ``summary.csv`` and inputs as in ``draws.csv``."""

import contextlib

import numpy as np
import pandas as pd
import pytest

RADIUS = 200.0
PREDICTED = 7.0


def study_rows(flights, seed=20261121):
    """Return rows and inputs of flights whose clearance falls with the wind, which it is the most,
    and with the turbulence.

    Nobody enters: the clearance is 8 m less up to 4 m of the wind's and 1 m of the turbulence's, at
    least 2 m.
    """
    generator = np.random.default_rng(seed)
    wind = generator.uniform(0.0, 10.0, flights)
    level = generator.choice(["none", "moderate"], flights)
    clearance = 8.0 - 0.4 * wind - (level == "moderate") - generator.uniform(0.0, 1.0, flights)
    flight_ids = [f"study_{i:05d}" for i in range(flights)]
    interval = PREDICTED * (1.0 + 0.001 * generator.standard_normal(flights))
    columns = {
        "flight_id": flight_ids, "trial": "study", "outcome": "completed",
        "mode_at_end": "tracking", "keepout_radius_m": RADIUS, "keepout_violations": 0,
        "min_distance_m": RADIUS + clearance, "crossing_interval_mean_s": interval,
        "crossing_interval_predicted_s": PREDICTED,
        "crossing_distance_min_m": RADIUS + clearance + 3.0,
        "crossing_clearance_min_m": clearance + 3.0, "tracking_error_rms_m": 0.1 + 0.05 * wind,
        "settling_time_s": generator.uniform(80.0, 140.0, flights),
    }  # fmt: skip
    rows = pd.DataFrame(columns)
    drawn = {"flight_id": flight_ids, "wind.speed_mps": wind, "turbulence.level": level}
    inputs = pd.DataFrame(drawn)
    return rows, inputs


@contextlib.contextmanager
def few_indices(*driven):
    """Ask of some figures alone what drives them, with 3 bootstraps: that takes nearly all of the
    time of study_statistics.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("scenarios.statistics.sensitivity.RESAMPLES", 3)
        patch.setattr("scenarios.statistics.estimates.DRIVEN", driven)
        yield
