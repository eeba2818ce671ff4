import csv
import io
import math
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from common.text import from_cell
from scenarios.engine.journal import Journal
from scenarios.engine.task import Result, Task
from scenarios.errors import InputError

ROOT = Path(__file__).parents[3]

HOLDS = """
import sys
from pathlib import Path
from scenarios.engine.journal import Journal
from scenarios.engine.task import Result, Task
journal = Journal(Path(sys.argv[1]))
journal.add(Result(task=Task(number=3), tables={"rows.csv": [{"a": 0.1}]}))
print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def journal(tmp_path):
    opened = Journal(tmp_path / "journal.sqlite")
    yield opened
    opened.close()


def result(number, *rows, lost=False, items=1, **tables):
    return Result(
        task=Task(number=number), tables={"rows.csv": list(rows)} | tables, lost=lost, items=items
    )


def rows(journal, table="rows.csv", **places):
    return list(journal.rows(table, **places))


def exported(journal, *columns):
    file = io.StringIO(newline="")
    count = journal.export("rows.csv", columns, file)
    return count, file.getvalue()


def test_rows_come_back_exactly(journal):
    # A sum that is no short decimal, the smallest and the largest numbers, and what there is beside
    # numbers.
    row = {
        "sum": 0.1 + 0.2,
        "small": 5e-324,
        "large": 1.7976931348623157e308,
        "whole": 2**60,
        "word": 'ψ, "β"\n',
        "yes": True,
    }
    journal.add(result(0, row | {"nothing": None, "endless": -math.inf}))
    assert rows(journal) == [row | {"nothing": None, "endless": -math.inf}]
    assert type(rows(journal)[0]["yes"]) is bool


def test_what_is_not_a_number_comes_back_as_such(journal):
    journal.add(result(0, {"a": math.nan, "b": 1.0}))
    (row,) = rows(journal)
    assert math.isnan(row["a"])
    assert row["b"] == 1.0


def test_rows_are_in_the_order_of_their_tasks_whatever_the_order_in_which_they_came(journal):
    for number in (7, 0, 10, 2):
        journal.add(result(number, {"n": number, "i": 0}, {"n": number, "i": 1}))
    assert [(row["n"], row["i"]) for row in rows(journal)] == [
        (n, i) for n in (0, 2, 7, 10) for i in (0, 1)
    ]
    some = journal.numbered("rows.csv", first=2, below=10)
    assert [(number, row["n"]) for number, row in some] == [(2, 2), (2, 2), (7, 7), (7, 7)]
    assert [row["n"] for row in rows(journal, below=1)] == [0, 0]
    assert rows(journal, first=11) == []


def test_each_table_has_its_own_rows(journal):
    journal.add(result(0, {"a": 1}, **{"crossings.csv": [{"b": 1}, {"b": 2}]}))
    journal.add(result(1, {"a": 2}))
    assert rows(journal, "crossings.csv") == [{"b": 1}, {"b": 2}]
    assert rows(journal) == [{"a": 1}, {"a": 2}]
    assert rows(journal, "nothing.csv") == []


def test_an_exported_table_has_exactly_its_columns_and_what_is_missing_is_empty(journal):
    journal.add(result(1, {"b": math.nan, "a": 2.5, "beyond": 3}))
    journal.add(result(0, {"a": 0.1 + 0.2, "b": True}))
    journal.add(result(2, {"b": 'one, "two"\nthree'}, {"a": None}))
    count, text = exported(journal, "a", "b", "c")
    assert count == 4
    assert list(csv.reader(io.StringIO(text, newline=""))) == [
        ["a", "b", "c"],
        # As many digits as give the same number back.
        ["0.30000000000000004", "True", ""],
        ["2.5", "", ""],
        ["", 'one, "two"\nthree', ""],
        ["", "", ""],
    ]
    assert "\r" not in text


def test_a_result_replaces_that_of_the_same_task(journal):
    journal.add(result(0, {"a": 1}, lost=True, items=3))
    journal.add(result(1, {"a": 2}, items=3))
    journal.add(result(0, {"a": 3}, items=3))
    assert rows(journal) == [{"a": 3}, {"a": 2}]
    assert journal.items() == 6


def test_those_whose_process_was_lost_are_in_the_tables_but_are_not_done(journal):
    assert (journal.done(), journal.items()) == (set(), 0)
    journal.add(result(0, {"a": 1}, items=4))
    journal.add(result(1, {"a": 2}, items=4, lost=True))
    journal.add(result(2, {"a": 3}, items=0))
    assert journal.done() == {0, 2}
    assert journal.items() == 4
    assert len(rows(journal)) == 3


def test_what_was_added_is_there_when_it_is_opened_again(tmp_path):
    path = tmp_path / "journal.sqlite"
    for number in range(2):
        journal = Journal(path)
        journal.add(result(number, {"a": number}))
        journal.close()
    journal = Journal(path)
    assert rows(journal) == [{"a": 0}, {"a": 1}]
    journal.close()


def test_a_second_program_is_refused_in_a_line_until_the_first_is_gone(tmp_path):
    path = tmp_path / "journal.sqlite"
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDS, str(path)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(
            InputError,
            match=r"another program is writing to .*; wait until it has ended, or choose another --out",
        ) as refused:
            Journal(path)
        assert "\n" not in str(refused.value)
        assert str(tmp_path) in str(refused.value)
        holder.kill()
    # Killed, so that it closed nothing: what it was told to be done is there.
    journal = Journal(path)
    assert rows(journal) == [{"a": 0.1}]
    journal.close()


def test_a_full_disk_is_reported_and_leaves_what_was_there(tmp_path):
    path = tmp_path / "journal.sqlite"
    journal = Journal(path)
    # Room for so many pages of 4096 bytes is what a full disk leaves.
    journal._database.execute("PRAGMA max_page_count = 12")
    kept = []

    def fill():
        for number in range(100):
            journal.add(result(number, {"text": "x" * 3000}))
            kept.append(number)

    with pytest.raises(sqlite3.OperationalError) as full:
        fill()
    assert full.value.sqlite_errorcode == sqlite3.SQLITE_FULL
    assert len(kept) > 3
    assert journal.done() == set(kept)
    journal.close()
    # And goes on where it was once there is room.
    journal = Journal(path)
    journal.add(result(len(kept), {"text": ""}))
    assert journal.done() == {*kept, len(kept)}
    journal.close()


def tampered(path, statement, *values):
    """Change a journal as anyone can who has SQLite."""
    database = sqlite3.connect(path)
    database.execute(statement, values)
    database.commit()
    database.close()


@pytest.mark.parametrize(
    ("statement", "values"),
    [
        # One digit of one figure.
        ("UPDATE results SET tables = replace(tables, '149.8', '249.8') WHERE number = 1", ()),
        ("UPDATE results SET number = 7 WHERE number = 1", ()),
        ("UPDATE results SET lost = 1 WHERE number = 1", ()),
        ("UPDATE results SET items = 5 WHERE number = 1", ()),
        ("UPDATE results SET point = '[0.5]' WHERE number = 1", ()),
        ("UPDATE results SET checksum = ''", ()),
        ("UPDATE results SET tables = ?", (b"\xff\xfe",)),
        ("UPDATE results SET tables = NULL", ()),
        ("ALTER TABLE results DROP COLUMN checksum", ()),
        ("DROP TABLE results", ()),
    ],
)
@pytest.mark.parametrize("reading", [False, True])
def test_a_result_that_is_not_as_it_was_added_is_refused_in_a_line(
    tmp_path, statement, values, reading
):
    path = tmp_path / "journal.sqlite"
    journal = Journal(path)
    for number in range(3):
        journal.add(result(number, {"min_distance_m": 149.8}))
    journal.close()
    tampered(path, statement, *values)
    if statement.startswith("DROP") and not reading:
        # Nothing is believed of it: it has no results.
        journal = Journal(path)
        assert journal.is_empty()
        journal.close()
        return
    with pytest.raises(
        InputError, match=r"journal\.sqlite' is (damaged|not a journal of this version)"
    ) as refused:
        Journal(path, reading=reading)
    assert "\n" not in str(refused.value)


def test_reading_writes_nothing_beside_it(journal, tmp_path):
    path = tmp_path / "journal.sqlite"
    journal.add(result(0, {"a": 1}))
    journal.close()
    before = (path.read_bytes(), path.stat().st_mtime_ns)
    tmp_path.chmod(0o500)
    journal = Journal(path, reading=True)
    assert rows(journal) == [{"a": 1}]
    assert [each.name for each in tmp_path.iterdir()] == [
        "journal.sqlite"
    ]  # as it closes, SQLite would remove its own
    journal.close()
    tmp_path.chmod(0o700)
    assert [each.name for each in tmp_path.iterdir()] == ["journal.sqlite"]
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before


def test_texts_that_a_spreadsheet_would_compute_are_marked_and_come_back_as_they_were(journal):
    texts = ["=1+1", "+1", "-1", "@a", "\t=1", "'=1", "''=1", "it's", "'quoted'", "1-1", ""]
    journal.add(result(0, *({"a": text, "b": -1.5} for text in texts)))
    _, text = exported(journal, "a", "b")
    cells = list(csv.reader(io.StringIO(text, newline="")))[1:]
    assert not [a for a, _ in cells if a.startswith(("=", "+", "-", "@", "\t"))]
    # Numbers are numbers, whatever their sign.
    assert {b for _, b in cells} == {"-1.5"}
    assert [from_cell(a) for a, _ in cells] == texts
