"""The configuration of one flight: its trial's, with what this flight alone has."""

import math
from collections.abc import Mapping
from typing import Any, TypeAlias

import pandas as pd

from common.hull import HULL_SHAPES
from measurement.emission import stack_height_of
from reports.run.run_data import RunData

Config = Mapping[str, Any]
"""Nested keys, as a manifest has them."""

_HULL = {
    "hull_length_m": "length_m",
    "hull_beam_m": "beam_m",
    "stack_from_bow_m": "stack_from_bow_m",
    "stack_from_port_m": "stack_from_port_m",
}
"""Columns of the summary that say a ship's size, and the keys of the vessel that they stand for."""

Row: TypeAlias = "pd.Series[Any] | Mapping[Any, Any]"
"""A row of a table."""


def flight_config(run: RunData, row: Row, trial: Config | None = None) -> Config:
    """Return the configuration of a flight: its trial's, with the keys that the run has for it.

    Parameters
    ----------
    run : as read from disk
    row : of the flight, in the summary or among the comparisons
    trial : the configuration of its trial, if it is not that of the manifest; one that is in
        neither has no key
    """
    config = run.manifest.get("trials", {}).get(row.get("trial"), {}) if trial is None else trial
    for key, value in run.overrides.get(str(row["flight_id"]), {}).items():
        config = with_value(config, key.split("."), value)
    # The size of a ship, and the place of its funnel, may be a file's.
    for column, key in _HULL.items():
        if isinstance(known := row.get(column), int | float) and math.isfinite(known):
            config = with_value(config, ["vessel", key], known)
    return config


def flight_configs(run: RunData, rows: pd.DataFrame) -> list[Config]:
    """Return the same of each row."""
    return [flight_config(run, row) for row in rows[["flight_id", "trial"]].to_dict("records")]


def source_height(config: Config) -> float:
    """Return the height of the funnel's mouth, the centre of a keep-out sphere, above the sea
    [m].
    """
    return stack_height_of(
        config["plume"]["source_height_m"], config.get("emission", {}).get("ship")
    )


def keepout_shape(config: Config) -> str:
    """Return the shape of the keep-out area: "sphere" or "cylinder", or, about the hull, one of
    ``HULL_SHAPES``.
    """
    keepout = config.get("keepout", {})
    shape = str(keepout.get("shape", "sphere"))
    return HULL_SHAPES[shape] if keepout.get("from") == "hull" else shape


def is_level(shape: str) -> bool:
    """Return whether distances from a keep-out area of a shape are horizontal."""
    return shape in ("cylinder", HULL_SHAPES["cylinder"])


def wind_changes(config: Config) -> bool:
    """Return whether the wind is from a table, so that what the summary says of it is of the start
    alone.
    """
    return bool((config.get("wind") or {}).get("table"))


def with_value(tree: Config, keys: list[str], value: object) -> Config:
    """Return a tree with another value."""
    key, *below = keys
    return {**tree, key: with_value(tree.get(key) or {}, below, value) if below else value}
