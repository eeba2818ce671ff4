"""A registry: a folder that does not load, and parts that are not its own."""

import sys

import pytest

from common.registry import Registry


def test_a_module_that_does_not_load_hides_no_part_at_the_next_call(tmp_path, monkeypatch):
    package = tmp_path / "parts_of_a_test"
    package.mkdir()
    for name, text in (("__init__", ""), ("begins", "0 / 0"), ("ends", "")):
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    registry = Registry("part", folder=package.name)
    try:
        # Not known by halves, without a word of it.
        for _ in range(2):
            with pytest.raises(ZeroDivisionError):
                registry.names()
        (package / "begins.py").unlink()
        assert registry.names() == []
        assert f"{package.name}.ends" in sys.modules
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == package.name]:
            del sys.modules[name]


def test_a_part_that_is_registered_temporarily_is_not_installed(tmp_path, monkeypatch):
    package = tmp_path / "parts_of_its_own"
    package.mkdir()
    (package / "__init__.py").write_text("", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    registry = Registry("part", folder=package.name)

    class Own: ...

    class Lent: ...

    Own.__module__ = f"{package.name}.own"
    registry.register("own")(Own)
    try:
        with registry.temporarily_registered("lent", Lent):
            assert registry.names() == ["lent", "own"]
            assert registry.installed_names() == ["own"]
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == package.name]:
            del sys.modules[name]
