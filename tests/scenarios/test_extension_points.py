"""Parts that a user adds, each by one file: they fly in a sweep, and are refused or fail in one
line.
"""

from dataclasses import replace

import pytest
from flight_cases import fly, replay_here, run_here

from common.registry import file_hash
from scenarios.errors import InputError
from tests.run_tables import manifest_of, rows_of
from tests.scenarios.plugin_files import LAW, PARTS, line_of, write_scenario


@pytest.fixture
def designed_names(monkeypatch, tmp_path, designs):
    """The names of aircraft that an autopilot is designed for: each has the X8's, as a design takes
    seconds.
    """
    made, names = designs("x8"), []
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def design(spec, altitude):
        names.append(spec.name)
        schedule = replace(made.design.schedule, spec=spec, envelope=spec.envelope)
        return replace(made.design, schedule=schedule)

    monkeypatch.setattr("innerloop.designer.design_autopilot", design)
    monkeypatch.setattr("innerloop.record.design_record", lambda *_: made.record)
    return names


@pytest.mark.slow
@pytest.mark.parametrize(("key", "name"), PARTS.items())
def test_a_part_of_one_file_flies_in_a_sweep_and_stands_in_the_manifest(
    tmp_path, designed_names, key, name
):
    path = write_scenario(tmp_path, line_of(key, name))
    # An aircraft is one in six degrees of freedom, with an autopilot of its own.
    run_here(path, tmp_path / "run", *(["fidelity=six_dof"] if key == "aircraft" else []))
    assert designed_names == (["slow_x8"] if key == "aircraft" else [])
    rows = rows_of(tmp_path / "run")
    assert [row["nu"] for row in rows] == [0.3, 0.5]
    for row in rows:
        assert (row["outcome"], row["keepout_violations"]) == ("completed", 0), row["message"]
        assert row["aircraft"] == (str(tmp_path / name) if key == "aircraft" else "none")
    part = str(tmp_path / name)
    assert manifest_of(tmp_path / "run")["plugins"] == {part: file_hash(part)}
    config = manifest_of(tmp_path / "run")["config"]
    section, _, last = key.partition(".")
    value = config[section][last] if last else config[section]
    assert value == ({"instruments": [part]} if key == "payload" else part)


WRONG_TASK = LAW.replace("Pursuit:", "Part:\n    unsupported_tasks = {'oscillaton': 'no'}")
OBJECT = "class Of:\n    motion = course = id\nPart = Of()\n"


@pytest.mark.parametrize(
    ("key", "text", "words"),
    [
        ("guidance.law", "import nowhere_to_be\n", "own.py: load() failed: ModuleNotFoundError"),
        ("guidance.law", "import sys\nsys.exit(0)\n", "own.py: load() failed: SystemExit: 0"),
        ("guidance.law", "\n1 / 0\n", "ZeroDivisionError: division by zero (own.py:2)"),
        ("vessel.track", OBJECT, "is an object of class Of; give the class itself"),
        ("guidance.law", WRONG_TASK, "did you mean 'oscillation'? tasks are oscillation and"),
        ("study", "class Part: ...\n", "has no method work(); see the Protocol in"),
        ("guidance.law", "class Pert: ...\n", "own.py has no 'Part'; did you mean 'Pert'?"),
        ("aircraft", "Part = 3\n", "own.py:Part' is of type int; it must be an AircraftSpec"),
    ],
)
def test_a_file_that_does_not_load_or_is_not_the_part_is_refused_in_one_line(
    tmp_path, key, text, words
):
    path = write_scenario(tmp_path, line_of(key, "own.py:Part"), text)
    with pytest.raises(InputError) as refused:
        run_here(path, tmp_path / "run")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "run").exists()


def test_a_part_that_raises_in_flight_makes_a_row_that_says_where(tmp_path):
    raises = '        if reference.course > 0.5:\n            raise RuntimeError("lost")\n'
    text = LAW.replace("        lead =", f"{raises}        lead =")
    run_here(write_scenario(tmp_path, 'guidance.law = "own.py:Pursuit"\n', text), tmp_path / "run")
    line = text.splitlines().index('            raise RuntimeError("lost")') + 1
    message = f"steering law 'Pursuit': heading_rate() failed: RuntimeError: lost (own.py:{line})"
    found = [(row["outcome"], row["message"]) for row in rows_of(tmp_path / "run")]
    assert found == [("failed", message)] * 2


def test_a_run_is_resumed_and_replayed_with_the_same_file_only(tmp_path):
    path = write_scenario(tmp_path, 'guidance.law = "own.py:Pursuit"\n', LAW)
    out = tmp_path / "run"
    run_here(path, out, "sweep.nu=[0.5]")

    def resume():
        return run_here(path, out, "sweep.nu=[0.5]", resume=True)

    def replay():
        return replay_here(out / "flights" / "nu_0.50", tmp_path / "again")

    assert resume().all_met
    assert replay().all_met
    (tmp_path / "own.py").write_text(LAW.replace("1.2", "1.3"), encoding="utf-8")
    for again in (resume, replay):
        with pytest.raises(InputError, match=r"own\.py' has changed since the run"):
            again()


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
        ("TrackWithoutArguments", "TrackWithoutArguments() failed: TypeError: "),
        ("TrackInDegrees", ": course(0) is 90 rad, and the velocity of motion(0) points to 1.571"),
        ("TrackOfThree", ": motion(0) returned (0.0, 0.0, 8.0); it has to be 4 finite numbers"),
        ("TrackThatRaises", ": motion(3) failed: KeyError: 'boom' (own.py:19)"),
        ("PlumeOfNothing", ": axis(0) returned nan; it has to be a finite number, the course"),
        ("ShapeOfNone", ": design() returned None; it has to be an orbit, with finite nu, speed"),
        ("ShapeOfOtherWords", ": design() failed: TypeError: ShapeOfOtherWords.design() got an"),
        ("ShapeThatIsNotSteered", ": swing() returned None; it has to be courses, with the"),
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
