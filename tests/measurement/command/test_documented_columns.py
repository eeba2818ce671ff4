"""What the how-to page says of a log's columns is what the code reads."""

import re
from pathlib import Path

from measurement.estimate.flight_log.config import COLUMNS
from measurement.gases import GASES, UNITS

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "measuring.md"


def test_every_name_that_columns_may_have_is_documented_with_its_unit_and_its_usual_column():
    table = (
        PAGE.read_text(encoding="utf-8")
        .partition("| column of the log unless named |")[2]
        .partition("\n\n")[0]
    )
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \| `(\w+)` \|$", table, re.MULTILINE)
    assert {name: column for name, _, column in rows} == COLUMNS
    units = {name: unit.partition(",")[0] for name, unit, _ in rows}
    # As in the names of the usual columns.
    assert {gas: units[gas] for gas in GASES} == {gas: UNITS[gas] for gas in GASES}
    for name, suffix, unit in (
        ("time", "_s", "seconds"),
        ("latitude", "_deg", "degrees"),
        ("height", "_m", "m"),
    ):
        assert COLUMNS[name].endswith(suffix)
        assert units[name] == unit
