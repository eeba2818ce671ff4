"""Ways between ships that move in wind, and the order in which they are served."""

import cmath
import itertools
import math

import numpy as np
import pytest

from extensions.patrol.order import (
    EXACT_MAX,
    Prospect,
    best_order,
    ends_of,
    exact_order,
    inserted_order,
)
from extensions.patrol.route import Air, Mover, keeps_clear, nearest_on, route, straight_leg

V_R = 20.0
RADIUS = 800.0
CLEARANCE = 500.0


def ships(seed, count, *, side=4e4, air=None):
    """Return ships at random places, each slower through the air than the UAV by a tenth at least."""
    generator = np.random.default_rng(seed)
    wind = air.wind if air else 0j
    made = []
    while len(made) < count:
        velocity = cmath.rect(generator.uniform(3.0, 12.0), generator.uniform(-math.pi, math.pi))
        if abs(velocity - wind) < 0.9 * V_R:
            made.append(Mover(complex(*generator.uniform(-0.5 * side, 0.5 * side, 2)), velocity))
    return made


def airs(count):
    generator = np.random.default_rng(5)
    return [
        Air(cmath.rect(generator.uniform(0.0, 12.0), generator.uniform(-math.pi, math.pi)), V_R)
        for _ in range(count)
    ]


def prospect(of, air, *, endurance=5400.0, service=165.0, deviation=40.0):
    count, limits = len(of), {"radius": RADIUS, "air": air, "endurance": endurance}
    times = {"service": [service] * count, "deviation": deviation}
    return Prospect(ships=of, chance=[1.0] * count, **times, **limits)


@pytest.mark.parametrize("air", airs(5))
def test_a_leg_ends_at_the_radius_from_the_ship_and_is_flown_at_the_airspeed(air):
    for ship in ships(1, 40, air=air):
        leg = straight_leg(1000 + 500j, 30.0, ship, RADIUS, air)
        # 1e-6 m and 1e-9 m/s: rounding of places of 1e4 m in double precision.
        assert abs(leg.end - ship.at(leg.ends)) == pytest.approx(RADIUS, abs=1e-6)
        assert abs(leg.velocity - air.wind) == pytest.approx(V_R, rel=1e-9)
        # It points at the ship where the way ends: no other straight way is as quick.
        to_ship = ship.at(leg.ends) - leg.end
        off = math.remainder(leg.course(air) - cmath.phase(to_ship), math.tau)
        assert off == pytest.approx(0.0, abs=1e-9)


def test_a_way_past_ships_keeps_clear_of_all_of_them_and_costs_little():
    tried = 0
    for seed, air in enumerate(airs(12)):
        goal, *others = ships(seed, 4, air=air)
        straight = straight_leg(0j, 0.0, goal, RADIUS, air)
        # In the way of the straight leg, at a quarter, the half and three quarters of it, up to 300
        # m to its side.
        for i, other in enumerate(others):
            at = 0.25 * (i + 1) * straight.ends
            place = straight.velocity * at + 300.0 * cmath.exp(1j * seed) - other.velocity * at
            others[i] = Mover(place, other.velocity)
        if min(abs(other.place) for other in others) < 2.0 * CLEARANCE:
            continue
        tried += 1
        assert not keeps_clear(straight, others, CLEARANCE)
        legs = route(0j, 0.0, goal, RADIUS, air=air, ships=[goal, *others], clearance=CLEARANCE)
        assert len(legs) > 1
        for leg in legs:
            for other in others:
                # Sampled, beside the closed form; a millimetre of what is kept.
                times = np.linspace(leg.begins, leg.ends, 400)
                track = leg.start + leg.velocity * (times - leg.begins)
                assert nearest_on(times, track, other) > CLEARANCE - 1e-3
        assert all(
            one.end == other.start and one.ends == other.begins
            for one, other in itertools.pairwise(legs)
        )
        # Round three octagons of 541 m: round each at most half its circumference more than through
        # it, 3 (pi/2 - 1) 2 x 541 m, at the UAV's advance over the ships of 0.1 V_R at least.
        assert straight.ends < legs[-1].ends < straight.ends + 3.0 * 0.571 * 1082.0 / (0.1 * V_R)
    assert tried > 6


def test_a_ship_that_cannot_be_caught_has_no_way():
    fast = Mover(5000 + 0j, 21 + 0j)
    way = route(0j, 0.0, fast, RADIUS, air=Air(0j, V_R), ships=[], clearance=CLEARANCE)
    assert way is None


@pytest.mark.parametrize("count", [1, 3, 5])
def test_insertion_expects_nearly_as_many_verdicts_as_the_best_of_all_orders(count):
    for seed, air in enumerate(airs(8)):
        served = prospect(ships(seed, count, air=air), air)
        best = exact_order(served, 0j, 0.0, range(count))
        found = inserted_order(served, 0j, 0.0, range(count))
        # No order is better than the exact one; insertion may stop at ships of which less than 0.02
        # verdicts are expected each.
        assert served.score_of(found) <= served.score_of(best) + 1e-12
        assert found.verdicts > best.verdicts - 0.1
        assert found.ends == pytest.approx(
            ends_of(served, 0j, 0.0, found.ships)[-1] if found.ships else 0.0
        )


def test_exact_is_the_best_of_orders_tried_one_by_one():
    air = Air(6 - 2j, V_R)
    served = prospect(ships(3, 4, air=air), air, endurance=2500.0)
    best = exact_order(served, 0j, 0.0, range(4))
    orders = [order for size in range(5) for order in itertools.permutations(range(4), size)]
    values = [served.score_of(served.judged(0j, 0.0, order)) for order in orders]
    assert served.score_of(best) == pytest.approx(max(values), rel=1e-12)


def test_ships_ahead_on_a_line_are_served_as_they_come_and_those_out_of_reach_are_left_out():
    air = Air(0j, V_R)
    of = [Mover(complex(place), 0j) for place in (9000, 3000, 6000, 500_000)]
    assert inserted_order(prospect(of, air), 0j, 0.0, range(4)).ships == (1, 2, 0)
    assert exact_order(prospect(of, air), 0j, 0.0, range(4)).ships == (1, 2, 0)
    # The one way to 9,000 m, 800 m of each way saved and made up for by flying on from the ship
    # herself, and three services.
    ends = ends_of(prospect(of, air), 0j, 0.0, (1, 2, 0))
    assert ends == pytest.approx(
        [2200.0 / V_R + 165.0, 4400.0 / V_R + 330.0, 6600.0 / V_R + 495.0], rel=1e-12
    )


def test_of_few_ships_every_order_is_tried_and_of_many_some(monkeypatch):
    air = Air(6 - 2j, V_R)
    # Four ships of which insertion misses the best order.
    few, many = (
        prospect(ships(2, 4, air=air), air, endurance=2500.0),
        prospect(ships(6, EXACT_MAX + 1, air=air), air),
    )
    assert (
        best_order(few, 0j, 0.0, range(4))
        == exact_order(few, 0j, 0.0, range(4))
        != inserted_order(few, 0j, 0.0, range(4))
    )
    expected = inserted_order(many, 0j, 0.0, range(EXACT_MAX + 1))
    monkeypatch.setattr(
        "extensions.patrol.order.exact_order",
        lambda *_: pytest.fail("every order of many is tried"),
    )
    assert best_order(many, 0j, 0.0, range(EXACT_MAX + 1)) == expected
