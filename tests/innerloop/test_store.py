"""Cached designs are used only if nothing they depend on has changed, in any state of the cache."""

import dataclasses
import hashlib
import math
import pickle
import shutil
from types import SimpleNamespace

import pytest

import aircraft
import common
import innerloop
from aircraft.fleet.x8 import X8
from aircraft.spec import MODELS
from innerloop import store
from innerloop.store import as_text, cache_directory, design_key, designed


@pytest.fixture(autouse=True)
def another_process():
    """Have each test compute the hash of the program, as another process would, and keep none."""
    store.program_hash.cache_clear()
    yield
    store.program_hash.cache_clear()


@pytest.fixture
def requests(monkeypatch, tmp_path, designs):
    """A list of what was designed, from an empty cache; each design is a short form of the X8's."""
    found = designs("x8")
    made = dataclasses.replace(
        found,
        design=dataclasses.replace(found.design, checks=found.design.checks[:8]),
        record={name: found.record[name] for name in ("aircraft", "turn_reversal")},
    )
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    requests = []

    def design(spec, altitude):
        requests.append((spec.name, altitude))
        return made.design

    monkeypatch.setattr("innerloop.designer.design_autopilot", design)
    monkeypatch.setattr("innerloop.record.design_record", lambda *_: made.record)
    return requests


def test_a_design_is_made_once_and_found_again_to_the_last_bit(requests, designs, monkeypatch):
    first = designed(X8)
    # As another process finds it, which has parsed nothing yet.
    store._entry.cache_clear()
    second = designed(X8)
    assert requests == [("x8", 100.0)]
    assert second is not first
    # As text, which has every bit of every number.
    assert as_text(second) == as_text(first)
    # What was made may hold figures of numpy where Python's own come back.
    made = designs("x8")
    assert as_text(first.design.schedule) == as_text(made.design.schedule)
    for mine, other in zip(
        sum(made.design.schedule.models, ()), sum(second.design.schedule.models, ()), strict=True
    ):
        for matrix in "ABCD":
            # Also as it lies in memory, by which products are rounded.
            assert getattr(mine, matrix).tobytes("A") == getattr(other, matrix).tobytes("A")


@pytest.mark.parametrize(
    "change",
    [
        {"envelope": dataclasses.replace(X8.envelope, bank=math.radians(44.0))},
        {"configuration": (("propulsion/fuel_freeze", 1.0),)},
        {"inputs": (dataclasses.replace(X8.inputs[0], upper=0.9), *X8.inputs[1:])},
        {"title": "Skywalker"},  # it is in the record
    ],
)
def test_any_change_of_the_spec_is_another_key(change):
    assert design_key(dataclasses.replace(X8, **change), 100.0) != design_key(X8, 100.0)


def test_the_same_model_elsewhere_on_disk_is_the_same_key_and_any_changed_file_of_it_another(
    tmp_path,
):
    root = shutil.copytree(MODELS, tmp_path / "models")
    there = dataclasses.replace(X8, root=root)
    assert design_key(there, 100.0) == design_key(X8, 100.0)
    for name, number in (
        ("aircraft/x8/x8.xml", "0.75"),
        ("engine/x8_motor.xml", "."),
        ("engine/x8_propeller.xml", "0.05"),
    ):
        before = design_key(there, 100.0)
        text = (root / name).read_text(encoding="utf-8")
        (root / name).write_text(text.replace(number, f"{number}1", 1), encoding="utf-8")
        assert design_key(there, 100.0) != before, name


@pytest.mark.parametrize(
    ("package", "file"),
    [("aircraft", "spec.py"), ("common", "physics.py"), ("innerloop", "synthesis.py")],
)
def test_any_changed_source_file_is_another_key(monkeypatch, tmp_path, package, file):
    before = design_key(X8, 100.0)
    source = {"aircraft": aircraft, "common": common, "innerloop": innerloop}[package]
    folder = shutil.copytree(next(iter(source.__path__)), tmp_path / package)
    monkeypatch.setattr(store, package, SimpleNamespace(__path__=[str(folder)]))
    store.program_hash.cache_clear()
    assert design_key(X8, 100.0) == before
    (folder / file).write_text((folder / file).read_text(encoding="utf-8") + "\n", encoding="utf-8")
    store.program_hash.cache_clear()
    assert design_key(X8, 100.0) != before


def hashed(text):
    """Return a file of the cache with this text, as anyone can make one."""
    return f"{hashlib.sha256(text.encode()).hexdigest()}\n{text}".encode()


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\xff\xfe",
        pickle.dumps({"design": 1}),
        hashed("{}x"),
        hashed('{"made": {"design": []}}'),
        hashed('{"other": 1}'),
        hashed("[" * 100_000),
    ],
)
def test_a_file_that_holds_no_design_is_ignored_and_replaced(requests, content):
    designed(X8)
    (file,) = cache_directory().glob(f"*{store.SUFFIX}")
    file.write_bytes(content)
    for _ in range(2):
        assert designed(X8).record["aircraft"] == "x8"
        assert len(requests) == 2


def test_a_cache_that_cannot_be_written_is_done_without(requests, monkeypatch, tmp_path):
    # A file where the directory should be: also root may not write below it.
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert designed(X8).record["aircraft"] == "x8"
    assert designed(X8).record["aircraft"] == "x8"
    assert len(requests) == 2
