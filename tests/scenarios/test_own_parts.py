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
class TrackInDegrees(Track):
    def course(self, time): return 90.0
    def motion(self, time): return 0.0, self.speed * time, 0.0, self.speed
class TrackOfThree(Track):
    def motion(self, time): return self.speed * time, 0.0, self.speed
class TrackThatRaises(Track):
    def motion(self, time): return super().motion(time if time < 3.0 else {}["boom"])

class Plume:
    def __init__(self, plume, vessel, wind, duration, *, by_wind): pass
    def axis(self, time): return math.pi
class PlumeOfNothing(Plume):
    def axis(self, time): return math.nan
class PlumeOfNone(Plume):
    def axis(self, time): return None

@dataclass(frozen=True)
class ShapeOfNone(Sinusoid):
    def design(self, **limits): return None
@dataclass(frozen=True)
class ShapeOfOtherWords(Sinusoid):
    def design(self, heading_rate): return None
@dataclass(frozen=True)
class ShapeThatIsNotSteered(Sinusoid):
    def swing(self, **limits): return None
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
            "TrackInDegrees",
            ": course(0) is 90 rad, and the velocity of motion(0) points to 1.571 rad; let them agree",
        ),
        (
            "TrackOfThree",
            ": motion(0) returned (0.0, 0.0, 8.0); it has to be 4 finite numbers, north, east [m] and their",
        ),
        ("TrackThatRaises", ": motion(3) failed: KeyError: 'boom' (own.py:19)"),
        (
            "PlumeOfNothing",
            ": axis(0) returned nan; it has to be a finite number, the course along which the plume trails",
        ),
        ("PlumeOfNone", ": axis(0) returned None; it has to be a finite number"),
        (
            "ShapeOfNone",
            ": design() returned None; it has to be an orbit, with finite nu, speed, eta, omega_0, amplitude, period, crossing_interval",
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
