"""How much larger a disc is planned because reports scatter: against reports as they are received,
filtered and kept.
"""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from gnc.estimation.vessel import ReachableSet, VesselFilter, VesselReport, tube
from scenarios.planning.limits import PLAN_PERIOD
from scenarios.planning.margin.keepout_margin import (
    GUARDED_PER_HOUR,
    filter_parameters,
    vessel_limits,
    widest_tube,
)
from scenarios.scenario.files import load_study, with_values
from scenarios.world.ais.track import received_reports
from scenarios.world.vessel import SteadyVessel

TURN = 6.7
"""Duration of a turn away of the X8 [s]."""


def declared(**values):
    """Return a scenario with reports as by AIS of a ship that keeps her course and speed."""
    given = {"reports.interval_s": [2.0, 10.0], "reports.latency_max_s": 2.0} | values
    return with_values(load_study("sea_wind"), given)


def oldest(scenario, **changes):
    """Return what vessel and reports keep within, and the disc of a report that is as old as it
    becomes.
    """
    limits, reports = replace(vessel_limits(scenario, TURN), **changes), scenario.reports
    return limits, tube(
        VesselReport(
            -PLAN_PERIOD - reports.interval_s[1] - reports.latency_max_s, 0.0, 0.0, 0.0, 0.0
        ),
        limits,
        0.0,
    )


def reaches(scenario, limits, hours):
    """Return how far north of where the vessel is taken to be her discs reach, just before each
    report [m].
    """
    received = received_reports(
        scenario.reports,
        SteadyVessel(7.0, 0.0),
        duration=3600.0 * hours,
        outages=(),
        generator=np.random.default_rng(3),
    )
    known, reach, found = (
        VesselFilter(filter_parameters(scenario.reports)),
        ReachableSet(limits),
        [],
    )
    for (_, report), (until, _) in itertools.pairwise(received):
        known.report(report)
        reach.report(report)
        taken = known.at(until)
        north = taken.north + TURN * taken.velocity_north
        found.append(
            min(
                disc.north + TURN * disc.velocity_north + disc.reach(TURN)
                for disc in reach.tubes(until)
            )
            - north
        )
    # With the first reports the filter knows less.
    return np.array(found[12:])


@pytest.mark.parametrize("acceleration", [0.0, 0.1, 0.25])
def test_discs_reach_farther_than_planned_as_often_as_is_allowed(acceleration):
    scenario, hours = declared(**{"following.vessel_acceleration_mps2": acceleration}), 12.0
    limits, disc = oldest(scenario)
    widest = widest_tube(limits, scenario.reports, plan_period=PLAN_PERIOD)
    found = reaches(scenario, limits, hours)
    # 12 are expected at most; of a Poisson variable of that mean one in a thousand is above 24.
    assert np.count_nonzero(found > widest.reach(TURN)) <= 2.0 * hours * GUARDED_PER_HOUR
    # The disc of a report that is as old as it becomes is not enough.
    assert np.count_nonzero(found > disc.reach(TURN)) > 3.0 * hours * GUARDED_PER_HOUR
