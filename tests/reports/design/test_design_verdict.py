"""Whether a made-up design is judged as it should be."""

import pytest
from design_runs import record

from reports.design.data import complete, down
from reports.design.verdict import design_verdict


def changed(**rows):
    """Return a design whose named lists have another first row."""
    design = record()
    for name, change in rows.items():
        design[name][0] |= change
    return complete(design)


def test_one_margin_too_small_is_named_and_never_rounded_up_to_what_is_required():
    verdict = design_verdict(changed(margins={"gain_db": 5.96}))
    assert verdict.holds
    assert not verdict.complete
    assert verdict.headline == "Stable everywhere, but short of 6 dB and 45° in elevator"
    # 45 grid points and 20 between.
    assert verdict.failures == [
        "elevator: gain margin 5.9 dB at 45 m/s, −33°, required 6 dB; short at 1 of 65 points"
    ]


def test_a_point_between_those_of_the_grid_counts_as_much():
    design = complete(record())
    row = next(row for row in design["margins"] if row["between"] and row["loop"] == "rudder")
    row["phase_deg"] = 44.0
    (failure,) = design_verdict(design).failures
    assert failure.startswith("rudder: phase margin 44.0 deg at 47.5 m/s, −30°")


def test_a_perturbed_aircraft_that_falls_short_is_named():
    verdict = design_verdict(changed(robustness={"phase_deg": 29.0}))
    assert verdict.holds
    assert not verdict.complete
    # Less is required of it than of the aircraft as modelled.
    assert (
        verdict.headline
        == "Every loop has 6 dB and 45° everywhere, but is short of 4 dB and 30° under a perturbation"
    )
    assert verdict.failures == [
        "mass +20 %: phase margin 29.0 deg of heading rate at 45 m/s, −33°, required 30 deg"
    ]


def test_a_limit_cycle_by_play_in_servos_is_said_with_period_and_amplitudes():
    assert "play" not in design_verdict(complete(record())).detail
    cycle = {
        "is_flown": True,
        "period_s": 5.165,
        "altitude_m": 0.306,
        "bank_rad": 0.00494,
        "counted_from": {"altitude_m": 0.05, "bank_rad": 0.00175},
    }
    verdict = design_verdict(complete(record() | {"limit_cycle": cycle}))
    # 0.00494 rad are 0.283 deg.
    assert "limit cycle of 5.2 s, altitude ±0.31 m and bank ±0.28°" in verdict.detail
    # It has no margin to meet: the design is judged as before.
    assert (verdict.holds, verdict.complete) == (True, True)
    small = cycle | {"is_flown": False, "period_s": None, "altitude_m": 0.02}
    detail = design_verdict(complete(record() | {"limit_cycle": small})).detail
    assert "no sustained oscillation from 0.05 m" in detail


def test_an_unstable_point_is_worse_than_any_margin():
    verdict = design_verdict(changed(poles={"closed_loop": [[0.02, 0.0], [-1.0, 0.0]]}))
    assert not verdict.holds
    assert verdict.headline == "Unstable at 1 of 65 points"
    assert verdict.failures[0] == "unstable at 45 m/s, −33°"


def test_a_point_that_says_it_is_unstable_has_no_margin_whatever_was_measured():
    between = next(i for i, row in enumerate(record()["margins"]) if row["between"])
    design = record()
    design["margins"][between]["stable"] = False
    design["robustness"][0]["stable"] = False
    verdict = design_verdict(complete(design))
    assert not verdict.holds
    assert verdict.failures == [
        "unstable at 47.5 m/s, −30°",
        "elevator: gain margin 0.0 dB at 47.5 m/s, −30°, required 6 dB; short at 1 of 65 points",
        "elevator: phase margin 0.0 deg at 47.5 m/s, −30°, required 45 deg; short at 1 of 65 points",
        "mass +20 %: unstable at 1 of 45 points, as at 45 m/s, −33°",
    ]


@pytest.mark.parametrize(
    ("value", "text"), [(5.99, "5.9"), (5.7, "5.7"), (6.0, "6.0"), (-0.3, "−0.3"), (None, "∞")]
)
def test_margins_are_rounded_down(value, text):
    assert down(value) == text
