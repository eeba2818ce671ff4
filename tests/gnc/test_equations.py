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


def definitions():
    """Yield the dotted name and the docstring of every class and function of gnc."""
    for path in sorted((ROOT / "gnc").rglob("*.py")):
        file = path.relative_to(ROOT)
        for node in ast.walk(tree_of(file)):
            if isinstance(node, ast.ClassDef | ast.FunctionDef):
                name = ".".join((*file.with_suffix("").parts, node.name))
                yield name, ast.get_docstring(node) or ""


@pytest.mark.parametrize("name", NAMES)
def test_every_name_on_the_page_exists(name):
    module, _, attribute = name.rpartition(".")
    assert hasattr(importlib.import_module(module), attribute)


@pytest.mark.parametrize("test", TESTS)
def test_every_test_on_the_page_exists(test):
    file, _, function = test.partition("::")
    functions = {node.name for node in tree_of(file).body if isinstance(node, ast.FunctionDef)}
    assert function in functions


def test_every_place_where_gnc_says_that_it_differs_is_in_the_list_of_differences():
    differing = [name for name, text in definitions() if "differs from the paper" in text.lower()]
    # Among them the factor that (32) lacks.
    assert "gnc.paper.unforced_rates" in differing
    assert [name for name in differing if f"`{name}`" not in DIFFERENCES] == []


def test_each_error_in_the_text_says_where_what_and_why():
    rows = [line.strip("|").split("|") for line in ERRORS.splitlines() if line.startswith("| ")][1:]
    # Among them the factor of (32).
    assert any(row[0].strip() == "(32)" for row in rows)
    assert all(len(row) == 4 and all(cell.strip() for cell in row) for row in rows)
