"""Whether a design is judged as it should be."""

import pytest

from reports.design.data import complete, down, where
from reports.design.verdict import design_verdict

POINTS = 75
"""Points of the X8's grid, 25, and between them and at its largest bank, 50."""


@pytest.fixture
def judged(record):
    """A function from changes of the first row of named lists to the verdict."""

    def judge(**rows):
        for name, change in rows.items():
            record[name][0] |= change
        return design_verdict(complete(record))

    return judge


def test_one_margin_too_small_is_named_and_never_rounded_up_to_what_is_required(judged, record):
    verdict = judged(margins={"gain_db": 5.96})
    assert (verdict.holds, verdict.complete) == (True, False)
    assert verdict.headline == "Stable everywhere, but short of 6 dB and 45° in elevator"
    at = where(record["margins"][0])
    assert verdict.failures == [
        f"elevator: gain margin 5.9 dB at {at}, required 6 dB; short at 1 of {POINTS} points"
    ]


def test_a_point_between_those_of_the_grid_counts_as_much(judged, record):
    row = next(row for row in record["margins"] if row["between"] and row["loop"] == "aileron")
    row["phase_deg"] = 44.0
    (failure,) = judged().failures
    assert failure.startswith(f"aileron: phase margin 44.0 deg at {where(row)}")


def test_a_perturbed_aircraft_that_falls_short_is_named(judged, record):
    verdict = judged(robustness={"phase_deg": 29.0})
    assert (verdict.holds, verdict.complete) == (True, False)
    # Less is required of it than of the aircraft as modelled.
    assert verdict.headline == (
        "Every loop has 6 dB and 45° everywhere, but is short of 4 dB and 30° under a perturbation"
    )
    (failure,) = verdict.failures
    assert failure.startswith(f"{record['robustness'][0]['case']}: phase margin 29.0 deg of ")
    assert failure.endswith("required 30 deg")


def test_a_limit_cycle_by_play_in_servos_is_said_with_period_and_amplitudes(judged, record):
    assert "play" not in judged().detail
    record["limit_cycle"] = {
        "is_flown": True, "period_s": 5.165, "altitude_m": 0.306, "bank_rad": 0.00494,
        "counted_from": {"altitude_m": 0.05, "bank_rad": 0.00175},
    }  # fmt: skip
    verdict = judged()
    # 0.00494 rad are 0.283 deg.
    assert "limit cycle of 5.2 s, altitude ±0.31 m and bank ±0.28°" in verdict.detail
    # It has no margin to meet: the design is judged as before.
    assert (verdict.holds, verdict.complete) == (True, True)
    record["limit_cycle"] |= {"is_flown": False, "period_s": None, "altitude_m": 0.02}
    assert "no sustained oscillation from 0.05 m" in judged().detail


def test_an_unstable_point_is_worse_than_any_margin(judged, record):
    verdict = judged(poles={"closed_loop": [[0.02, 0.0], [-1.0, 0.0]]})
    assert not verdict.holds
    assert verdict.headline == f"Unstable at 1 of {POINTS} points"
    assert verdict.failures[0] == f"unstable at {where(record['poles'][0])}"


def test_a_point_that_says_it_is_unstable_has_no_margin_to_show(judged, record):
    between = next(row for row in record["margins"] if row["between"])
    between["stable"] = False
    verdict = judged(robustness={"stable": False})
    assert not verdict.holds
    at, required = where(between), {"gain": "dB at", "phase": "deg at"}
    assert verdict.failures[0] == f"unstable at {at}"
    assert [failure.partition(", required")[0] for failure in verdict.failures[1:3]] == [
        f"{between['loop']}: {name} margin 0.0 {unit} {at}" for name, unit in required.items()
    ]
    assert verdict.failures[3].startswith(f"{record['robustness'][0]['case']}: unstable at 1 of")


@pytest.mark.parametrize(
    ("value", "text"), [(5.99, "5.9"), (5.7, "5.7"), (6.0, "6.0"), (-0.3, "−0.3"), (None, "∞")]
)
def test_margins_are_rounded_down(value, text):
    assert down(value) == text
