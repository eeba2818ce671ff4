import pytest

from scenarios.flight.record import GuardedStep, interventions


def test_each_stretch_of_steps_is_one_intervention():
    guarding = [
        (1, 225.0, False),
        (2, 221.0, False),
        (5, 212.0, False),
        (6, 205.0, True),
        (7, 207.0, False),
        (9, 216.0, False),
    ]
    found = interventions([GuardedStep(*step) for step in guarding], 0.05)
    # Read off the list above: steps 1-2, 5-7 and 9, a twentieth of a second each.
    assert [stretch.time_s for stretch in found] == pytest.approx([0.05, 0.25, 0.45], abs=1e-12)
    assert [stretch.duration_s for stretch in found] == pytest.approx([0.1, 0.15, 0.05], abs=1e-12)
    assert [stretch.distance_min_m for stretch in found] == [221.0, 205.0, 216.0]
    assert [stretch.lost for stretch in found] == [False, True, False]
