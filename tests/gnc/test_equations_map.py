"""gnc/EQUATIONS.md is complete, and everything it names exists (house style 4)."""

import ast
import functools
import importlib
import inspect
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAP = (ROOT / "gnc" / "EQUATIONS.md").read_text(encoding="utf-8")
EQUATIONS, _, AFTER = MAP.partition("## Where the code differs from the paper")
DIFFERENCES, _, AFTER = AFTER.partition("## Errors in the printed text")
ERRORS, _, _ = AFTER.partition("## Why trajectories are bounded")
ROWS = {
    int(cells[0].strip("()")): cells[1:]
    for cells in (
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in EQUATIONS.splitlines()
        if line.startswith("|")
    )
    if len(cells) == 4 and re.fullmatch(r"\(\d+\)", cells[0])
}
FUNCTIONS = sorted(
    {name for cells in ROWS.values() for name in re.findall(r"`(gnc[\w.]+)`", cells[1])}
)
TEST = re.compile(r"`([^`]+::[^`]+)`")
TESTS = sorted(set(TEST.findall(MAP)))

# "equation (8)", "equations (2), (3) and (4)", "equation (1), and (13)"; also "law (24)", a bare
# "(11)", and "(31a)".
CITATION = re.compile(r"\((\d{1,2})[ab]?\)")


def resolve(name):
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


@functools.cache
def tree_of(file):
    """Return the syntax tree of a file, by its path from the root."""
    return ast.parse((ROOT / file).read_text(encoding="utf-8"))


def module_of(path):
    """Return the dotted name of a file of gnc."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def docstrings():
    """Yield file name and docstring of every module, class and function of gnc."""
    for path in sorted((ROOT / "gnc").rglob("*.py")):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                yield path.name, ast.get_docstring(node) or ""


def names_used(file, function):
    """Return the names that a test uses, and those that the helpers use which it uses, in its file
    and in gnc_cases.py.
    """
    trees = [tree_of("tests/gnc/cases/gnc_cases.py"), tree_of(file)]
    bodies = {
        node.name: node
        for tree in trees
        for node in tree.body
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
    }
    bodies |= {
        target.id: node
        for tree in trees
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    used, waiting = set(), [function]
    while waiting:
        nodes = list(ast.walk(bodies[waiting.pop()]))
        fresh = {node.id for node in nodes if isinstance(node, ast.Name)} | {
            n.attr for n in nodes if isinstance(n, ast.Attribute)
        }
        waiting += [name for name in fresh - used if name in bodies]
        used |= fresh
    return used


def test_each_equation_has_one_row():
    numbers = re.findall(r"^\| \((\d+)\) \|(?:[^|]*\|){3}$", EQUATIONS, flags=re.MULTILINE)
    # Sections III and IV of the paper number their equations (1) to (35).
    assert [int(number) for number in numbers] == list(range(1, 36))


@pytest.mark.parametrize("number", range(1, 36))
def test_each_row_says_what_where_and_how_tested(number):
    what, where, tested = ROWS[number]
    assert what
    assert re.search(r"`gnc(?:\.\w+)+\.\w+`", where) or where.startswith("proof step, verified by")
    assert re.search(r"`tests/[\w/]+\.py::test_\w+`", tested)


@pytest.mark.parametrize("number", range(1, 36))
def test_each_row_s_tests_use_its_functions(number):
    _, where, tested = ROWS[number]
    functions = {name.rpartition(".")[2] for name in re.findall(r"`(gnc[\w.]+)`", where)}
    used = [names_used(*test.split("::")) for test in TEST.findall(tested)]
    assert functions <= set().union(*used)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_named_function_exists_and_cites_its_equations(name):
    cited = {int(number) for number in CITATION.findall(inspect.getdoc(resolve(name)) or "")}
    assert {number for number, cells in ROWS.items() if f"`{name}`" in cells[1]} <= cited


@pytest.mark.parametrize("test", TESTS)
def test_each_named_test_exists(test):
    file, _, function = test.partition("::")
    assert function in {
        node.name for node in tree_of(file).body if isinstance(node, ast.FunctionDef)
    }


def test_every_equation_cited_in_gnc_is_in_the_map():
    cited = {
        (file, int(number)) for file, text in docstrings() for number in CITATION.findall(text)
    }
    assert {(file, number) for file, number in cited if number not in ROWS} == set()
    # The search does find citations: of all equations that have a function, which are all but the
    # proof steps.
    assert {number for _, number in cited} >= set(ROWS) - {28, 29}


def test_every_place_where_gnc_says_that_it_differs_is_in_the_list_of_differences():
    for path in sorted((ROOT / "gnc").rglob("*.py")):
        for node in ast.walk(tree_of(path)):
            if (
                isinstance(node, ast.ClassDef | ast.FunctionDef)
                and "differs " in (ast.get_docstring(node) or "").lower()
            ):
                assert f"`{module_of(path)}.{node.name}`" in DIFFERENCES


def test_each_error_in_the_text_says_where_what_and_why():
    rows = [line.strip("|").split("|") for line in ERRORS.splitlines() if line.startswith("| ")][1:]
    # Among them what this section was written for: the factor of (32).
    assert any(row[0].strip() == "(32)" for row in rows)
    assert all(len(row) == 4 and all(cell.strip() for cell in row) for row in rows)


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(gnc(?:\.\w+)+\.\w+)`", MAP))))
def test_every_name_in_the_map_exists(name):
    assert resolve(name) is not None
