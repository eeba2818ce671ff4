"""Parts of a user's own that are of no use: the flight is a row that names part, method and remedy;
others go on.
"""

import pytest
from flight_cases import fly

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
            "TrackWithoutArguments() failed: TypeError: TrackWithoutArguments.__init__() takes 1 positional argument but 4",
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
            ": course(0) returned 'north'; it has to be a finite number, the course, clockwise from north [rad]",
        ),
        (
            "TrackOfThree",
            ": motion(0) returned (0.0, 0.0, 8.0); it has to be 4 finite numbers, north, east [m] and their",
        ),
        (
            "TrackThatEnds",
            ": motion(3) returned (nan, nan, nan, nan); it has to be 4 finite numbers",
        ),
        ("TrackThatRaises", ": motion(3) failed: KeyError: 'boom' (own.py:29)"),
        (
            "PlumeWithoutWind",
            "PlumeWithoutWind() failed: TypeError: PlumeWithoutWind.__init__() got an unexpected keyword argument 'by_wind'",
        ),
        (
            "PlumeOfNothing",
            ": axis(0) returned nan; it has to be a finite number, the course along which the plume trails",
        ),
        ("PlumeOfNone", ": axis(0) returned None; it has to be a finite number"),
        ("PlumeThatRaises", ": axis(0) failed: RuntimeError: no plume (own.py:41)"),
        (
            "ShapeOfNone",
            ": design() returned None; it has to be an orbit, with finite nu, speed, eta, omega_0, amplitude, period, crossing_interval",
        ),
        (
            "ShapeWithoutHalves",
            "amplitude, period, crossing_interval, and symmetric, true or false",
        ),
        ("ShapeFromNowhere", ": offset() failed: KeyError: 'no place' (own.py:65)"),
        (
            "ShapeWithoutShare",
            "it has to be a shape with a number turn_rate_fraction_until_tracked, the fraction of its heading rate",
        ),
        (
            "ShapeOfOtherWords",
            ": design() failed: TypeError: ShapeOfOtherWords.design() got an unexpected keyword argument 'nu'",
        ),
        (
            "ShapeThatIsNotSteered",
            ": swing() returned None; it has to be courses, with the methods eta, frequency",
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
