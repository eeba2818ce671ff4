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
import numpy as np
from scenarios.instruments.instrument import Evaluation

class Own:
    COLUMNS = ("so2_ppb",)
    def __init__(self, *_): pass
    def read(self, *_): return (1.0,)
class Same(Own): pass
class Time(Own):
    COLUMNS = ("time_s",)

class Bare:
    COLUMNS = ("y_ppb",)
    def __init__(self, *_): pass
    def evaluate(self, column, since): return Evaluation(columns=np.ones((len(column("time_s")), 1)))
class Peak(Bare):
    FIGURES = ("y_peak_ppb",)
class Also(Bare):
    COLUMNS = ("z_ppb",)
    FIGURES = ("y_peak_ppb",)
class Safe(Bare):
    FIGURES = ("keepout_violations", "min_distance_m")
class Folder(Bare):
    TABLES = {"../y.csv": ("y_ppb",)}
class Numbered(Bare):
    FIGURES = {"y_peak_ppb": 3}
class Late(Bare):
    def evaluate(self, column, since): raise ValueError("late")
"""


@pytest.fixture
def parts(tmp_path):
    (tmp_path / "own.py").write_text(INSTRUMENTS, encoding="utf-8")
    return lambda *names: [f"{tmp_path / 'own.py'}:{name}" for name in names]


def flown(parts):
    return fly(payload={"instruments": parts}, flight={"duration_max_s": 5.0, "crossings": 0}).row


@pytest.mark.parametrize(("names", "column"), [(("Own", "Same"), "so2_ppb"), (("Time",), "time_s")])
def test_an_instrument_that_fills_a_column_that_is_filled_already_is_a_row_with_its_name(
    names, column, parts
):
    row = flown(parts(*names))
    assert row["outcome"] == "failed"
    filled = f"payload '{parts(names[-1])[0]}' fills the column '{column}', which the flight or"
    assert row["message"].startswith(filled)


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("Safe",), "Safe' fills the figure 'keepout_violations', which the flight or another"),
        (("Peak", "Also"), "Also' fills the figure 'y_peak_ppb', which the flight or another"),
        (("Folder",), "names of files that end in .csv, without a folder; not '../y.csv'"),
        (("Numbered",), "column 'y_peak_ppb' is declared by 3; give a common.columns.Column"),
    ],
)
def test_figures_and_tables_of_the_flight_and_of_others_are_refused_before_any_flight(
    names, words, parts
):
    instruments = ",".join(f'"{part}"' for part in parts(*names))
    with pytest.raises(InputError) as refused:
        check_without_design(load_study("sweep_nu", [f"payload=[{instruments}]"]))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(("outcome", "kept_out"), [("diverged", False), ("aircraft_lost", True)])
def test_an_aircraft_that_is_gone_is_gone_whatever_fails_after_it(
    outcome, kept_out, parts, monkeypatch
):
    figures_of = flight_runner.flight_figures

    def gone(plan, record):
        figures, found = figures_of(plan, record)
        return figures | {"outcome": outcome}, found

    monkeypatch.setattr(flight_runner, "flight_figures", gone)
    row = flown(parts("Late"))
    assert (row["outcome"], row["kept_out"], row["criteria_met"]) == (outcome, kept_out, False)
    assert "failed: ValueError: late (own.py:" in row["message"]
