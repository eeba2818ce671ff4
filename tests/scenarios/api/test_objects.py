"""Parts that are given as objects fly as those that are named by their files, and are refused in
one line.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from scenarios import fly, run
from scenarios.api.scenario import load
from scenarios.errors import InputError
from scenarios.world.ais.reports import read_ais

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


class Northbound:
    """A track that counts how often it was asked: a state that must not pass from flight to flight."""

    manoeuvres_end = math.nan

    def __init__(self, vessel=None, speed=9.71, duration=math.inf):
        self.speed, self.asked = speed, 0

    def course(self, time):
        return 0.0

    def motion(self, time):
        self.asked += 1
        return self.speed * time, 0.0, self.speed, 0.0


class Clock:
    COLUMNS = ("doubled_s",)

    def __init__(self, scenario, world, generator):
        pass

    def read(self, time, motion, sample):
        return (2.0 * time,)


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


def test_reports_that_are_read_already_are_a_track():
    path = load("ship_from_ais")["vessel.track"]
    scenario = load(
        "ship_from_ais", track=read_ais(path, mmsi=219999001), flight={"duration_max_s": 60.0}
    )
    assert (scenario["vessel.track"], scenario["vessel.mmsi"]) == (path, 219999001)
    # In a section as well, which has no mmsi of its own then.
    in_section = load("ship_from_ais", vessel={"track": read_ais(path, mmsi=219999001)})
    assert in_section["vessel.mmsi"] == 219999001


def test_a_track_is_given_as_a_class_or_as_an_object_of_which_flights_take_copies():
    track = Northbound()
    by_class, by_object = fly(SHORT, nu=0.5, track=Northbound), fly(SHORT, nu=0.5, track=track)
    assert track.asked == 0
    assert by_object.met
    # The class is called with 0.5 times the UAV's 19.42 m/s, which is the 9.71 m/s of the object to
    # rounding.
    np.testing.assert_allclose(
        by_object.history["vessel_north_m"], by_class.history["vessel_north_m"], rtol=1e-12
    )


def local_law():
    @dataclass(frozen=True)
    class Hidden(Pursuit):
        pass

    return Hidden


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"law": object()},
            "guidance.law is an object of class object, which is not a dataclass; write @dataclass(frozen=True)",
        ),
        ({"law": Clock}, "steering law 'Clock' has no method heading_rate()"),
        ({"law": lambda: None}, "has no name; define it by class or def"),
        ({"law": local_law()}, "guidance.law: 'Hidden' cannot be sent to other processes"),
        (
            {"laws": [Pursuit, Pursuit(gain=2.0)]},
            "laws is an object of class Pursuit; give the class itself",
        ),
        (
            {"aircraft": replace(X8, title="Mine")},
            "aircraft 'x8' exists already and is another object",
        ),
        (
            {"aircraft": replace(X8, name="737")},
            "aircraft is an object called '737', the name of one of JSBSim's own",
        ),
        (
            {"aircraft": X8.envelope},
            "aircraft 'Envelope' is of type Envelope; it must be an AircraftSpec",
        ),
        ({"seed": object()}, "seed is an object; it takes a number, a word or a list"),
        ({"wind": {"speed_mps": None}}, "wind.speed_mps: value is None"),
        (
            {"wind": {"sped_mps": 1.0}},
            "unknown key 'wind.sped_mps'; did you mean 'wind.speed_mps'?",
        ),
        ({"following": {"standoff_m": 50.0}}, "key 'following.standoff_m' has no effect here"),
        ({"guidance": {"prevew": True}}, "did you mean 'guidance.preview'?"),
        ({"nu": "fast"}, "nu is 'fast'; give a number, as in nu=0.5, or a list of numbers"),
        ({"nu": 20.0}, "speed ratios lie between 0 and 10"),
        ({"jobs": 0}, "jobs is 0"),
        ({"jobs": 2.5}, "jobs is 2.5"),
    ],
)
def test_what_is_wrong_is_one_line(keys, words, capfd):
    with pytest.raises(InputError) as refused:
        run(SHORT, **keys)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    assert capfd.readouterr() == ("", "")
