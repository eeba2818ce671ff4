"""A keep-out area that is small beside the turn radius, and a law that flies at the ship: flights
had come within r_min.
"""

import pytest
import study_runs

pytestmark = pytest.mark.slow


def flown(tmp_path, *overrides):
    """Return the rows of flights of ``sea_wind`` whose law flies at the ship."""
    keys = ["draws=[]", "flight.crossings=0", *study_runs.AT_THE_SHIP, *overrides]
    return study_runs.flown(tmp_path / "run", "sea_wind", *keys)


@pytest.mark.parametrize(("airspeed", "radius"), [(200, 200), (50, 10)])
def test_a_turn_radius_of_twenty_times_r_min(tmp_path, airspeed, radius):
    # 4 of 4 had come in, by up to 12 and 1.7 m: predicted turns led through the area between two of
    # their points.
    turn = airspeed**2 / 9.81
    rows = flown(
        tmp_path, "fidelity=kinematic", "kinematic.heading_rate_lag_s=0.2", f"guidance.airspeed_mps={airspeed}", "flights=4",
        f"keepout.radius_m={radius}", f"reference.standoff_radius_m={6.0 * turn}", f"start.distance_m=[{turn},{5.0 * turn}]",
        "vessel.speed_mps=7.1", f"flight.duration_max_s={12.0 * turn / airspeed}",
    )  # fmt: skip
    assert (rows["min_distance_m"] >= rows["keepout_radius_m"]).all()
    assert rows["guard_lost_s"].sum() == 0.0
    assert rows["guard_interventions"].sum() > 0


@pytest.mark.parametrize("seed", [1, 3])
def test_a_vehicle_that_lags_and_slows_down_at_once_beside_a_small_area(tmp_path, seed):
    # 3 of 4 had come in, by up to 0.33 m: a turn at V_r was predicted from where the fast vehicle
    # is when the turn begins.
    rows = flown(
        tmp_path, "fidelity=kinematic", "kinematic.heading_rate_lag_s=0.76", "guidance.rate_hz=5", "flight.log_rate_hz=5",
        "keepout.radius_m=40.2", "guidance.airspeed_mps=19.42", "reference.standoff_radius_m=840.4", "guidance.gain=2.0",
        "start.distance_m=[135.2,420.2]", "start.spread_deg=180", "vessel.speed_mps=5.2", "flights=4", f"seed={seed}",
        "flight.duration_max_s=70",
    )  # fmt: skip
    assert (rows["min_distance_m"] >= rows["keepout_radius_m"]).all()
    assert (rows["guard_interventions"] > 0).all()
