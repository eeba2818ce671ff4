"""The JSON Schema of scenario files, with which an editor completes and checks them."""

import json
import re
import tomllib
from datetime import datetime
from pathlib import Path

import pytest
from jsonschema import Draft4Validator

from scenarios.cli.schema import file_schema
from scenarios.errors import InputError
from scenarios.scenario.files import bases, catalog, load_study

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def validator():
    return Draft4Validator(file_schema())


def wrong(validator, text):
    """Return the dotted keys at which a schema refuses a text."""
    document = json.loads(json.dumps(tomllib.loads(text), default=as_text))
    return [".".join(map(str, error.absolute_path)) for error in validator.iter_errors(document)]


def as_text(value):
    # Taplo hands a time to its validator as text.
    assert isinstance(value, datetime)
    return value.isoformat()


def examples():
    """Yield the TOML in documentation that is of a scenario: what the program reads."""
    for page in sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("extensions/**/*.md")]):
        if "_build" in page.parts:
            continue
        for number, text in enumerate(re.findall(r"```toml\n(.*?)```", page.read_text(), re.S)):
            yield pytest.param(text, id=f"{page.stem}-{number}")


def is_read(document):
    try:
        load_study({"title": "An example", **document}, refusing=False)
    except InputError:
        return False
    return True


def test_it_is_a_schema_of_draft_4(validator):
    Draft4Validator.check_schema(validator.schema)
    # Keywords of later drafts, which an editor with draft 4 would pass over in silence.
    later = ("$defs", "$ref", "const", "prefixItems", "discriminator", "format")
    text = json.dumps(validator.schema)
    assert [word for word in later if f'"{word}":' in text] == []
    assert '"null"' not in text
    assert ": null" not in text


@pytest.mark.parametrize("path", [*catalog().values(), *bases().values()], ids=lambda of: of.stem)
def test_every_scenario_of_the_project_is_accepted(path, validator):
    assert wrong(validator, path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("text", [*examples()])
def test_an_example_that_the_program_reads_is_accepted(text, validator):
    if is_read(tomllib.loads(text)):
        assert wrong(validator, text) == []


@pytest.mark.parametrize(
    "text",
    [
        'payload = ["sniffer"]',
        "[sweep.wind]\nspeed_mps = [0.0, 5.0]",
        "extends = false",
        "[place]\nutc = 2026-06-01T12:00:00Z",
        "[guidance]\nlaw = 'mine.py:Mine'\nkey_of_mine = 'word'",
        "[emission]\nship = {length_m = 100.0}",
    ],
)
def test_what_the_loader_brings_into_form_is_accepted(text, validator):
    assert wrong(validator, text) == []


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("titel = 'A study'", ""),
        ("[wind]\nspeed_mps = 'fast'", "wind.speed_mps"),
        ("[wind]\nspeed_mps = true", "wind.speed_mps"),
        ("[keepout]\nshape = 'cube'", "keepout.shape"),
        ("[reports]\ninterval_s = [1.0, 2.0, 3.0]", "reports.interval_s"),
        ("[sweep]\nnu = 0.3", "sweep.nu"),
        ("fidelity = 'seven_dof'", "fidelity"),
    ],
)
def test_a_wrong_key_or_value_is_refused_where_it_stands(text, key, validator):
    assert {*wrong(validator, text)} == {key}
    assert not is_read(tomllib.loads(text))
