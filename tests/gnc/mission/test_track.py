import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, TIME_STEP, fly, paper_oscillation, paper_parameters

from gnc.guard.guard import GuardParameters
from gnc.guidance import Guidance
from gnc.mission.mission import Centre
from gnc.mission.track import DirectParameters, Joining
from gnc.mission.way import ApproachParameters
from gnc.paper import PlumeAxis, distance_by_paper
from gnc.reference.oscillating import JoinedOrbit
from gnc.reference.shapes import Sinusoid

NU = 0.1
GUARD = GuardParameters(
    radius=200.75,
    heading_rate_max=HEADING_RATE_MAX,
    lag=0.0,
    delay=0.0,
    slow_lag=0.0,
    time_step=TIME_STEP,
)
APPROACH = ApproachParameters(
    blocked_radius=200.75,
    round_radius=200.75 + 0.8 * SPEED / HEADING_RATE_MAX,
    join_distance=150.0,
    tracked=12.0,
    airspeed=SPEED,
)
PLAN_INTERVAL = 10


def guidance(*, joining=True, nu=NU):
    """Return the guidance of a flight behind a vessel that goes north from the origin, with a guard
    about it.
    """
    oscillation = paper_oscillation(nu, reserve=0.015)
    orbit = JoinedOrbit(shape=Sinusoid(), orbit=oscillation, vessel_course=0.0, time_step=TIME_STEP)
    centre = Centre(-distance_by_paper(oscillation, PlumeAxis(heading=math.pi), 201.0), 0.0, nu)
    mission = DirectParameters(
        reference=orbit.reference(0.0, centre.x, centre.y),
        centre=centre,
        joining=Joining(approach=APPROACH, orbit=orbit, plan_interval=PLAN_INTERVAL)
        if joining
        else None,
    )
    return Guidance(paper_parameters(mission, vessel=(nu * SPEED, 0.0), guard=GUARD))


def settles(flight):
    """Return when a flight comes within 5 m of its reference for good [s]; inf if it never does."""
    outside = np.flatnonzero(flight.distance >= 5.0)
    last = outside[-1] + 1 if outside.size else 0
    return last * TIME_STEP if last < len(flight.distance) else math.inf


@pytest.mark.slow
@pytest.mark.parametrize(("nu", "bearing"), [(0.1, 0.0), (0.1, -2.0), (0.5, 0.3), (0.5, -2.0)])
def test_from_ahead_it_goes_round_the_vessel_and_settles_where_law_and_guard_alone_take_longer(
    nu, bearing
):
    start = (600.0 * math.cos(bearing), 600.0 * math.sin(bearing) + 10.0, bearing + math.pi)
    round_the_vessel, straight = (
        fly(guidance(joining=joining, nu=nu), start, duration=400.0) for joining in (True, False)
    )
    for flight in (round_the_vessel, straight):
        # The guard's radius, at the steps at least.
        assert np.min(flight.to_vessel) >= 200.75
    # Measured, 52 to 105 s.
    assert settles(round_the_vessel) < 120.0
    assert np.max(round_the_vessel.distance[-600:]) < 0.5
    # Law and guard undo each other's work: measured, 181 to 392 s, and half of them not within 400
    # s.
    assert settles(straight) > 2.0 * settles(round_the_vessel)
