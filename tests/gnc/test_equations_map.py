"""gnc/EQUATIONS.md is complete, and everything it names exists (house style 4)."""

import ast
import importlib
import inspect
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAP = (ROOT / "gnc" / "EQUATIONS.md").read_text(encoding="utf-8")
EQUATIONS, _, DIFFERENCES = MAP.partition("## Where the code differs from the paper")
ROWS = {
    int(cells[0].strip("()")): cells[1:]
    for cells in ([cell.strip() for cell in line.strip("|").split("|")] for line in EQUATIONS.splitlines() if line.startswith("|"))
    if len(cells) == 4 and re.fullmatch(r"\(\d+\)", cells[0])
}
FUNCTIONS = sorted({name for cells in ROWS.values() for name in re.findall(r"`(gnc[\w.]+)`", cells[1])})
TESTS = sorted({test for cells in ROWS.values() for test in re.findall(r"`([^`]+::[^`]+)`", cells[2])})

# "equation (8)", "equations (2), (3) and (4)", "equation (1), and (13)"; also "law (24)" and a bare "(11)".
CITATION = re.compile(r"\((\d{1,2})\)")


def resolve(name):
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


def docstrings():
    """Yield file name and docstring of every module, class and function of gnc."""
    for path in sorted((ROOT / "gnc").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                yield path.name, ast.get_docstring(node) or ""


def test_each_equation_from_1_to_30_has_one_row():
    numbers = re.findall(r"^\| \((\d+)\) \|(?:[^|]*\|){3}$", EQUATIONS, flags=re.MULTILINE)
    # Sections III and IV of the paper number their equations (1) to (35); the map says that the last five come later.
    assert [int(number) for number in numbers] == list(range(1, 31))
    assert "(31) to (35)" in MAP


@pytest.mark.parametrize("number", range(1, 31))
def test_each_row_says_what_where_and_how_tested(number):
    what, where, tested = ROWS[number]
    assert what
    assert re.search(r"`gnc\.\w+\.\w+`", where) or where.startswith("proof step, verified by")
    assert re.search(r"`tests/[\w/]+\.py::test_\w+`", tested)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_named_function_exists_and_cites_its_equations(name):
    cited = {int(number) for number in CITATION.findall(inspect.getdoc(resolve(name)) or "")}
    assert {number for number, cells in ROWS.items() if f"`{name}`" in cells[1]} <= cited


@pytest.mark.parametrize("test", TESTS)
def test_each_named_test_exists(test):
    file, _, function = test.partition("::")
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert function in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_every_equation_cited_in_gnc_is_in_the_map():
    cited = {(file, int(number)) for file, text in docstrings() for number in CITATION.findall(text)}
    assert {(file, number) for file, number in cited if number not in ROWS} == set()
    # The search does find citations: of all equations that have a function, which are all but the proof steps.
    assert {number for _, number in cited} >= set(ROWS) - {28, 29}


def test_every_place_where_gnc_says_that_it_differs_is_in_the_list_of_differences():
    for path in sorted((ROOT / "gnc").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and "differs " in (ast.get_docstring(node) or "").lower():
                assert f"`gnc.{path.stem}.{node.name}`" in DIFFERENCES


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(gnc\.\w+\.\w+)`", MAP))))
def test_every_name_in_the_map_exists(name):
    assert resolve(name) is not None
