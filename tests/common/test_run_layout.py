"""The names of a run directory's files stand in one place."""

import re
from pathlib import Path

import pytest

from common import run_layout
from common.run_layout import time_history_path

PROJECT = Path(__file__).parents[2]

NAMES = [
    value
    for name, value in vars(run_layout).items()
    if name.isupper() and isinstance(value, str) and "." in value[1:]
]


def test_time_histories_stand_in_a_directory_of_their_own():
    assert time_history_path("nu_0500") == "flights/nu_0500.parquet"


def test_the_list_of_names_is_not_empty():
    assert {"manifest.json", "summary.csv", "crossings.csv"} <= set(NAMES)


@pytest.mark.parametrize(
    "room", ["aircraft", "gnc", "innerloop", "scenarios", "reports", "benchmarks"]
)
def test_no_other_file_spells_a_name_out_in_code(room):
    # Docstrings, and help texts, may: they are read by people. So a name that is a whole string, or
    # ends one, is looked for.
    spelt = re.compile(rf"""["'/]({"|".join(map(re.escape, NAMES))})["']""")
    found = [
        f"{path.relative_to(PROJECT)}: {line.strip()}"
        for path in (PROJECT / room).rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if spelt.search(line)
    ]
    assert found == []
