"""What the hash of the source covers: whatever decides the results of a flight."""

import ast
from pathlib import Path

import pytest

from scenarios.engine.fingerprint import SOURCE, fingerprint, source_hash

ROOT = Path(__file__).parents[3]

SHOWS = {"reports"}
"""Packages that ``scenarios`` imports to show results, on which results do not depend."""


def imported(path):
    """Return the top-level names that a module imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


def test_every_package_that_a_flight_imports_is_in_the_hash():
    found = {
        name
        for package in SOURCE
        for path in (ROOT / package).rglob("*.py")
        for name in imported(path)
    }
    assert {name for name in found if (ROOT / name / "__init__.py").is_file()} - SHOWS == set(
        SOURCE
    )


@pytest.mark.parametrize(
    ("name", "decides"),
    [
        ("measurement/sniffer/sniffer.py", True),
        ("measurement/sniffer/presets/fast.toml", True),
        ("aircraft/models/aircraft/x8/x8.xml", True),
        ("scenarios/planning/theory/crossing_limits.json", True),
        ("scenarios/flight_runner.py", True),
        # Scenarios are compared by their content, and neither documents nor compiled files decide
        # anything.
        ("extensions/arena/catalog/arena.toml", False),
        ("gnc/EQUATIONS.md", False),
        ("scenarios/__pycache__/flight.cpython-311.pyc", False),
        ("reports/build.py", False),
    ],
)
def test_the_hash_changes_with_what_decides_results_and_with_nothing_else(tmp_path, name, decides):
    path = tmp_path / name
    path.parent.mkdir(parents=True)
    path.write_text("one", encoding="utf-8")
    before = source_hash(tmp_path)
    path.write_text("two", encoding="utf-8")
    assert (source_hash(tmp_path) != before) is decides


def test_the_hash_of_this_program_is_that_of_this_source():
    # Past the cache: a file may have been edited since it was filled.
    assert fingerprint.__wrapped__()["source"] == source_hash(ROOT)
