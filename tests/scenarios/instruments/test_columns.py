"""Columns, figures and tables that instruments fill: each is one instrument's alone, and none is
the flight's own.
"""

import pytest
from flight_cases import fly

from scenarios import flight_runner
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.checks import check_without_design

INSTRUMENTS = """
class Own:
    COLUMNS = ("so2_ppb",)
    def __init__(self, *_): pass
    def read(self, *_): return (1.0,)

class Same(Own):
    pass

class Time(Own):
    COLUMNS = ("time_s",)

class Look(Own):
    COLUMNS = ("delta_m",)
"""


@pytest.mark.parametrize(
    ("names", "column"),
    [(("Own", "Same"), "so2_ppb"), (("Time",), "time_s"), (("Look",), "delta_m")],
)
def test_an_instrument_that_fills_a_column_that_is_filled_already_is_a_row_with_its_name(
    names, column, tmp_path
):
    (tmp_path / "own.py").write_text(INSTRUMENTS, encoding="utf-8")
    parts = [f"{tmp_path / 'own.py'}:{name}" for name in names]
    row = fly(payload={"instruments": parts}, flight={"duration_max_s": 5.0, "crossings": 0}).row
    assert row["outcome"] == "failed"
    assert row["message"].startswith(
        f"payload '{parts[-1]}' fills the column '{column}', which the flight or another"
    )
    assert "\n" not in row["message"]


EVALUATED = """
import numpy as np
from common.columns import Column
from scenarios.instruments.instrument import Evaluation

class Bare:
    COLUMNS = ("y_ppb",)
    def __init__(self, *_): pass
    def evaluate(self, column, since): return Evaluation(columns=np.ones((len(column("time_s")), 1)))

class Peak(Bare):
    FIGURES = ("y_peak_ppb", "y_low_ppb")
    TABLES = {"y.csv": ("y_ppb",)}
    def evaluate(self, column, since):
        tables = {"y.csv": [{"y_ppb": 1.0, "flight_id": "another"}]}
        return Evaluation(columns=super().evaluate(column, since).columns, figures={"y_peak_ppb": 3.0}, tables=tables)

class Late(Bare):
    def evaluate(self, column, since): raise ValueError("late")

class Safe(Bare):
    FIGURES = ("keepout_violations", "min_distance_m")
class Folder(Bare):
    TABLES = {"../y.csv": ("y_ppb",)}
class Also(Bare):
    COLUMNS = ("z_ppb",)
    FIGURES = ("y_peak_ppb",)
class Numbered(Bare):
    FIGURES = {"y_peak_ppb": 3}
"""


def evaluated(folder, *names):
    """Fly with instruments of one's own."""
    (folder / "own.py").write_text(EVALUATED, encoding="utf-8")
    parts = [f"{folder / 'own.py'}:{name}" for name in names]
    return fly(payload={"instruments": parts}, flight={"duration_max_s": 5.0, "crossings": 0})


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("Safe",), "Safe' fills the figure 'keepout_violations', which the flight or another"),
        (("Peak", "Also"), "Also' fills the figure 'y_peak_ppb', which the flight or another"),
        (("Folder",), "names of files that end in .csv, without a folder; not '../y.csv'"),
        (
            ("Numbered",),
            "column 'y_peak_ppb' is declared by 3; give a common.columns.Column, or text",
        ),
    ],
)
def test_figures_and_tables_of_the_flight_and_of_others_are_refused_before_any_flight(
    names, words, tmp_path
):
    (tmp_path / "own.py").write_text(EVALUATED, encoding="utf-8")
    parts = ",".join(f'"{tmp_path / "own.py"}:{name}"' for name in names)
    with pytest.raises(InputError) as refused:
        check_without_design(load_study("sweep_nu", [f"payload=[{parts}]"]))
    assert str(refused.value).startswith("payload '")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(("outcome", "kept_out"), [("diverged", False), ("aircraft_lost", True)])
def test_an_aircraft_that_is_gone_is_gone_whatever_fails_after_it(
    outcome, kept_out, tmp_path, monkeypatch
):
    figures_of = flight_runner.flight_figures

    def gone(plan, record):
        figures, found = figures_of(plan, record)
        return figures | {"outcome": outcome}, found

    monkeypatch.setattr(flight_runner, "flight_figures", gone)
    row = evaluated(tmp_path, "Late").row
    assert (row["outcome"], row["kept_out"], row["criteria_met"]) == (outcome, kept_out, False)
    assert "failed: ValueError: late (own.py:19)" in row["message"]
