"""Reading what a run or a flight left: its manifest, rows of its tables, and time histories."""

import io
import json

import pandas as pd

from common.run_layout import HISTORY_SUFFIX


def manifest_of(run):
    """Return a run's manifest."""
    return json.loads((run / "manifest.json").read_text(encoding="utf-8"))


def write_manifest(run, manifest):
    """Write a manifest in the place of a run's own."""
    (run / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")


def change_manifest(run, **entries):
    """Have a run's manifest say something else."""
    write_manifest(run, manifest_of(run) | entries)


def rows_of(directory, table="summary.csv"):
    """Return the rows of a run's table; a figure that a row lacks is no key of it."""
    frame = pd.read_csv(directory / table, keep_default_na=False, na_values=[""])
    return [
        {key: value for key, value in row.items() if not pd.isna(value)}
        for row in frame.to_dict("records")
    ]


def history_in(result):
    """Return the time history among the files of a flight's result, or none."""
    files = result.files.items()
    histories = [
        pd.read_parquet(io.BytesIO(content))
        for name, content in files
        if name.endswith(HISTORY_SUFFIX)
    ]
    assert len(histories) <= 1
    return histories[0] if histories else None
