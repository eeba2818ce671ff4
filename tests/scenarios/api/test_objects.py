"""Parts that are given as objects fly as those that are named by their files, and are refused in
one line.
"""

import math
from dataclasses import dataclass

import pytest

from scenarios import fly, run
from scenarios.api.scenario import load

pytestmark = pytest.mark.slow

SHORT = {
    "title": "One short flight",
    "fidelity": "kinematic",
    "sweep": {"nu": [0.5]},
    "flight": {"crossings": 2},
    "criteria": {"crossing_interval_error": False, "tracking_error_rms_m": False},
}


@dataclass(frozen=True, kw_only=True)
class Pursuit:
    """The law of docs/howto/extending.md."""

    gain: float = 1.2
    lead_s: float = 1.0

    def heading_rate(self, reference, own, air):
        lead = self.lead_s * reference.speed
        sight = math.atan2(
            reference.east - own.east + lead * math.sin(reference.course),
            reference.north - own.north + lead * math.cos(reference.course),
        )
        return self.gain * math.remainder(sight - own.course, math.tau) + reference.heading_rate


def test_a_law_as_an_object_brings_its_parameters():
    scenario = load(SHORT, law=Pursuit(gain=1.5))
    assert (scenario["guidance.law"], scenario["guidance.gain"], scenario["guidance.lead_s"]) == (
        "Pursuit",
        1.5,
        1.0,
    )


def test_a_law_as_an_object_flies_as_the_one_of_the_file():
    named = fly(SHORT, law=f"{__file__}:Pursuit", **{"guidance.gain": 1.5})
    given = fly(SHORT, law=Pursuit(gain=1.5))
    assert given.history.equals(named.history)
    assert not given.history.equals(fly(SHORT, law=Pursuit).history)


def test_laws_are_compared_and_swept_in_other_processes():
    laws = {
        "sweep.guidance.law": ["cascade", Pursuit],
        "comparison.variants": [{"name": "soft", "set": {"guidance.law": Pursuit}}],
    }
    study = run(SHORT, jobs=2, **laws)
    assert list(study.flights) == [
        "nu_0.50_law_cascade", "nu_0.50_law_Pursuit", "nu_0.50_law_cascade_soft", "nu_0.50_law_Pursuit_soft",
    ]  # fmt: skip
    assert study.flights["nu_0.50_law_cascade_soft"].history.equals(
        study.flights["nu_0.50_law_Pursuit"].history
    )
