"""Parts that a user adds, each by one file: they fly in a sweep, stand in its manifest, and are
refused in one line.
"""

from dataclasses import replace

import pytest

from common.registry import file_hash
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import fly_study
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from scenarios.studies.replay import Replay
from tests.run_tables import manifest_of, rows_of
from tests.scenarios.plugin_files import LAW, PARTS, line_of, write_scenario


def run(path, out, *overrides, resume=False):
    scenario = load_study(path, overrides)
    return run_study(
        scenario, "own", out, executor_factory=InProcessExecutor, resume=resume, overrides=overrides
    )


def refusal(path, out, *overrides, resume=False):
    with pytest.raises(InputError) as refused:
        run(path, out, *overrides, resume=resume)
    message = str(refused.value)
    assert "\n" not in message
    return message


@pytest.fixture
def asked(monkeypatch, tmp_path, designs):
    """The names of aircraft that an autopilot was asked for: each has the X8's, as a design of its
    own takes seconds.
    """
    # Before the cache is another one, in which there is none.
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
def test_a_part_of_one_file_flies_in_a_sweep_and_stands_in_the_manifest(tmp_path, asked, key, name):
    path = write_scenario(tmp_path, line_of(key, name))
    # An aircraft is one in six degrees of freedom, with an autopilot of its own.
    run(path, tmp_path / "run", *(["fidelity=six_dof"] if key == "aircraft" else []))
    assert asked == (["slow_x8"] if key == "aircraft" else [])
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


@pytest.mark.parametrize(
    ("key", "text", "words"),
    [
        (
            "guidance.law",
            "import nowhere_to_be_found\n",
            "own.py: load() failed: ModuleNotFoundError: No module named 'nowhere_to",
        ),
        ("guidance.law", "import sys\nsys.exit(0)\n", "own.py: load() failed: SystemExit: 0"),
        (
            "guidance.law",
            "\n1 / 0\n",
            "own.py: load() failed: ZeroDivisionError: division by zero (own.py:2)",
        ),
        (
            "vessel.track",
            "class Of:\n    motion = course = id\nPart = Of()\n",
            "is an object of class Of; give the class itself",
        ),
        (
            "guidance.law",
            LAW.replace("Pursuit:", "Part:\n    unsupported_tasks = {'oscillaton': 'no'}"),
            "has the task 'oscillaton' in unsupported_tasks; did you mean 'oscillation'? tasks are oscillation and standoff",
        ),
        (
            "study",
            "class Part: ...\n",
            "has no method work(); see the Protocol in scenarios.studies",
        ),
        ("guidance.law", "class Pert: ...\n", "own.py has no 'Part'; did you mean 'Pert'?"),
        (
            "guidance.law",
            "class Part: ...\n",
            "has no method heading_rate(); see the Protocol in gnc.laws",
        ),
        ("aircraft", "Part = 3\n", "own.py:Part' is of type int; it must be an AircraftSpec"),
    ],
)
def test_a_file_that_does_not_load_or_is_not_the_part_is_refused_in_one_line(
    tmp_path, key, text, words
):
    (tmp_path / "beside.py").touch()
    message = refusal(write_scenario(tmp_path, line_of(key, "own.py:Part"), text), tmp_path / "run")
    assert words in message
    assert "own.py" in message
    assert not (tmp_path / "run").exists()


def test_a_part_that_raises_in_flight_makes_a_row_that_says_where(tmp_path):
    text = LAW.replace(
        "        lead =",
        '        if reference.course > 0.5:\n            raise RuntimeError("lost")\n        lead =',
    )
    run(write_scenario(tmp_path, 'guidance.law = "own.py:Pursuit"\n', text), tmp_path / "run")
    rows = rows_of(tmp_path / "run")
    line = text.splitlines().index('            raise RuntimeError("lost")') + 1
    assert [(row["outcome"], row["message"]) for row in rows] == [
        (
            "failed",
            f"steering law 'Pursuit': heading_rate() failed: RuntimeError: lost (own.py:{line})",
        )
    ] * 2


def test_a_run_is_resumed_and_replayed_with_the_same_file_only(tmp_path):
    path = write_scenario(tmp_path, 'guidance.law = "own.py:Pursuit"\n', LAW)
    run(path, tmp_path / "run", "sweep.nu=[0.5]")
    flight = str(tmp_path / "run" / "flights" / "nu_0.50")

    def replay(out):
        return fly_study(
            Replay(flight),
            out,
            executor_factory=InProcessExecutor,
            resume=False,
            progress=lambda *_: None,
        )

    assert run(path, tmp_path / "run", "sweep.nu=[0.5]", resume=True).all_met
    assert replay(tmp_path / "again").all_met
    (tmp_path / "own.py").write_text(LAW.replace("1.2", "1.3"), encoding="utf-8")
    assert "has changed since the run" in refusal(
        path, tmp_path / "run", "sweep.nu=[0.5]", resume=True
    )
    with pytest.raises(
        InputError,
        match=r"own\.py' has changed since the run; use it as it was then, or start a new run",
    ):
        replay(tmp_path / "changed")
