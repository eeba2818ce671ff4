"""Columns that instruments fill in the time history: each is one instrument's alone."""

import pytest
from flight_cases import fly

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
    ("names", "column", "other"),
    [(("Own", "Same"), "so2_ppb", "instrument"), (("Time",), "time_s", "the flight itself"), (("Look",), "delta_m", "the flight")],
)
def test_an_instrument_that_fills_a_column_that_is_filled_already_is_a_row_with_its_name(names, column, other, tmp_path):
    (tmp_path / "own.py").write_text(INSTRUMENTS, encoding="utf-8")
    parts = [f"{tmp_path / 'own.py'}:{name}" for name in names]
    row = fly(payload={"instruments": parts}, flight={"duration_max_s": 5.0, "crossings": 0}).row
    assert row["outcome"] == "failed"
    assert row["message"].startswith(f"payload: instrument '{parts[-1]}' fills the column '{column}', which {other}")
    assert "\n" not in row["message"]


def test_instruments_with_columns_of_their_own_fly_together(tmp_path):
    (tmp_path / "own.py").write_text(INSTRUMENTS, encoding="utf-8")
    result = fly(payload={"instruments": [f"{tmp_path / 'own.py'}:Own"]}, flight={"duration_max_s": 5.0, "crossings": 0})
    assert result.history["so2_ppb"].tolist() == [1.0] * len(result.history)
