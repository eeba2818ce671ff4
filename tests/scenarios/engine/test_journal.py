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
def path(tmp_path):
    return tmp_path / "journal.sqlite"


@pytest.fixture
def journal(path):
    opened = Journal(path)
    yield opened
    opened.close()


def result(number, *rows, lost=False, items=1, **tables):
    return Result(
        task=Task(number=number), tables={"rows.csv": list(rows)} | tables, lost=lost, items=items
    )


def rows(journal, table="rows.csv", **places):
    return list(journal.rows(table, **places))


def exported(journal, *columns):
    """Return the cells of an exported table."""
    file = io.StringIO(newline="")
    count = journal.export("rows.csv", columns, file)
    assert "\r" not in file.getvalue()
    found = list(csv.reader(io.StringIO(file.getvalue(), newline="")))
    assert (found[0], len(found) - 1) == (list(columns), count)
    return found[1:]


def test_rows_come_back_exactly(journal):
    # A sum that is no short decimal, the smallest and the largest numbers, and other types.
    row = {"sum": 0.1 + 0.2, "small": 5e-324, "large": 1.7976931348623157e308, "whole": 2**60}
    row |= {"word": 'ψ, "β"\n', "yes": True, "nothing": None, "endless": -math.inf}
    journal.add(result(0, row, {"a": math.nan}))
    found, unknown = rows(journal)
    assert found == row
    assert type(found["yes"]) is bool
    assert math.isnan(unknown["a"])


def test_rows_are_in_the_order_of_their_tasks_for_any_order_in_which_they_came(journal):
    for number in (7, 0, 10, 2):
        more = {"crossings.csv": [{"b": number}]} if number == 7 else {}
        journal.add(result(number, {"n": number, "i": 0}, {"n": number, "i": 1}, **more))
    assert [(row["n"], row["i"]) for row in rows(journal)] == [
        (n, i) for n in (0, 2, 7, 10) for i in (0, 1)
    ]
    some = journal.numbered("rows.csv", first=2, below=10)
    assert [(number, row["n"]) for number, row in some] == [(2, 2), (2, 2), (7, 7), (7, 7)]
    assert [row["n"] for row in rows(journal, below=1)] == [0, 0]
    assert rows(journal, first=11) == []
    assert rows(journal, "crossings.csv") == [{"b": 7}]
    assert rows(journal, "nothing.csv") == []


def test_an_exported_table_has_exactly_its_columns_and_what_is_missing_is_empty(journal):
    journal.add(result(1, {"b": math.nan, "a": 2.5, "beyond": 3}))
    journal.add(result(0, {"a": 0.1 + 0.2, "b": True}))
    journal.add(result(2, {"b": 'one, "two"\nthree'}, {"a": None}))
    assert exported(journal, "a", "b", "c") == [
        # As many digits as give the same number back.
        ["0.30000000000000004", "True", ""],
        ["2.5", "", ""],
        ["", 'one, "two"\nthree', ""],
        ["", "", ""],
    ]


def test_texts_that_a_spreadsheet_would_compute_are_marked_and_come_back_as_they_were(journal):
    texts = ["=1+1", "+1", "-1", "@a", "\t=1", "'=1", "''=1", "it's", "'quoted'", "1-1", ""]
    journal.add(result(0, *({"a": text, "b": -1.5} for text in texts)))
    cells = exported(journal, "a", "b")
    assert not [a for a, _ in cells if a.startswith(("=", "+", "-", "@", "\t"))]
    assert {b for _, b in cells} == {"-1.5"}
    assert [from_cell(a) for a, _ in cells] == texts


def test_a_task_whose_process_was_lost_has_rows_and_is_not_done_until_it_is_replaced(journal):
    assert (journal.done(), journal.items(), journal.is_empty()) == (set(), 0, True)
    journal.add(result(0, {"a": 1}, items=4))
    journal.add(result(1, {"a": 2}, items=0, lost=True))
    journal.add(result(2, {"a": 3}, items=0))
    journal.add(result(3, {"a": 4}, items=5, lost=True))
    assert (journal.done(), journal.items(), journal.without_items()) == ({0, 2}, 4, 1)
    assert [row["a"] for row in rows(journal)] == [1, 2, 3, 4]
    journal.add(result(3, {"a": 5}, items=5))
    assert (journal.done(), journal.items()) == ({0, 2, 3}, 9)
    assert [row["a"] for row in rows(journal)] == [1, 2, 3, 5]


def test_a_task_has_its_point_when_the_journal_is_opened_again(path):
    journal = Journal(path)
    task = Task(number=1, point=(0.1, 0.5))
    journal.add(Result(task=task, tables={}))
    journal.close()
    journal = Journal(path)
    journal.add(result(0, {"a": 0}))
    assert (journal.task(1), rows(journal)) == (task, [{"a": 0}])
    journal.close()


def test_a_second_program_is_refused_in_a_line_until_the_first_is_gone(path):
    command = [sys.executable, "-c", HOLDS, str(path)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, cwd=ROOT, text=True, **pipes) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(InputError, match="another program is writing to") as refused:
            Journal(path)
        assert "\n" not in str(refused.value)
        holder.kill()
    # The program was killed and closed nothing: what it added is there.
    journal = Journal(path)
    assert rows(journal) == [{"a": 0.1}]
    journal.close()


def test_a_full_disk_is_reported_and_leaves_what_was_there(path):
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
    journal = Journal(path)
    journal.add(result(len(kept), {"text": ""}))
    assert journal.done() == {*kept, len(kept)}
    journal.close()


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
    ],
)
def test_a_result_that_is_not_as_it_was_added_is_refused_in_a_line(path, statement, values):
    journal = Journal(path)
    for number in range(3):
        journal.add(result(number, {"min_distance_m": 149.8}))
    journal.close()
    database = sqlite3.connect(path)
    database.execute(statement, values)
    database.commit()
    database.close()
    for reading in (False, True):
        with pytest.raises(InputError, match=r"is (damaged|not a journal of)") as refused:
            Journal(path, reading=reading)
        assert "\n" not in str(refused.value)


def test_reading_writes_nothing_beside_it(journal, path, tmp_path):
    journal.add(result(0, {"a": 1}))
    journal.close()
    before = (path.read_bytes(), path.stat().st_mtime_ns)
    tmp_path.chmod(0o500)
    journal = Journal(path, reading=True)
    assert rows(journal) == [{"a": 1}]
    # Here, because SQLite removes its files when it closes.
    assert [each.name for each in tmp_path.iterdir()] == ["journal.sqlite"]
    journal.close()
    tmp_path.chmod(0o700)
    assert [each.name for each in tmp_path.iterdir()] == ["journal.sqlite"]
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before
