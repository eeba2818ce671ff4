"""Parts of a user's own that are of no use: the flight is a row that names part, method and remedy;
others go on.
"""

import pytest
from flight_cases import fly

from tests.run_tables import rows_of
from tests.scenarios.plugin_files import write_scenario
from tests.scenarios.test_extension_points import refusal, run

PARTS = """
import math
from dataclasses import dataclass
from gnc.reference.shapes import Sinusoid

class Track:
    manoeuvres_end = math.nan
    def __init__(self, vessel, speed, duration): self.speed = speed
    def course(self, time): return 0.0
    def motion(self, time): return self.speed * time, 0.0, self.speed, 0.0

class TrackWithoutArguments(Track):
    def __init__(self): pass
class TrackWithoutEnd(Track):
    manoeuvres_end = None
class TrackElsewhere(Track):
    def motion(self, time): return self.speed * time + 100.0, 50.0, self.speed, 0.0
class TrackAcross(Track):
    def course(self, time): return 1.5
class TrackInDegrees(Track):
    def course(self, time): return 90.0
    def motion(self, time): return 0.0, self.speed * time, 0.0, self.speed
class TrackWithText(Track):
    def course(self, time): return "north"
class TrackOfThree(Track):
    def motion(self, time): return self.speed * time, 0.0, self.speed
class TrackThatEnds(Track):
    def motion(self, time): return super().motion(time) if time < 3.0 else (math.nan,) * 4
class TrackThatRaises(Track):
    def motion(self, time): return super().motion(time if time < 3.0 else {}["boom"])

class Plume:
    def __init__(self, plume, vessel, wind, duration, *, by_wind): pass
    def axis(self, time): return math.pi
class PlumeWithoutWind(Plume):
    def __init__(self, plume, vessel, wind, duration): pass
class PlumeOfNothing(Plume):
    def axis(self, time): return math.nan
class PlumeOfNone(Plume):
    def axis(self, time): return None
class PlumeThatRaises(Plume):
    def axis(self, time): raise RuntimeError("no plume")

@dataclass(frozen=True)
class ShapeOfNone(Sinusoid):
    def design(self, **limits): return None
class ShapeWithoutShare:
    def design(self, **limits): return Sinusoid().design(**limits)
    def swing(self, **limits): return Sinusoid().swing(**limits)
@dataclass(frozen=True)
class ShapeOfOtherWords(Sinusoid):
    def design(self, heading_rate): return None
@dataclass(frozen=True)
class ShapeThatIsNotSteered(Sinusoid):
    def swing(self, **limits): return None
class OrbitWithoutHalves:
    def __init__(self, orbit): self.orbit = orbit
    def __getattr__(self, name):
        if name in ("symmetric", "orbit"): raise AttributeError(name)
        return getattr(self.orbit, name)
@dataclass(frozen=True)
class ShapeWithoutHalves(Sinusoid):
    def design(self, **limits): return OrbitWithoutHalves(super().design(**limits))
class OrbitFromNowhere(OrbitWithoutHalves):
    symmetric = True
    def offset(self, time): raise KeyError("no place")
@dataclass(frozen=True)
class ShapeFromNowhere(Sinusoid):
    def design(self, **limits): return OrbitFromNowhere(super().design(**limits))
@dataclass(frozen=True)
class ShapeForSlowShips(Sinusoid):
    def design(self, *, nu, **limits):
        if nu > 0.4: raise ValueError("no design for fast ships")
        return super().design(nu=nu, **limits)
"""

KEYS = {"Track": ("vessel", "track"), "Plume": ("plume", "model"), "Shape": ("reference", "shape")}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "TrackWithoutArguments",
            "cannot be made: TypeError: TrackWithoutArguments.__init__() takes 1 positional argument but 4",
        ),
        (
            "TrackWithoutEnd",
            " has no manoeuvres_end, the time at which its last manoeuvre ends [s]; give it one, math.nan without",
        ),
        ("TrackElsewhere", " begins at 100 m north and 50 m east; let it begin at the origin"),
        (
            "TrackAcross",
            ": course(0) is 1.5 rad, and the velocity of motion(0) points to 0 rad; let them agree",
        ),
        (
            "TrackInDegrees",
            ": course(0) is 90 rad, and the velocity of motion(0) points to 1.571 rad; let them agree",
        ),
        (
            "TrackWithText",
            ": course(0) returned 'north'; it has to return a finite number: the course, clockwise from north [rad]",
        ),
        (
            "TrackOfThree",
            ": motion(0) returned (0.0, 0.0, 8.0); it has to return four finite numbers: north, east [m] and their",
        ),
        (
            "TrackThatEnds",
            ": motion(3) returned (nan, nan, nan, nan); it has to return four finite numbers",
        ),
        ("TrackThatRaises", " failed in motion(3): KeyError: 'boom' (own.py:29)"),
        (
            "PlumeWithoutWind",
            "unexpected keyword argument 'by_wind'; it is called with plume, vessel, wind, duration, by_wind=...",
        ),
        (
            "PlumeOfNothing",
            ": axis(0) returned nan; it has to return a finite number: the course along which the plume trails",
        ),
        ("PlumeOfNone", ": axis(0) returned None; it has to return a finite number"),
        ("PlumeThatRaises", " failed in axis(0): RuntimeError: no plume (own.py:41)"),
        (
            "ShapeOfNone",
            "returned None; it has to return an orbit, with finite nu, speed, eta, omega_0, amplitude, period, crossing_interval",
        ),
        (
            "ShapeWithoutHalves",
            "amplitude, period, crossing_interval, and symmetric, true or false: it has no symmetric",
        ),
        ("ShapeFromNowhere", "failed in offset() of design() at nu = 0.4119: KeyError: 'no place'"),
        (
            "ShapeWithoutShare",
            " has no turn_rate_fraction_until_tracked, the part of its heading rate that the reference takes until it is tracked",
        ),
        (
            "ShapeOfOtherWords",
            "unexpected keyword argument 'nu'; it is called with nu, speed, vessel_heading_rate",
        ),
        (
            "ShapeThatIsNotSteered",
            ": swing() returned None; it has to return courses, with the methods eta, frequency",
        ),
    ],
)
def test_a_part_that_is_of_no_use_fails_with_its_name_and_what_it_has_to_be(name, words, tmp_path):
    (tmp_path / "own.py").write_text(PARTS.lstrip(), encoding="utf-8")
    section, key = next(of for kind, of in KEYS.items() if name.startswith(kind))
    part = f"{tmp_path / 'own.py'}:{name}"
    more = {"speed_mps": 8.0} if section == "vessel" else {}
    row = fly(**{section: {key: part} | more}, flight={"duration_max_s": 5.0, "crossings": 0}).row
    assert (row["outcome"], row["criteria_met"]) == ("failed", False)
    assert row["message"].startswith(f"{section}.{key} '{part}'")
    assert words in row["message"]
    assert "\n" not in row["message"]


def test_a_shape_that_fails_at_one_point_of_a_sweep_leaves_the_others(tmp_path):
    path = write_scenario(tmp_path, 'reference.shape = "own.py:ShapeForSlowShips"\n', PARTS)
    run(path, tmp_path / "run")
    slow, fast = rows_of(tmp_path / "run")
    assert slow["outcome"] == "completed"
    part, line = (
        f"{tmp_path / 'own.py'}:ShapeForSlowShips",
        PARTS.partition("nu > 0.4")[0].count("\n") + 1,
    )
    words = f"reference.shape '{part}' failed in design() at nu = 0.5: ValueError: no design for fast ships (own.py:{line})"
    assert (fast["outcome"], fast["message"]) == ("failed", words)


STUDY = """
from scenarios.studies.base import FlightStudy

class Ends(FlightStudy):
    def postprocess(self, run, journal, progress): raise SystemExit(7)
"""


def test_a_study_that_ends_the_process_is_an_error_with_its_line(tmp_path):
    path = write_scenario(tmp_path, 'study = "own.py:Ends"\n', STUDY)
    message = refusal(
        path, tmp_path / "run", "sweep.nu=[0.5]", "flight.crossings=0", "flight.duration_max_s=5"
    )
    assert message == f"study '{tmp_path / 'own.py'}:Ends': SystemExit: 7 (own.py:5)"
