import pytest

from scenarios.ledger import Ledger, Table
from scenarios.pool import DIED
from scenarios.run_directory import RunDirectory

COLUMNS = ("flight_id", "message", "nu")
CROSSINGS = ("flight_id", "crossing", "time_s")
FLIGHTS = ["a", "b", "c"]
TABLE = Table(name="summary.csv", columns=COLUMNS, flights=frozenset(FLIGHTS))


@pytest.fixture
def run(tmp_path):
    directory = RunDirectory(tmp_path / "run")
    directory.open_new()
    return directory


def ledger_of(run, flights=FLIGHTS):
    return Ledger(run, flights, tables=[TABLE], details={"crossings.csv": CROSSINGS})


def crossing(flight, number):
    return {"flight_id": flight, "crossing": number, "time_s": 10.0 * number}


def test_what_is_done_is_on_disk_and_taken_over_in_the_order_of_the_flights(run):
    ledger = ledger_of(run)
    ledger.add("c", {"flight_id": "c", "nu": 0.3}, {"crossings.csv": [crossing("c", 1), crossing("c", 2)]})
    ledger.add("a", {"flight_id": "a", "nu": 0.1}, {"crossings.csv": [crossing("a", 1)]})
    ledger.flush()
    again = ledger_of(run)
    assert again.done == {"a", "c"}
    assert again.rows(TABLE) == [{"flight_id": "a", "nu": 0.1}, {"flight_id": "c", "nu": 0.3}]
    again.add("b", {"flight_id": "b", "nu": 0.2}, {"crossings.csv": [crossing("b", 1)]})
    again.flush()
    assert [row["flight_id"] for row in run.read_rows("summary.csv")] == FLIGHTS
    assert [(row["flight_id"], row["crossing"]) for row in run.read_rows("crossings.csv")] == [
        ("a", 1),
        ("b", 1),
        ("c", 1),
        ("c", 2),
    ]


def test_rows_wait_to_be_written_and_flush_writes_them(run):
    ledger = ledger_of(run)
    # The first is written at once, the second within two seconds: the tables are written whole each time.
    ledger.add("a", {"flight_id": "a"}, {"crossings.csv": []})
    ledger.add("b", {"flight_id": "b"}, {"crossings.csv": []})
    assert [row["flight_id"] for row in run.read_rows("summary.csv")] == ["a"]
    ledger.flush()
    assert [row["flight_id"] for row in run.read_rows("summary.csv")] == ["a", "b"]


def test_crossings_of_a_flight_whose_row_was_not_written_any_more_are_dropped(run):
    # A run that was killed between its two tables: the flight is flown again, and its crossings must not be there twice.
    run.write_rows("crossings.csv", [crossing("a", 1), crossing("b", 1)], CROSSINGS)
    run.write_rows("summary.csv", [{"flight_id": "a"}], COLUMNS)
    ledger = ledger_of(run)
    assert ledger.done == {"a"}
    ledger.add("b", {"flight_id": "b"}, {"crossings.csv": [crossing("b", 1)]})
    ledger.flush()
    assert len(run.read_rows("crossings.csv")) == 2


def test_a_flight_whose_process_died_is_not_done(run):
    # Its message says to run again with --resume.
    run.write_rows("summary.csv", [{"flight_id": "a", "message": DIED}, {"flight_id": "b", "message": "outrun"}], COLUMNS)
    assert ledger_of(run).done == {"b"}


def test_flights_that_are_not_planned_are_not_taken_over(run):
    run.write_rows("summary.csv", [{"flight_id": "a"}, {"flight_id": "z"}], COLUMNS)
    assert ledger_of(run).done == {"a"}
