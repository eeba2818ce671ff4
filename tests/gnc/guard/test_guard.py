import copy
import math
from collections import deque

import numpy as np
import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    courses,
    examples,
    fly,
    make_guidance,
    make_reference,
    paper_oscillation,
)
from guard_cases import (
    LAGS,
    RADIUS,
    TIME_STEP,
    TURN_RADIUS,
    Hunter,
    Steady,
    aim_at_the_centre,
    commands,
    distances,
    fly_guarded,
    held_at_random,
    make_guard,
    moved,
    random_start,
    random_velocity,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.numeric import wrap
from gnc.paper import PlumeAxis, distance_by_paper


@LAGS
@pytest.mark.parametrize("nu", [0.0, 0.5, 0.9])
def test_no_commands_lead_in(lag, delay, nu):
    generator = np.random.default_rng(5)
    worked = 0
    for i in range(4):
        velocity, start = random_velocity(generator, nu * SPEED), random_start(generator)
        guard = make_guard(lag=lag, delay=delay)
        if guard.clearance(*start[:2], *velocity, start[2], SPEED, start[3]) < 0.0:
            continue
        want = aim_at_the_centre if i % 2 else held_at_random(generator)
        closest, changed, lost = fly_guarded(
            guard, start, want, Steady(velocity), lag=lag, delay=delay
        )
        # The theorem of docs/keepout_guard.md, with what the guard keeps for its looks, 0.04 m, on
        # the safe side of it.
        assert closest >= RADIUS
        assert not any(lost)
        worked += any(changed)
    # It had to work for it.
    assert worked >= 2


@pytest.mark.parametrize(("speed_error", "acceleration"), [(0.5, 0.0), (0.0, 0.2), (1.0, 0.1)])
def test_a_disc_that_hunts_the_vehicle_within_its_bounds_does_not_get_it(speed_error, acceleration):
    generator = np.random.default_rng(8)
    worked = 0
    for _ in range(3):
        start = random_start(generator, nearest=350.0)
        # Slower than the vehicle by all that may be wrong.
        disc = Hunter(
            random_velocity(generator, 0.4 * SPEED),
            acceleration=acceleration,
            speed_max=0.7 * SPEED,
            error=random_velocity(generator, speed_error),
        )
        guard = make_guard(speed_error=speed_error, acceleration=acceleration)
        closest, changed, _ = fly_guarded(guard, start, aim_at_the_centre, disc, lag=0.4)
        assert closest >= RADIUS
        worked += any(changed)
    assert worked == 3


def test_a_guard_that_knows_nothing_of_the_hunters_acceleration_is_caught():
    # What the bound is for: the same kind of pursuit, as hard as 1 m/s2, taken for a disc at
    # constant velocity.
    disc = Hunter((0.0, 0.0), acceleration=1.0, speed_max=0.9 * SPEED, error=(0.0, 0.0))
    start = (-400.0, 0.0, 0.0, 0.0)
    assert fly_guarded(make_guard(), start, aim_at_the_centre, disc, lag=0.4)[0] < RADIUS - 0.5


@pytest.mark.parametrize(
    ("speed", "heading_rate_max", "radius"),
    [(15.0, 0.4, 200.0), (30.0, 0.33, 300.0), (60.0, 0.16, 500.0), (SPEED, 0.5, 60.0)],
)
def test_other_vehicles_are_kept_out_of_other_discs(speed, heading_rate_max, radius):
    generator = np.random.default_rng(2)
    for share in (0.0, 0.5, 0.85):
        guard = make_guard(radius=radius, heading_rate_max=heading_rate_max)
        bearing, distance = (
            generator.uniform(-math.pi, math.pi),
            radius + 4.0 * speed / heading_rate_max,
        )
        start = (distance * math.cos(bearing), distance * math.sin(bearing), bearing + math.pi, 0.0)

        def want(*where, limit=heading_rate_max):
            return aim_at_the_centre(*where, heading_rate_max=limit)

        disc = Steady(random_velocity(generator, share * speed))
        assert fly_guarded(guard, start, want, disc, lag=0.4, speed=speed)[0] >= radius


@pytest.mark.parametrize("nu", [0.0, 0.5, 0.8])
def test_without_the_guard_those_vehicles_do_get_in(nu):
    class Idle:
        intervening = lost = False

        def limit(self, command, *_):
            return command

    closest, *_ = fly_guarded(
        Idle(), (500.0, 0.0, math.pi, 0.0), aim_at_the_centre, Steady((nu * SPEED, 0.0)), lag=0.4
    )
    assert closest < 0.5 * RADIUS


@LAGS
def test_looking_less_often_where_nothing_can_happen_changes_nothing(lag, delay):
    # A guard that remembers nothing but the commands under way looks at every step, and allows all
    # that the other lets pass.
    generator = np.random.default_rng(1)
    velocity = (0.6 * SPEED, 0.0)
    skipped = 0
    for _ in range(2):
        guard, x_y = make_guard(lag=lag, delay=delay), random_start(generator)
        want, state = held_at_random(generator), x_y
        under_way = deque([state[3]] * round(delay / TIME_STEP))
        for step in range(400):
            x, y, course, heading_rate = state
            motion = (x, y, *velocity, course, SPEED, heading_rate)
            fresh = copy.deepcopy(guard)
            fresh.guard._free.steps = 0
            skipped += guard.guard._free.steps > 0
            command = guard.limit(want(step), *motion)
            assert fresh.limit(want(step), *motion) == command
            under_way.append(command)
            x, y, course, heading_rate = moved(state, under_way.popleft(), lag, TIME_STEP)
            state = (x - velocity[0] * TIME_STEP, y - velocity[1] * TIME_STEP, course, heading_rate)
    # There were steps at which it did not look; where it works, it looks at each.
    assert skipped > 100


@examples(200)
@given(
    bearing=courses,
    farther=st.floats(0.0, 5000.0),
    course=courses,
    command=commands,
    turn=commands,
    nu=st.floats(0.0, 0.9),
)
def test_a_vehicle_far_away_is_left_alone(bearing, farther, course, command, turn, nu):
    # Farther than both can close in the whole of a turn and the lag from any heading rate: nothing
    # can have got near by then.
    distance = RADIUS + (1.0 + nu) * SPEED * (2.0 * math.pi / HEADING_RATE_MAX + 1.0) + farther
    guard = make_guard()
    motion = (
        distance * math.cos(bearing),
        distance * math.sin(bearing),
        nu * SPEED,
        0.0,
        course,
        SPEED,
        turn,
    )
    assert guard.limit(command, *motion) == command
    assert not guard.intervening


@examples(200)
@given(
    side=st.sampled_from([-1.0, 1.0]),
    clear=st.floats(0.05, 200.0),
    command=st.floats(0.0, HEADING_RATE_MAX),
)
def test_a_vehicle_that_passes_clear_is_left_alone(side, clear, command):
    # Northbound, the disc abeam to port or starboard, farther than what is kept for the looks, and
    # the command away from it.
    assert (
        make_guard().limit(side * command, 0.0, side * (RADIUS + clear), 0.0, 0.0, 0.0, SPEED, 0.0)
        == side * command
    )


@LAGS
@examples(150)
@given(
    bearing=courses,
    distance=distances,
    course=courses,
    command=commands,
    turn=commands,
    nu=st.floats(0.0, 0.95),
)
def test_a_command_within_omega_max_stays_within(
    lag, delay, bearing, distance, course, command, turn, nu
):
    guard = make_guard(lag=lag, delay=delay)
    motion = (
        distance * math.cos(bearing),
        distance * math.sin(bearing),
        nu * SPEED,
        0.0,
        course,
        SPEED,
        turn,
    )
    # A mixture of two commands rounds.
    assert abs(guard.limit(command, *motion)) <= HEADING_RATE_MAX * (1.0 + 1e-15)


@LAGS
def test_mirrored_situations_are_answered_mirrored(lag, delay):
    generator = np.random.default_rng(3)
    changed = 0
    for _ in range(150):
        # Random, since a situation that is its own mirror has two answers.
        x, y = generator.uniform(-350.0, 350.0, 2)
        course, turn = (
            generator.uniform(-math.pi, math.pi),
            generator.uniform(-HEADING_RATE_MAX, HEADING_RATE_MAX),
        )
        north, east = random_velocity(generator, 8.0)
        command = generator.uniform(-HEADING_RATE_MAX, HEADING_RATE_MAX)
        one, other = make_guard(lag=lag, delay=delay), make_guard(lag=lag, delay=delay)
        answer = one.limit(command, x, y, north, east, course, SPEED, turn)
        assert other.limit(-command, x, -y, north, -east, -course, SPEED, -turn) == pytest.approx(
            -answer, abs=1e-12
        )
        assert (one.lost, one.intervening) == (other.lost, other.intervening)
        changed += answer != command
    assert 10 < changed < 140


def test_a_start_that_cannot_be_held_is_said_to_be_so():
    guard = make_guard()
    # Head on, 20 m off the radius, and a turn takes 38.6 m.
    assert guard.clearance(-220.0, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0) < -10.0
    # Turning away at once from a disc at rest, without lag: the circle beside it is sqrt(220^2 +
    # r^2) - r from the centre.
    alone = make_guard(lag=0.0).clearance(-220.0, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    assert alone == pytest.approx(
        math.hypot(220.0, TURN_RADIUS) - TURN_RADIUS - RADIUS, abs=1e-3 * TURN_RADIUS
    )
    # Abeam and heading away, it is the distance.
    assert guard.clearance(0.0, 230.0, 0.0, 0.0, 0.5 * math.pi, SPEED, 0.0) == pytest.approx(
        30.0, abs=1e-9
    )


def test_lost_is_said_and_the_better_turn_is_flown():
    guard = make_guard()
    # Head on, 20 m off; 5 m to the left of the line to the centre, so that left is nearer out.
    assert guard.limit(0.0, -220.0, -5.0, 0.0, 0.0, 0.0, SPEED, 0.0) == -HEADING_RATE_MAX
    assert guard.lost
    assert guard.intervening
    # Nothing more is lost than what was at the start.
    start = (-220.0, -5.0, 0.0, 0.0)
    best = make_guard().clearance(*start[:2], 0.0, 0.0, start[2], SPEED, start[3])
    closest, _, lost = fly_guarded(
        make_guard(), start, aim_at_the_centre, Steady((0.0, 0.0)), lag=0.4, duration=30.0
    )
    # Held commands and looks, as above.
    assert closest - RADIUS == pytest.approx(best, abs=0.05)
    # And it is found again.
    assert not any(lost[-200:])


@pytest.mark.parametrize("declared", ["allowance", "wander"])
def test_what_an_allowance_or_an_error_of_the_own_place_takes_is_explained(declared):
    # 3 m of the radius are taken already; a guard that knows of neither has no explanation.
    motion = (0.0, RADIUS - 3.0, 0.0, 0.0, 0.5 * math.pi, SPEED, 0.0)
    for size in (0.0, 10.0):
        guard = make_guard(**{declared: size})
        guard.limit(0.0, *motion)
        assert guard.intervening
        assert guard.lost == (size == 0.0)


@pytest.mark.parametrize("off", [0.0, 0.01, -0.01])
def test_a_vehicle_that_heads_straight_away_from_what_closes_in_flies_on(off):
    # The disc gains on it by 0.1 m/s: 1.5 m within the time that is looked ahead. Once round it
    # would gain 250 m.
    guard = make_guard(deviation=3.0)
    command = guard.limit(
        HEADING_RATE_MAX, 0.0, RADIUS + 1.0, 0.0, SPEED + 0.1, 0.5 * math.pi + off, SPEED, 0.0
    )
    assert guard.intervening
    assert not guard.lost
    assert command == pytest.approx(-off / TIME_STEP)


@pytest.mark.parametrize("want", [HEADING_RATE_MAX, -HEADING_RATE_MAX, 0.0])
def test_a_vehicle_that_a_growing_radius_overtakes_flies_straight_away_from_it(want):
    guard, state = make_guard(), (0.0, 210.0, 1.0, 0.0)
    for _ in range(200):
        x, y, course, turn = state
        # As of a vessel that does not report, whose disc grows faster than the vehicle flies.
        command = guard.limit(want, x, y, 0.0, 0.0, course, SPEED, turn, radius_inflation=5000.0)
        assert guard.lost
        state = moved(state, command, 0.4, TIME_STEP)
    x, y, course, _ = state
    # Settled within what a step turns.
    assert wrap(course - math.atan2(y, x)) == pytest.approx(0.0, abs=HEADING_RATE_MAX * TIME_STEP)
    assert abs(command) < 0.05


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_vehicle_whose_turn_leads_beyond_straight_away_turns_back(side):
    # It turns by 0.5 rad/s, of which 0.2 rad are still to come with a lag of 0.4 s; straight away
    # is 0.15 rad ahead. On the same side it would come once round, towards the disc.
    course = 0.5 * math.pi - side * 0.15
    guard = make_guard()
    command = guard.limit(
        0.0, 0.0, 210.0, 0.0, 0.0, course, SPEED, side * 0.5, radius_inflation=20.0
    )
    assert guard.lost
    assert command == -side * HEADING_RATE_MAX


def test_interventions_are_counted_once_each():
    guard = make_guard()
    _, changed, _ = fly_guarded(
        guard,
        (-500.0, 3.0, 0.0, 0.0),
        aim_at_the_centre,
        Steady((0.0, 0.0)),
        lag=0.4,
        duration=120.0,
    )
    assert guard.interventions == sum(
        now and not before for before, now in zip([False, *changed], changed, strict=False)
    )
    assert 0 < guard.interventions < sum(changed)


@pytest.mark.parametrize("off", [0.5, -0.5])
def test_it_stays_with_the_side_that_was_safe(off):
    # Nearly head on at the middle of the disc both sides keep off; the one that it found to be
    # nearer first is flown throughout.
    guard, state, answers = make_guard(), (-400.0, off, 0.0, 0.0), []
    for _ in range(250):
        x, y, course, turn = state
        answers.append(guard.limit(0.0, x, y, 0.0, 0.0, course, SPEED, turn))
        state = moved(state, answers[-1], 0.4, TIME_STEP)
    turned = [math.copysign(1.0, answer) for answer in answers if answer != 0.0]
    assert len(turned) > 20
    assert set(turned) == {math.copysign(1.0, off)}


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.6, 0.9])
def test_on_the_settled_orbit_it_never_intervenes_and_would_if_it_kept_more(nu):
    # The paper's rule places the orbit 1.3 to 9.7 m off, where 1 m is asked; the guard keeps 0.75 m
    # of that (tracking_flight.py).
    oscillation = paper_oscillation(nu, reserve=0.015)
    centre = (-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), RADIUS + 1.0), 0.0)
    reference = make_reference(oscillation, centre=centre)
    for kept, intervenes in ((0.75, False), (12.0, True)):
        guard = GuardParameters(
            radius=RADIUS + kept,
            heading_rate_max=HEADING_RATE_MAX,
            lag=0.0,
            delay=0.0,
            slow_lag=0.0,
            time_step=TIME_STEP,
        )
        guidance = make_guidance(reference, vessel=(nu * SPEED, 0.0), guard=guard)
        fly(guidance, (reference.north, reference.east, reference.course), duration=120.0)
        assert (guidance.guard.interventions > 0) == intervenes
