"""Flights whose reference is steered."""

import math
from dataclasses import replace

import pytest
from flight_cases import SPEED, plan, scenario
from thrust_cases import MODEL

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import WindFilter
from gnc.mission.follow import FollowingParameters
from innerloop.flight.part_failure import PartFailure
from scenarios.planning.air.wind import navigation_parameters, wind_followed
from scenarios.planning.declared_vessel import check_declared
from scenarios.vehicles.thrust_expectation import ThrustErrors, ThrustExpectation
from scenarios.vehicles.vehicle_setup import kinematic_setup


def test_such_a_flight_has_sensing_margin_and_health():
    flight = plan(scenario())
    assert isinstance(flight.guidance.mission, FollowingParameters)
    assert flight.sensing.received is None  # the vessel is known exactly
    assert flight.guidance.health is not None
    assert flight.guidance.navigation is not None
    # What is kept at least, in still air and with exact knowledge, where tracking has no spread:
    # the guard keeps r_min.
    assert flight.margin.total == pytest.approx(3.0)
    assert flight.guidance.guard.radius == pytest.approx(200.0)
    assert flight.guidance.mission.centre.distance_min == pytest.approx(203.0)


# Errors of a thousandth of the weight.
ERRORS = ThrustErrors(lack=1e-3, density=1e-6)
EXPECTATION = ThrustExpectation(model=MODEL, calm=ERRORS, gusty=ERRORS, gusts=2.0)


def test_a_flight_is_watched_by_the_thrust_of_its_aircraft():
    setup = replace(kinematic_setup(scenario()), thrust=EXPECTATION)
    given = scenario(guidance={"airspeed_mps": 19.42})
    thrust = plan(given, setup=setup).guidance.health.thrust
    assert thrust.level == MODEL.drag(19.42, 1.0)
    # Half of it, missing for a second.
    assert thrust.energy_height == pytest.approx(19.42 * 0.5 * thrust.level)
    # A vehicle without an engine has none to lose.
    assert plan(given).guidance.health.thrust is None


def test_an_engine_whose_failure_would_not_be_noticed_cannot_be_declared_to_fail():
    failing = PartFailure(airspeed_fall=1.25, glide_deviation=4.3, glide_undershoot=0.5)
    blind = replace(EXPECTATION, calm=replace(ERRORS, lack=0.1))
    setup = replace(kinematic_setup(scenario()), failing_level=failing, thrust=blind)
    with pytest.raises(InfeasibleError, match=r"gusts of 0\.0 m/s .* engine has failed"):
        plan(scenario(fault={"declared": ["engine"]}), setup=setup)
    assert plan(scenario(), setup=setup).guidance.health.thrust is None


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


@pytest.mark.parametrize(("bank", "rate"), [(45.0, 9.80665 / SPEED), (17.0, 0.1544), (5.0, 0.1544)])
def test_a_vehicle_that_may_only_turn_slowly_is_not_lost_in_turbulence(bank, rate):
    flight = plan(scenario(guidance={"bank_deg": bank, "airspeed_mps": SPEED}))
    assert flight.guidance.health.heading_rate_max == pytest.approx(rate, rel=1e-3)
    assert flight.guidance.tracking.heading_rate_max == pytest.approx(
        9.80665 * math.tan(math.radians(bank)) / SPEED
    )


def test_reports_are_received_beforehand_and_the_filter_knows_their_errors():
    reports = {"interval_s": (2.0, 10.0), "position_sigma_m": 7.0}
    flight = plan(scenario(reports=reports, following={"touches_per_hour": 1e-3}))
    assert len(flight.sensing.received) > 50
    assert flight.guidance.vessel.filter.position_sigma == 7.0
    assert plan(scenario()).guidance.vessel.filter.position_sigma == 0.0
    # A vessel that is not known exactly is somewhere in a disc, and takes more margin.
    assert flight.margin.reach > 7.0 * flight.guidance.vessel.limits.deviations
    assert flight.margin.total > 3.0


def test_what_is_declared_of_the_vessel_is_what_its_discs_are_made_of():
    declared = {"vessel_acceleration_mps2": 0.1, "vessel_speed_max_mps": 12.0}
    changes = {
        "reports": {"interval_s": (2.0, 10.0), "position_sigma_m": 4.0},
        "sensors": {"position_sigma_m": 3.0},
    }
    limits = plan(scenario(following=declared, **changes)).guidance.vessel.limits
    # The UAV's own place is the vessel's too: 3-4-5.
    assert (limits.acceleration, limits.speed_max, limits.position_sigma) == pytest.approx(
        (0.1, 12.0, 5.0), rel=1e-12
    )
    assert plan(scenario()).guidance.vessel.limits.speed_max == math.inf


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


class Faster:
    """A track whose places move faster than its velocity says, by a little."""

    manoeuvres_end = math.nan

    def course(self, _time):
        return 0.0

    def motion(self, time):
        return 8.0199 * time, 0.0, 8.0, 0.0


def test_a_track_of_ones_own_whose_velocity_is_a_little_wrong_is_refused():
    # 0.0199 m/s in the 200 s of the flight: kinematic flights of a law that flies at the ship came
    # within r_min by 6 m in 300 s.
    with pytest.raises(
        InfeasibleError,
        match=r"differ by up to 4 m; 0\.01 m are allowed.*: let the velocity be the derivative",
    ):
        check_declared(scenario(flight={"duration_max_s": 200.0}), Faster())


def test_a_manoeuvre_beyond_what_is_declared_by_a_thousandth_is_refused():
    braking = {
        "speed_mps": 8.0,
        "manoeuvres": [{"at_s": 40.0, "speed_mps": 0.0, "acceleration_mps2": 0.2502}],
    }
    with pytest.raises(
        InfeasibleError, match=r"accelerates by 0\.2502 m/s2.*acceleration_mps2 = 0\.25, on"
    ):
        plan(scenario(vessel=braking, following={"vessel_acceleration_mps2": 0.25}))
    plan(scenario(vessel=braking, following={"vessel_acceleration_mps2": 0.2502}))


def test_a_vessel_that_is_known_exactly_does_no_more_than_is_declared_either():
    braking = {
        "speed_mps": 8.0,
        "manoeuvres": [{"at_s": 40.0, "speed_mps": 0.0, "acceleration_mps2": 0.25}],
    }
    with pytest.raises(
        InfeasibleError,
        match=r"by 0\.25 m/s2.*acceleration_mps2 = 0, on",
    ):
        plan(scenario(vessel=braking))
    plan(scenario(vessel=braking, following={"vessel_acceleration_mps2": 0.25}))
    # Without a guard nothing relies on it.
    plan(scenario(vessel=braking, guidance={"keepout_guard": False}))


def test_a_wind_that_changes_is_an_error_of_the_estimated_one(tmp_path):
    table = tmp_path / "wind.csv"
    table.write_text(
        "time_utc,speed_mps,from_deg\n2026-06-01T12:00:00Z,0,0\n2026-06-01T12:10:00Z,6,0\n2026-06-01T14:00:00Z,6,0\n",
        encoding="utf-8",
    )
    changing = plan(scenario(wind={"table": str(table)}, following={"speed_error_mps": 0.5}))
    # 6 m/s in 600 s, for the 20.6 s that the estimate takes: 0.03 of 19.42 m/s each half second
    # hide 0.02 m/s of wander.
    assert changing.guidance.guard.errors.steady_velocity == pytest.approx(
        0.5 + 0.01 * 0.03 * 19.42 * math.sqrt(0.5) / 0.02
    )
    assert (
        plan(
            scenario(wind={"speed_mps": 9.0}, following={"speed_error_mps": 0.5})
        ).guidance.guard.errors.steady_velocity
        == 0.5
    )


def test_a_start_is_judged_by_the_wind_at_its_height():
    # Abeam to the east of a ship that heads north, on course for it, with 12.2 m/s from astern of
    # the UAV at 120 m, and 9 at 10 m: what is refused does not depend on the height of the funnel.
    given = {
        "start": {"place_m": [0.0, 235.0], "course_deg": -90.0}, "flight": {"altitude_m": 120.0}, "keepout": {"shape": "cylinder"},
        "guidance": {"airspeed_mps": SPEED}, "following": {"climb_gradient": 1e-9},
    }  # fmt: skip
    wind = {"speed_mps": 9.0, "from_deg": 90.0, "roughness_m": 0.01}
    words = set()
    for height in (10.0, 60.0):
        with pytest.raises(
            InfeasibleError, match="where the best turn away comes within"
        ) as refused:
            plan(scenario(wind=wind, plume={"source_height_m": height}, **given))
        words.add(str(refused.value).partition("keepout.radius_m")[0])
    assert len(words) == 1


def test_dead_reckoning_is_reckoned_with_where_satellite_navigation_is_declared_to_fail():
    fault = {"kind": "satellite_navigation", "at_s": (80.0, 80.0)}
    assert (
        plan(
            scenario(following={"drift_rate_mps": 2.0}, fault=fault)
        ).guidance.guard.errors.drift.rate
        == 2.0
    )
    assert plan(scenario(following={"drift_rate_mps": 2.0})).guidance.guard.errors.drift.rate == 0.0


def test_the_guard_keeps_the_deviation_that_is_declared():
    # The kinematic vehicle has none of its own.
    assert plan(scenario()).guidance.guard.errors.response.size == 0.0
    assert (
        plan(scenario(following={"turn_deviation_m": 6.8})).guidance.guard.errors.response.size
        == 6.8
    )


def test_a_vessel_data_fault_silences_its_reports():
    fault = {"kind": "vessel_data", "at_s": (100.0, 100.0), "vessel_data_s": 60.0}
    times = [
        when
        for when, _ in plan(
            scenario(reports={"interval_s": (2.0, 4.0)}, fault=fault)
        ).sensing.received
    ]
    assert not [when for when in times if 100.0 <= when < 160.0]
    assert [when for when in times if when >= 160.0]


def test_periods_are_those_of_the_speed_ratio():
    flight = plan(scenario())
    assert flight.nu == pytest.approx(8.0 / SPEED)
    # The oscillation at the start's ratio, of which the table has the nearest of 49.
    assert flight.period(flight.nu) == pytest.approx(flight.oscillation.period, rel=0.02)
    assert flight.period(0.9) < flight.period(0.1)


def test_the_plumes_elevation_makes_the_altitude_rise_with_distance():
    mission = plan(scenario(plume={"elevation_deg": 10.0})).guidance.mission
    assert (mission.axis.height.climb, mission.axis.height.source) == (
        pytest.approx(math.tan(math.radians(10.0)), rel=1e-12),
        60.0,
    )


def test_following_can_do_without_the_keep_out_guard():
    assert plan(scenario(guidance={"keepout_guard": False})).guidance.guard is None


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
