"""Tracking errors on page 1: large ones that no criterion limits are told with what happened, and
nothing is told twice.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from judged_runs import changed
from trial_runs import with_criterion, with_values

from reports.flights.trials.failures import tracking_lines
from reports.registry import content
from reports.run.trials import read_trials

pytestmark = pytest.mark.usefixtures("without_single_flights")


def test_a_large_tracking_error_that_no_criterion_limits_is_told_with_what_happened_after_settling(
    run,
):
    limited = with_criterion(run, "steady", "tracking_error_rms_m", 1.5)
    far = {
        "tracking_error_rms_m": 39.04,
        "settling_time_s": 60.0,
        "guard_after_settling_s": 3.2,
        "modes": "approach, tracking, outrun",
    }
    (line,) = content(with_values(limited, 3, **far)).verdict.failures
    # The vessel of the second trial turns at 150 s, in both flights; its settling band is the
    # schema's, 5 m.
    assert line == (
        "Turns: 1 of the 2 settled flights lost their track again, by up to 39 m rms; no criterion limits"
        " it: the keep-out guard changed commands in 1 of these and in 0 of the others, the mode was"
        " 'outrun' for a time in 1 of these and in 0 of the others."
    )
    # Of a trial with a criterion that tells; it is not judged by it where it does not have to
    # settle.
    assert content(with_values(limited, 0, tracking_error_rms_m=39.04)).verdict.failures == []
    assert (
        len(
            content(
                with_values(with_criterion(run, "turns", "tracking_error_rms_m", 1.5), 3, **far)
            ).verdict.failures
        )
        == 1
    )


def test_flights_with_a_large_error_are_counted_among_those_that_settled(run):
    error, guard = (
        np.array([39.0, 50.0, 1.0, 1.0, 1.0, np.nan]),
        np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
    )
    trial = read_trials(run)[1]
    rows = pd.concat([trial.rows.iloc[:1]] * 6, ignore_index=True)
    rows = rows.assign(
        tracking_error_rms_m=error,
        guard_after_settling_s=guard,
        settling_time_s=60.0,
        manoeuvre_end_s=np.nan,
        modes="tracking",
    )
    (line,) = tracking_lines(replace(trial, rows=rows))
    assert line == (
        "2 of the 5 settled flights lost their track again, by up to 50 m rms; no criterion limits it:"
        " the keep-out guard changed commands in 2 of these and in 1 of the others."
    )


def test_of_a_flight_alone_page_1_says_why_its_tracking_error_is_large(run):
    only = run.summary.iloc[:1].assign(tracking_error_rms_m=39.04, guard_after_settling_s=0.0)
    manifest = run.manifest | {
        "trials": {"steady": run.manifest["trials"]["steady"] | {"flights": 1}},
        "flights_planned": 1,
    }
    manifest["trial_flights"] = {"steady": 1}
    report = content(changed(run, summary=only, manifest=manifest))
    words = (
        "The flight lost its track again, by 39 m rms; no criterion limits it: nothing in the summary"
        " explains it."
    )
    assert report.verdict.failures[0] == words
