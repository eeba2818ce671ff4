"""The vessel's motion as the guidance has it: known exactly, or from reports."""

import math

import pytest

from gnc.estimation.reachable_set import ReachableSet, Tube, VesselLimits
from gnc.estimation.target_motion import REPORTED_SCATTER, ReportedTarget, SteadyTarget
from gnc.estimation.vessel_filter import FilterParameters, VesselFilter, VesselReport

TIME_STEP = 0.05
LIMITS = VesselLimits(
    acceleration=0.25,
    speed_max=15.0,
    position_sigma=5.0,
    velocity_sigma=0.15,
    deviations=5.0,
    horizon=9.0,
)


def fields(target):
    return target.north, target.east, target.velocity_north, target.velocity_east


@pytest.mark.parametrize("planning", [True, False])
def test_a_steady_target_goes_straight_on_from_the_origin_and_is_never_old(planning):
    target = SteadyTarget(6.0, -2.5)
    target.update(12.0, planning=planning)
    assert fields(target) == (72.0, -30.0, 6.0, -2.5)
    assert (target.acceleration_north, target.acceleration_east, target.age(12.0)) == (
        0.0,
        0.0,
        0.0,
    )


def reported(*reports):
    known = VesselFilter(
        FilterParameters(position_sigma=5.0, velocity_sigma=0.15, acceleration=0.02, memory=40.0)
    )
    target = ReportedTarget(known, ReachableSet(LIMITS), TIME_STEP)
    for report in reports:
        target.report(VesselReport(*report))
    return target


def test_a_reported_target_is_where_the_filter_has_it_when_the_mission_plans():
    target = reported((0.0, 100.0, -40.0, 6.0, 2.0), (5.0, 130.0, -30.0, 6.5, 2.0))
    target.update(7.0, True)
    seen = target.vessel.at(7.0)
    assert fields(target) == (seen.north, seen.east, seen.velocity_north, seen.velocity_east)
    assert target.age(7.0) == 2.0


def test_of_the_acceleration_of_a_reported_vessel_the_scatter_of_her_reports_is_left_out():
    # 0.5 m/s within 5 s: more than a steady vessel's reports scatter by within the filter, in one
    # direction only.
    target = reported(
        (0.0, 0.0, 0.0, 6.0, 2.0), (5.0, 30.0, 10.0, 6.5, 2.0), (10.0, 66.0, 20.0, 8.0, 2.0)
    )
    target.update(10.0, True)
    seen = target.vessel.at(10.0)
    size = math.hypot(seen.acceleration_north, seen.acceleration_east)
    assert size > REPORTED_SCATTER
    expected = [
        (size - REPORTED_SCATTER) * part / size
        for part in (seen.acceleration_north, seen.acceleration_east)
    ]
    assert (target.acceleration_north, target.acceleration_east) == pytest.approx(
        expected, rel=1e-12
    )
    # A tenth of that is scatter.
    steady = reported((0.0, 0.0, 0.0, 6.0, 2.0), (5.0, 30.0, 10.0, 6.05, 2.0))
    steady.update(7.0, True)
    assert steady.vessel.at(7.0).acceleration_north > 0.0
    assert (steady.acceleration_north, steady.acceleration_east) == (0.0, 0.0)


def test_the_acceleration_of_a_vessel_without_errors_is_taken_as_it_is():
    known = VesselFilter(
        FilterParameters(position_sigma=0.0, velocity_sigma=0.0, acceleration=0.02, memory=40.0)
    )
    target = ReportedTarget(known, ReachableSet(LIMITS), TIME_STEP)
    for report in ((0.0, 0.0, 0.0, 6.0, 2.0), (5.0, 30.125, 10.0, 6.05, 2.0)):
        target.report(VesselReport(*report))
    target.update(7.0, True)
    seen = known.at(7.0)
    assert (target.acceleration_north, target.acceleration_east) == (
        seen.acceleration_north,
        seen.acceleration_east,
    )
    assert 0.0 < target.acceleration_north < REPORTED_SCATTER


def test_between_plans_it_goes_on_at_its_acceleration():
    target = reported((0.0, 100.0, -40.0, 6.0, 2.0), (5.0, 130.0, -30.0, 6.5, 2.0))
    target.update(7.0, True)
    for step in range(1, 10):
        target.update(7.0 + step * TIME_STEP, False)
    seen = target.vessel.at(7.0 + 9 * TIME_STEP)
    # 0.45 s at an acceleration that decays over 40 s, of 0.02 m/s^2 or so: 1 % of 9 mm/s; and half
    # of it, as sums run, of 0.2 mm.
    assert fields(target) == pytest.approx(
        (seen.north, seen.east, seen.velocity_north, seen.velocity_east), abs=1e-3
    )
    # A report that comes meanwhile is used at the next plan.
    target.report(VesselReport(7.4, 0.0, 0.0, 0.0, 0.0))
    before = fields(target)
    target.update(7.5, False)
    assert fields(target) == pytest.approx(before, abs=1.0)
    tubes = target.tubes
    target.update(7.55, True)
    assert target.north < before[0] - 20.0
    assert (tubes[0].time, target.tubes[0].time) == (7.0, 7.55)
    # The newest report's disc is about where it says, 0.15 s on.
    assert (target.tubes[0].north, target.tubes[0].east) == (0.0, 0.0)


def test_a_steady_target_is_one_disc_without_width():
    target = SteadyTarget(6.0, -2.5)
    target.update(12.0, True)
    assert target.tubes == (Tube(0.0, 0.0, 0.0, 6.0, -2.5),)
    assert target.tubes[0].reach(100.0) == 0.0


def test_a_target_that_was_reported_has_a_disc_for_each_report():
    target = reported((0.0, 100.0, -40.0, 6.0, 2.0), (5.0, 130.0, -30.0, 6.5, 2.0))
    assert target.tubes == ()
    target.update(7.0, True)
    # The newest first.
    assert [(tube.velocity_north, tube.velocity_east) for tube in target.tubes] == [
        (6.5, 2.0),
        (6.0, 2.0),
    ]
