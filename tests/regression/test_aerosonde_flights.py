"""The Aerosonde flies the study with elevator, aileron, throttle and rudder."""

import math

import pytest
from study_runs import assert_flown_as_the_issue_asks, fly_study

pytestmark = pytest.mark.slow


def test_it_flies_the_sweep_as_the_x8_does_and_its_rudder_keeps_it_from_slipping(designs, tmp_path):
    designs("aerosonde")
    run = fly_study(tmp_path / "run", "aerosonde", "flight.crossings=10")
    ((nu, row),) = run.rows.items()
    assert_flown_as_the_issue_asks(row)
    # The X8's own limits, though the Aerosonde is given 1.66 times as much: it flies faster and
    # turns wider.
    assert row["tracking_error_rms_m"] <= 1.5
    assert row["airspeed_error_rms_mps"] <= 0.3
    assert row["altitude_error_max_m"] <= 1.5
    # It flies at its airspeed, with its omega_max: g tan(45 deg)/25 m/s.
    assert row["heading_rate_limit_rad_s"] == pytest.approx(9.80665 / 25.0, rel=1e-12)
    # With its rudder at rest it slipped by 2.3 deg. Measured now: 0.05 and 0.11 deg once settled,
    # 0.9 deg while it turns to its reference at omega_max. Asserted is twice that, which another
    # machine's rounding will not reach.
    history, settled = run.history(nu), run.settled(nu)
    assert settled["sideslip_rad"].abs().max() < math.radians(0.25)
    assert history["sideslip_rad"].abs().max() < math.radians(1.8)
    # By working for it, not because there is nothing to do, and off its stops.
    assert settled["rudder"].std() > 0.005
    assert settled[["elevator", "aileron", "rudder"]].abs().max().max() < 1.0
    assert settled["throttle"].between(0.0, 1.0, inclusive="neither").all()
