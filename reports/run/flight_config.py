"""The configuration of one flight: its trial's, with what this flight alone has."""

import json
import re
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from common.text import at_or_below
from measurement.emission import stack_height_of
from reports.run.run_data import RunData

Config = Mapping[str, Any]
"""Nested keys, as a manifest has them."""

Row: TypeAlias = "pd.Series[Any] | Mapping[Any, Any]"
"""A row of a table."""

_NUMBERED = re.compile(r"_\d{5,}$")
"""End of the name of a flight that is one of several at its point."""


def flight_config(run: RunData, row: Row, trial: Config | None = None) -> Config:
    """Return the configuration of a flight, with keys of its case, its comparison, the sweep and
    random variables.

    Parameters
    ----------
    run : as read from disk
    row : of the flight, in the summary or among the comparisons
    trial : the configuration of its trial, if it is not that of the manifest; one that is in
        neither has no key
    """
    own = run.draws[run.draws["flight_id"] == row["flight_id"]]
    return _own_config(run, row, _by_flight(own), trial)


def flight_configs(run: RunData, rows: pd.DataFrame) -> list[Config]:
    """Return the same of each row."""
    drawn = _by_flight(run.draws)
    return [_own_config(run, row, drawn) for row in rows.to_dict("records")]


def source_height(config: Config) -> float:
    """Return the height of the funnel's mouth, the centre of a keep-out sphere, above the sea [m]."""
    return stack_height_of(
        config["plume"]["source_height_m"], config.get("emission", {}).get("ship")
    )


def keepout_shape(config: Config) -> str:
    """Return the shape of the keep-out area: "sphere" or "cylinder"."""
    return str(config.get("keepout", {}).get("shape", "sphere"))


def wind_changes(config: Config) -> bool:
    """Return whether the wind is from a table, so that what the summary says of it is of the start
    alone.
    """
    return bool((config.get("wind") or {}).get("table"))


def _by_flight(draws: pd.DataFrame) -> dict[str, Row]:
    return {str(row["flight_id"]): row for row in draws.to_dict("records")}


def _own_config(
    run: RunData, row: Row, drawn: Mapping[str, Row], trial: Config | None = None
) -> Config:
    config = run.manifest.get("trials", {}).get(row.get("trial"), {}) if trial is None else trial
    # Beside keys the table has names.
    cells = {
        str(key): value
        for key, value in drawn.get(str(row["flight_id"]), {}).items()
        if "." in str(key) or key in config
    }
    inputs = {key: _input(value) for key, value in cells.items() if _known(value)}
    sampled = {str(draw["key"]) for draw in config.get("draws") or []}
    of_case, of_comparison = _of_case(config, row), _of_comparison(config, row)
    # A comparison changes what was swept; what is random is sampled in its flights, too, but for
    # keys that it or a case sets.
    values = (
        of_case
        | {key: value for key, value in inputs.items() if key not in sampled}
        | of_comparison
    )
    values |= {
        key: value
        for key, value in inputs.items()
        if key in sampled and not any(at_or_below(key, of) for of in (*of_case, *of_comparison))
    }
    if isinstance(shape := row.get("keepout_shape"), str):
        values["keepout.shape"] = shape
    for key, value in values.items():
        config = _with_value(config, key.split("."), value)
    return config


def _of_comparison(config: Config, row: Row) -> dict[str, Any]:
    """Return what a comparison sets in a flight; nothing of a flight of the study."""
    variants = (config.get("comparison") or {}).get("variants") or []
    return next((dict(of["set"]) for of in variants if of["name"] == row.get("variant")), {})


def _of_case(config: Config, row: Row) -> dict[str, Any]:
    """Return what the case of a flight sets; nothing of a flight that is of none."""
    named = (
        _NUMBERED.sub("", str(row["flight_id"]))
        .removeprefix(f"{row.get('trial')}_")
        .removesuffix(f"_{row.get('variant')}")
    )
    for case in config.get("cases") or []:
        if named in (case["name"], f"{case['name']}_{row.get('fidelity')}"):
            return {
                **case["set"],
                **(case.get("set_kinematic") or {} if row.get("fidelity") == "kinematic" else {}),
            }
    return {}


def _known(value: object) -> bool:
    return not (isinstance(value, float) and np.isnan(value))


def _input(value: object) -> object:
    """Return a value as it was given: a table has what is neither a number nor a word as JSON, as
    lists are.
    """
    try:
        return json.loads(value) if isinstance(value, str) else value
    except ValueError:
        return value


def _with_value(tree: Config, keys: list[str], value: object) -> Config:
    """Return a tree with another value; places in lists, which nothing here asks for, stay as they
    are.
    """
    key, *below = keys
    if not below:
        return {**tree, key: value}
    part = tree.get(key) or {}
    return {**tree, key: _with_value(part, below, value)} if isinstance(part, Mapping) else tree
