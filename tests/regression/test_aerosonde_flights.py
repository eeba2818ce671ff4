"""The Aerosonde flies the study with elevator, aileron, throttle and rudder."""

import math

import pytest
from study_runs import assert_flown_as_the_issue_asks, fly_study

pytestmark = pytest.mark.slow

NUS = (0.3, 0.7)
CROSSINGS = 15
"""Half of the study's, which the X8 flies (test_flights)."""


@pytest.fixture(scope="module")
def run(designs, tmp_path_factory):
    designs("aerosonde")
    return fly_study(
        tmp_path_factory.mktemp("aerosonde") / "run",
        "aerosonde",
        f"flight.crossings={CROSSINGS}",
        nus=NUS,
    )


@pytest.mark.parametrize("nu", NUS)
def test_it_flies_the_sweep_as_the_x8_does(run, nu):
    row = run.rows[nu]
    assert_flown_as_the_issue_asks(row)
    assert row["crossing_count"] >= CROSSINGS
    # The X8's own limits, though the Aerosonde is given 1.66 times as much: it flies faster and
    # turns wider.
    assert row["tracking_error_rms_m"] <= 1.5
    assert row["airspeed_error_rms_mps"] <= 0.3
    assert row["altitude_error_max_m"] <= 1.5
    # It flies at its own airspeed, with its own omega_max: g tan(45 deg)/25 m/s.
    assert row["heading_rate_limit_rad_s"] == pytest.approx(9.80665 / 25.0, rel=1e-12)


@pytest.mark.parametrize("nu", NUS)
def test_its_rudder_keeps_it_from_slipping(run, nu):
    # With its rudder at rest it slipped by 2.3 deg. Measured now: 0.05 and 0.11 deg once settled,
    # 0.9 deg while it turns to its reference at omega_max. Asserted is twice that, which another
    # machine's rounding will not reach.
    assert run.settled(nu)["sideslip_rad"].abs().max() < math.radians(0.25)
    assert run.history(nu)["sideslip_rad"].abs().max() < math.radians(1.8)
    # By working for it, not because there is nothing to do.
    assert run.settled(nu)["rudder"].std() > 0.005


def test_its_controls_stay_off_their_stops(run):
    for nu in NUS:
        settled = run.settled(nu)
        assert settled[["elevator", "aileron", "rudder"]].abs().max().max() < 1.0
        assert settled["throttle"].between(0.0, 1.0, inclusive="neither").all()


def test_the_guard_keeps_it_out_where_the_law_would_fly_in(tmp_path):
    # The X8's start at nu = 0.15 (test_flights), in the Aerosonde's units, about a keep-out area
    # that is as much larger.
    words = [
        "guidance.approach=false",
        "keepout.radius_m=331.44",
        "flight.crossings=2",
        "criteria.crossing_interval_error=0.1",
    ]
    without = fly_study(
        tmp_path / "without", "aerosonde", *words, "guidance.keepout_guard=false", nus=(0.15,)
    ).rows[0.15]
    guarded = fly_study(tmp_path / "guarded", "aerosonde", *words, nus=(0.15,)).rows[0.15]
    assert without["keepout_violations"] > 0
    assert guarded["keepout_violations"] == 0
    assert guarded["outcome"] == "completed"
