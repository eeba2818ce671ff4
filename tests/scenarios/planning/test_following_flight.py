"""Flights whose reference is steered."""

import math
from dataclasses import replace

import pytest
from flight_cases import SPEED, plan, scenario
from thrust_cases import MODEL

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import WindFilter
from innerloop.flight.part_failure import PartFailure
from scenarios.planning.air.wind import navigation_parameters, wind_followed
from scenarios.planning.declared_vessel import check_declared
from scenarios.vehicles.thrust_expectation import ThrustErrors, ThrustExpectation
from scenarios.vehicles.vehicle_setup import kinematic_setup

# Errors of a thousandth of the weight.
ERRORS = ThrustErrors(lack=1e-3, density=1e-6)
EXPECTATION = ThrustExpectation(model=MODEL, calm=ERRORS, gusty=ERRORS, gusts=2.0)


def test_the_guard_allows_for_the_airspeed_to_which_a_vehicle_without_thrust_falls():
    failing = PartFailure(airspeed_fall=1.25, glide_deviation=4.3, glide_undershoot=0.5)
    setup = replace(
        kinematic_setup(scenario()), airspeed_min=15.0, failing_level=failing, thrust=EXPECTATION
    )
    given = scenario(guidance={"airspeed_mps": 19.42}, fault={"declared": ["engine"]})
    guarded = plan(given, setup=setup).guidance.guard
    # Noticed after a second, 0.2 s of an interval, and half of the 2 s in which the engine may run
    # down; another interval until it is told to glide, and 0.5 m/s as it pushes over.
    assert guarded.errors.slowest == pytest.approx(
        19.42 - 1.25 * (1.0 + 0.2 + 0.5 * 2.0 + 0.2) - 0.5
    )
    # Noticed earlier than that, it holds its height until it has fallen to the glide's airspeed.
    quick = replace(EXPECTATION, model=replace(MODEL, spool_time=0.1))
    at_once = plan(given, setup=replace(setup, thrust=quick)).guidance.guard
    assert at_once.errors.slowest == pytest.approx(0.5 * (19.42 + 15.0) - 1.25 * 0.2 - 0.5)
    # Then it pushes over to a glide, which takes it off its turn: the guard keeps as much more.
    assert (guarded.radius, guarded.errors.failed_part.size) == (204.3, 4.3)
    # A throttle that sticks takes thrust, too; a surface that is stuck does not, and the aircraft
    # leaves gliding all the same.
    stuck = [
        plan(scenario(fault={"declared": [part]}), setup=setup).guidance.guard
        for part in ("throttle", "left_elevon")
    ]
    assert [guard.errors.failed_part.size for guard in stuck] == [4.3, 4.3]
    assert [guard.errors.slowest < math.inf for guard in stuck] == [True, False]
    # Only where it is declared: a list of trials has one setup.
    sound = plan(scenario(guidance={"airspeed_mps": 19.42}), setup=setup)
    errors = sound.guidance.guard.errors
    assert (errors.slowest, errors.failed_part.size) == (math.inf, 0.0)
    # Beside an orbit of its least margin there is room for that much, and not for ten times as
    # much.
    deviations = (0.0, 4.3, 43.0)
    totals = [
        plan(
            given, setup=replace(setup, failing_level=replace(failing, glide_deviation=of))
        ).margin.total
        for of in deviations
    ]
    assert totals[0] == totals[1] == sound.margin.total
    assert totals[2] > sound.margin.total + 20.0


def test_a_steady_vessel_that_is_faster_than_declared_is_refused():
    changes = {"reports": {"interval_s": (2.0, 10.0)}}
    with pytest.raises(
        InfeasibleError,
        match=r"moves at up to 8 m/s .*vessel_speed_max_mps = 7, on which .* relies: declare",
    ):
        plan(scenario(following={"vessel_speed_max_mps": 7.0}, **changes))
    # What is less by 0.05 % is not rounding: 1.2 m in 5 minutes. The speed that is given is what
    # has to be declared.
    with pytest.raises(
        InfeasibleError, match=r"moves at up to 8 m/s .*vessel_speed_max_mps = 7\.996"
    ):
        plan(scenario(following={"vessel_speed_max_mps": 7.996}, **changes))
    plan(scenario(following={"vessel_speed_max_mps": 8.0}, **changes))


class Swerving:
    """A track of one's own, which accelerates by 0.4 m/s2."""

    manoeuvres_end = math.nan

    def course(self, time):
        return 0.5 * math.sin(0.1 * time)

    def motion(self, time):
        return 8.0 * time, 40.0 * (1.0 - math.cos(0.1 * time)), 8.0, 4.0 * math.sin(0.1 * time)


def test_a_users_track_that_accelerates_more_than_is_declared_is_refused():
    with pytest.raises(InfeasibleError, match=r"accelerates by 0\.4 m/s2.*: declare more"):
        check_declared(scenario(), Swerving())


@pytest.mark.parametrize(
    ("level", "speed", "turned"),
    [
        ("none", SPEED, 0.02),
        ("light", SPEED, 0.02),
        ("moderate", SPEED, 0.02),
        ("none", 100.0, 0.0),
    ],
)
def test_the_estimated_wind_follows_as_fast_as_the_guard_allows_for(level, speed, turned):
    # A wind that rises by 0.1 m/s each second, which gusts hide, or beside a fast vehicle the error
    # of its course, as it flies straight across the wind: the filter lags by no more than its time.
    flown = scenario(
        fidelity="six_dof", turbulence={"level": level}, guidance={"airspeed_mps": speed}
    )
    p = navigation_parameters(flown, kinematic_setup(scenario()))
    wind = WindFilter(
        airspeed_sigma=p.airspeed_sigma, course_sigma=p.course_sigma, drift=p.wind_drift
    )
    behind, period = 0.0, p.wind_interval * p.time_step
    for n in range(2000):
        blown, course = 0.1 * n * period, 0.5 * math.pi + turned * n
        wind.update(
            speed, course, blown + speed * math.cos(course), speed * math.sin(course), period
        )
        behind = max(behind, blown - wind.north)
    assert 0.5 * wind_followed(flown) < behind / 0.1 <= wind_followed(flown)
