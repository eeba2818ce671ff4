"""gnc/EQUATIONS.md names what exists, and lists every difference that the code mentions."""

import ast
import functools
import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "gnc" / "EQUATIONS.md").read_text(encoding="utf-8")
DIFFERENCES, _, AFTER = PAGE.partition("## Errors in the printed text")
ERRORS, _, _ = AFTER.partition("## Why trajectories are bounded")
NAMES = sorted(set(re.findall(r"`(gnc(?:\.\w+)+\.\w+)`", PAGE)))
TESTS = sorted(set(re.findall(r"`([^`]+::[^`]+)`", PAGE)))


@functools.cache
def tree_of(file):
    """Return the syntax tree of a file, by its path from the root."""
    return ast.parse((ROOT / file).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", NAMES)
def test_every_name_on_the_page_exists(name):
    module, _, attribute = name.rpartition(".")
    assert hasattr(importlib.import_module(module), attribute)


@pytest.mark.parametrize("test", TESTS)
def test_every_test_on_the_page_exists(test):
    file, _, function = test.partition("::")
    functions = {node.name for node in tree_of(file).body if isinstance(node, ast.FunctionDef)}
    assert function in functions
