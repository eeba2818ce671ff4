"""Runs that are changed by a test, with the verdict of what they then hold."""

import math
from dataclasses import replace

from scenarios.measures.verdict import Judge, bound_of
from scenarios.scenario.sections.flight import CriteriaConfig

NONE_IN_TIME = "manoeuvre_end_s"
"""A figure that is not a number in a row: the vessel ended no manoeuvre during the flight."""


def rows_of_table(table):
    """Return the rows of a table as a study has them: a figure that a flight lacks is no key."""
    return [
        {
            key: value
            for key, value in row.items()
            if key == NONE_IN_TIME
            or (value is not None and not (isinstance(value, float) and math.isnan(value)))
        }
        for row in table.to_dict("records")
    ]


def judged(run, *, interrupted=False):
    """Return a run with the verdict of its summary and its manifest."""
    manifest, given = run.manifest, run.manifest.get("trial_flights", {})
    planned = {trial: given.get(trial, 0) for trial in manifest["trials"]}
    judge = Judge(planned)
    for row in rows_of_table(run.summary):
        criteria = manifest["trials"][row["trial"]].get("criteria", {})
        judge.add(row, CriteriaConfig(**criteria))
    verdict = judge.verdict(comparisons=run.verdict.comparisons if run.judgement else {})
    at_random, shared = manifest["sampled_at_random"], manifest["flights_per_sample"]
    trials, samples = {}, 0
    for trial, of in verdict.trials.items():
        samples += of.counts.beside // shared[trial]
        bound = bound_of(of.counts, of.counts.beside // shared[trial])
        trials[trial] = replace(of, bound=bound if at_random[trial] and of.closest else None)
    counts = replace(verdict.counts, planned=manifest["flights_planned"])
    bounded = all(at_random[trial] for trial in trials) and verdict.whole.closest
    whole = replace(
        verdict.whole, counts=counts, bound=bound_of(counts, samples) if bounded else None
    )
    return replace(
        run,
        judgement=replace(
            verdict,
            whole=whole,
            trials=trials,
            required_met=counts.passed == counts.planned,
            interrupted=interrupted,
        ),
    )


def changed(run, **changes):
    """Return a run that is changed, with the verdict of what it then holds."""
    return judged(replace(run, **changes))
