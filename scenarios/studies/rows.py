"""Rows of the journal as a table."""

from collections.abc import Iterable, Sequence

import pandas as pd

from scenarios.engine.task import Row


def frame(rows: Iterable[Row], columns: Sequence[str]) -> pd.DataFrame:
    """Return some columns of rows; what a row does not have is None."""
    return pd.DataFrame(
        [[row.get(name) for name in columns] for row in rows], columns=list(columns)
    )
