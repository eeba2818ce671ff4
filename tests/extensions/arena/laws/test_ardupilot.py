"""ArduPilot's L1 against its original: numbers of guidance-laws.md, section 2, computed by
ArduPilot's code in single precision.
"""

import math

import pytest

from extensions.arena.laws.ardupilot import FRESH, decided, update_loiter, update_waypoint

START, END = (-100.0, 0.0), (2000.0, 0.0)
# ArduPilot computes in single precision: 1e-7 relative at each of some ten operations.
SINGLE = 5e-7


def test_beside_a_line_it_captures():
    acceleration, _ = update_waypoint((0.0, 20.0), (20.0, 0.0), 0.0, START, END, time_step=0.1)
    # Section 2: a = -2.732070.
    assert acceleration == pytest.approx(-2.732070, rel=SINGLE)


def test_the_first_call_integrates_nothing_and_later_ones_within_five_degrees_do():
    def call(state, time_step=0.1, gain=0.02):
        return update_waypoint(
            (0.0, 2.0),
            (20.0, 0.0),
            0.0,
            START,
            END,
            time_step=time_step,
            state=state,
            integrator_gain=gain,
        )[1]

    first = call(FRESH)
    second = call(first)
    # Section 2.1, step 5: left positive, nu_1 = -asin(2/81.17) = -0.02464; times 0.02 and 0.1 s.
    assert first.integral == 0.0
    assert second.integral == pytest.approx(-math.asin(2.0 / 81.16902) * 0.002, rel=1e-6)
    # Steps longer than 0.1 s count as 0.1 s; after more than a second, or with another gain, it
    # begins anew.
    assert call(first, time_step=0.5).integral == second.integral
    assert call(second, time_step=1.5).integral == second.integral
    assert call(second, gain=0.03).integral == 0.0


def test_flying_backwards_it_goes_by_its_heading_at_a_tenth_of_a_metre_per_second():
    # Section 2.1, step 2: L = zeta T 0.1/pi, 0.40585 m; a line 20 m to the left is captured at
    # asin(0.7071), from heading east.
    acceleration, _ = update_waypoint(
        (0.0, 20.0), (0.0, -5.0), 0.5 * math.pi, START, END, time_step=0.1
    )
    distance = 0.3183099 * 0.75 * 17.0 * 0.1
    # -asin(0.7071) and -pi/2 together are beyond a quarter of a turn: the sine is 1.
    assert acceleration == pytest.approx(-2.25 * 0.01 / distance, rel=1e-6)


@pytest.mark.parametrize(("position", "turns_to"), [((-400.0, 10.0), 1.0), ((2100.0, 10.0), -1.0)])
def test_behind_the_start_and_beyond_the_end_it_turns_to_these_points(position, turns_to):
    # Section 2.1, step 5. Course north, 10 m right of the line: behind the start, the start is
    # ahead to the left; three seconds beyond the end, 60 m, the end is behind to the left.
    acceleration, _ = update_waypoint(position, (20.0, 0.0), 0.0, START, END, time_step=0.1)
    nu = math.atan2(-10.0, (START[0] if turns_to > 0.0 else END[0]) - position[0])
    limited = max(-1.5708, min(1.5708, nu))
    assert acceleration == pytest.approx(
        2.25 * 400.0 / (0.3183099 * 0.75 * 17.0 * 20.0) * math.sin(limited), rel=1e-9
    )


def test_a_target_behind_that_changes_sides_does_not_turn_it_round():
    assert decided(3.0, -3.0, bearing=math.pi, yaw=0.0) == -3.0
    # Ahead, or on the same side, the new angle counts.
    assert decided(3.0, -3.0, bearing=1.0, yaw=0.0) == 3.0
    assert decided(-2.9, -3.0, bearing=math.pi, yaw=0.0) == -2.9


def test_a_loiter_is_captured_and_circled():
    captured = update_loiter((0.0, 100.0), (20.0, 0.0), 0.0, (0.0, 0.0), 60.0, 1)
    circled = update_loiter((0.0, 62.0), (-20.0, 0.0), math.pi, (0.0, 0.0), 60.0, 1)
    # Section 2: a = -11.08797 (capture), to its digits, and 6.724821 (circle).
    assert captured == pytest.approx(-11.08797, abs=6e-6)
    assert circled == pytest.approx(6.724821, rel=SINGLE)
