"""The files that a run takes parts from: all are found and hashed, and one that is gone is refused
in one line.
"""

from dataclasses import fields
from pathlib import Path

import pytest

from common.registry import file_hash
from measurement.emission import Ship
from measurement.sniffer.channel import Channel
from measurement.sniffer.spec import SnifferSpec
from scenarios.errors import InputError
from scenarios.scenario.documentation import described_fields
from scenarios.scenario.files import load_study, with_values
from scenarios.studies.base import run_study
from scenarios.studies.manifest import parameters, plugins, unused_parameters
from tests.scenarios.plugin_files import INSTRUMENT, LAW


def written(folder, text):
    path = folder / "own.toml"
    path.write_text(f'title = "own"\n{text}', encoding="utf-8")
    return load_study(str(path))


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize(
    ("key", "name", "words"),
    [
        ("reference.shape", "gone.py:X", "gone.py: cannot be read: No such file or directory"),
        ("wind.table", "gone.csv", "gone.csv: cannot be read: No such file or directory"),
        ("aircraft", "gone/x", "gone/x': there is no such directory"),
    ],
)
def test_a_part_whose_file_is_gone_is_refused_in_one_line(tmp_path, key, name, words, resume):
    scenario = written(tmp_path, f'{key} = "{name}"\n')
    with pytest.raises(InputError) as refused:
        run_study(scenario, "own", tmp_path / "run", resume=resume)
    message = str(refused.value)
    assert message.startswith(f"{key}: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "part", "code"),
    [
        (
            '[[draws]]\nkey = "payload.instruments"\nchoice = [[], ["own.py:Sniffer"]]\n',
            "own.py:Sniffer",
            INSTRUMENT,
        ),
        (
            'following.margin_law = "own.py:Pursuit"\nturbulence.level = "light"\n',
            "own.py:Pursuit",
            LAW,
        ),
        (
            'turbulence.level = "light"\n[[draws]]\nkey = "following.margin_law"\nchoice = ["own.py:Pursuit"]\n',
            "own.py:Pursuit",
            LAW,
        ),
        ('study = "own.py:Closest"\n', "own.py:Closest", "class Closest: ...\n"),
    ],
)
def test_every_file_that_a_part_comes_from_is_hashed(tmp_path, text, part, code):
    (tmp_path / "own.py").write_text(code, encoding="utf-8")
    name = str(tmp_path / part)
    assert plugins([written(tmp_path, text)]) == {name: file_hash(name)}


def listed(scenario):
    return {parameter["key"]: parameter for parameter in parameters(scenario)}


def test_keys_of_parts_are_listed_with_their_defaults_whether_they_are_set_or_not():
    # Which sniffer gave the verdict was in no table of a report.
    left_out = listed(load_study("sulphur"))["payload.sensor"]
    assert (left_out["value"], left_out["default"]) == ("electrochemical", "electrochemical")
    given = listed(load_study("sulphur", ["payload.sensor=fast"]))["payload.sensor"]
    assert (given["value"], given["default"]) == ("fast", "electrochemical")
    assert given["meaning"] == left_out["meaning"] != ""
    assert "payload.limit_percent" in listed(load_study("sulphur"))


def test_fields_of_laws_are_listed_too_and_are_those_of_the_law_that_is_flown():
    # Those of the cascade are keys of the schema.
    assert not {key for key in listed(load_study("sweep_nu")) if key.startswith("guidance.npfg")}
    given = listed(load_study("sweep_nu", ["guidance.law=npfg"]))["guidance.npfg_damping"]
    assert given["value"] == given["default"]
    assert given["meaning"]


def test_fields_of_a_law_of_ones_own_are_listed_without_a_meaning(tmp_path):
    (tmp_path / "mine.py").write_text(LAW, encoding="utf-8")
    own = listed(written(tmp_path, 'guidance.law = "mine.py:Pursuit"\n'))
    assert own["guidance.lead_s"]["value"] == own["guidance.lead_s"]["default"] == 1.0


def test_keys_without_effect_that_are_scaled_to_an_aircraft_have_their_meanings_too():
    # In a comparison with another aircraft they differ.
    plain = load_study("sweep_nu")
    assert unused_parameters(plain) == []
    (found,) = unused_parameters(with_values(plain, {"following.standoff_m": 250.0}))
    assert (found["key"], found["value"], found["unit"]) == ("following.standoff_m", 250.0, "m")
    assert found["meaning"]
    assert found["key"] not in listed(plain)


def test_every_key_of_a_ship_and_a_sniffer_of_ones_own_has_its_unit_and_meaning():
    study = load_study(str(Path(__file__).parents[3] / "docs" / "examples" / "own_ship.toml"))
    listed = {of["key"]: of for of in parameters(study)}
    # By the docstrings of ship, sniffer and channel; noise is in the unit of its gas.
    units = {
        "emission.ship.power_max": "W",
        "emission.ship.stroke": "",
        "emission.ship.exhaust_temperature_c": "°C",
        "payload.sensor.rate_hz": "1/s",
        "payload.sensor.channels.so2.t90_s": "s",
        "payload.sensor.channels.so2.noise": "ppb",
        "payload.sensor.channels.co2.noise": "ppm",
        "payload.sensor.channels.so2.gain_sd": "",
    }
    assert {key: listed[key]["unit"] for key in units} == units
    assert (
        listed["emission.ship.stack_height"]["meaning"]
        == "Height of the stack's mouth above the sea."
    )
    own = [
        of for key, of in listed.items() if key.startswith(("emission.ship.", "payload.sensor."))
    ]
    # 10 of the ship, 2 of the sniffer, and 6, 4, 3 and 3 of its channels.
    assert len(own) == 28
    assert all(of["meaning"] for of in own)


@pytest.mark.parametrize("made", [Ship, SnifferSpec, Channel])
def test_every_field_that_a_table_of_ones_own_may_have_is_described(made):
    assert set(described_fields(made)) == {field.name for field in fields(made)}
