"""Documents: what they extend, which keys they set, and what is said of keys that are not known."""

import re

import pytest

from scenarios.errors import InputError
from scenarios.experiment.points import points_of
from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study


def write(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def refusal(name, *overrides):
    with pytest.raises(InputError) as refused:
        load_study(name, overrides)
    message = str(refused.value)
    assert "\n" not in message
    return message


def test_a_file_extends_a_scenario_of_the_catalog(tmp_path):
    path = write(
        tmp_path, "own.toml", 'extends = "sea_wind"\ntitle = "own"\n[wind]\nspeed_mps = 3.0\n'
    )
    own, base = load_study(path), load_study("sea_wind")
    assert (own.title, own.wind.speed_mps) == ("own", 3.0)
    same = {"title", "description", "wind"}
    assert own.model_dump(exclude=same) == base.model_dump(exclude=same)


def test_a_chain_of_files_is_resolved_relative_to_each_file(tmp_path):
    (tmp_path / "bases").mkdir()
    write(
        tmp_path / "bases",
        "first.toml",
        'study = "flights"\ntitle = "first"\n[wind]\nspeed_mps = 3.0\nfrom_deg = 10.0\n',
    )
    write(tmp_path / "bases", "second.toml", 'extends = "first.toml"\n[wind]\nspeed_mps = 4.0\n')
    path = write(
        tmp_path,
        "third.toml",
        'extends = "bases/second.toml"\ntitle = "third"\n[vessel]\nspeed_mps = 5.0\n',
    )
    third = load_study(path)
    assert third.title == "third"
    assert (third.wind.speed_mps, third.wind.from_deg, third.vessel.speed_mps) == (4.0, 10.0, 5.0)


SWEPT = """
title = "swept"
fidelity = "kinematic"
[sweep]
nu = [0.3, 0.5]
"wind.speed_mps" = [2, 5]
wind.from_deg = [0, 90]
"""


@pytest.mark.parametrize(
    ("override", "left"),
    [
        ("wind.speed_mps=9", {"nu", "wind.from_deg"}),
        ("wind.from_deg=45", {"nu", "wind.speed_mps"}),
        ("vessel.speed_ratio=0.4", {"wind.speed_mps", "wind.from_deg"}),
        ("keepout.radius_m=150", {"nu", "wind.speed_mps", "wind.from_deg"}),
    ],
)
def test_an_override_of_a_swept_key_ends_its_sweep(tmp_path, override, left):
    path = write(tmp_path, "swept.toml", SWEPT)
    points = points_of(load_study(path, [override]))
    section, key, value = re.fullmatch(r"(\w+)\.(\w+)=(.+)", override).groups()
    assert {getattr(getattr(point.scenario, section), key) for point in points} == {float(value)}
    # Two values of each key that is still swept.
    assert len(points) == 2 ** len(left)
    assert {*load_study(path, [override]).sweep.root} == left


@pytest.mark.parametrize(
    ("override", "gone", "value_of", "expected"),
    [
        (
            "vessel.manoeuvres=[{at_s=100,turn_deg=90}]",
            "vessel.manoeuvres.",
            lambda s: s.vessel.manoeuvres[0].turn_deg,
            90.0,
        ),
        (
            "wind={speed_mps=5,from_deg=20}",
            "wind.",
            lambda s: (s.wind.speed_mps, s.wind.from_deg),
            (5.0, 20.0),
        ),
        ("start.range_m=500", "start.range_m", lambda s: s.start.range_m, 500.0),
        ("vessel.speed_ratio=0.4", "vessel.speed_mps", lambda s: s.vessel.speed_ratio, 0.4),
        ("sweep.nu=[0.4]", "vessel.speed_mps", lambda s: s.vessel.speed_ratio, 0.4),
    ],
)
def test_an_override_ends_what_is_sampled_of_its_key_and_below_it(
    override, gone, value_of, expected
):
    study = load_study("monte_carlo", [override])
    every = [draw.key for draw in load_study("monte_carlo").draws]
    assert [draw.key for draw in study.draws] == [key for key in every if not key.startswith(gone)]
    experiment = Experiment("t", study)
    assert {value_of(experiment.request(number).scenario) for number in range(3)} == {expected}


@pytest.mark.parametrize(
    "override",
    [
        "sweep.wind.from_deg=[0,90]",
        'sweep={"wind.from_deg"=[0,90]}',
        "sweep={wind={from_deg=[0,90]}}",
        "sweep.wind={from_deg=[0,90]}",
    ],
)
def test_a_key_that_a_base_samples_is_swept_in_place_of_that(override, tmp_path):
    # It was refused, as being in sweep and in draws.
    given = write(tmp_path, "own.toml", 'extends = "sea_wind"\nsweep.wind.from_deg = [0, 90]\n')
    for study in (load_study("sea_wind", [override]), load_study(given)):
        assert [draw.key for draw in study.draws] == ["wind.speed_mps", "vessel.speed_mps"]
        experiment = Experiment("t", study)
        flown = [experiment.request(number).scenario.wind for number in range(experiment.flights)]
        assert {wind.from_deg for wind in flown} == {0.0, 90.0}
        # Samples with a speed ratio out of range are sampled again at the point that needs it.
        assert len({wind.speed_mps for wind in flown}) >= study.flights


def test_an_override_of_a_speed_ends_a_sampled_speed_ratio_and_one_of_the_ratio_a_swept_speed(
    tmp_path,
):
    drawn = write(
        tmp_path,
        "drawn.toml",
        'title = "d"\n[[draws]]\nkey = "vessel.speed_ratio"\nuniform = [0.2, 0.5]\n',
    )
    study = load_study(drawn, ["vessel.speed_mps=5"])
    assert (study.draws, study.vessel_speed) == ((), 5.0)
    swept = write(tmp_path, "speeds.toml", 'title = "s"\nsweep.vessel.speed_mps = [5, 6]\n')
    assert [
        point.scenario.vessel_speed
        for point in points_of(load_study(swept, ["vessel.speed_ratio=0.5"]))
    ] == [9.71]
    # Of a sweep of ratios, of which a run is made, the speed does not end anything.
    assert "'vessel.speed_mps' has no effect here" in refusal("sweep_nu", "vessel.speed_mps=5")


@pytest.mark.parametrize(
    ("extends", "words"),
    [
        (
            '"b.toml"',
            "a.toml: extends goes in a circle: b.toml -> a.toml -> b.toml; remove one of them",
        ),
        ('"sea_wnd"', "b.toml: extends: unknown scenario 'sea_wnd'; did you mean 'sea_wind'?"),
        ('"c.toml"', "b.toml: extends: no scenario file 'c.toml'"),
        (
            "3",
            "b.toml: extends is 3; give one catalog name or one path of a TOML file, or false for no base",
        ),
        ('["sea_wind", "sim3"]', "b.toml: extends is ['sea_wind', 'sim3']; give one catalog name"),
    ],
)
def test_what_cannot_be_extended_is_refused_in_one_line(tmp_path, extends, words):
    write(tmp_path, "a.toml", 'extends = "b.toml"\n')
    path = write(
        tmp_path, "b.toml", f'title = "b"\nextends = {extends.replace("b.toml", "a.toml")}\n'
    )
    assert words in refusal(path)
