"""The configuration of one flight: its trial's, with what this flight alone has; the ship's hull in
it, and what its faults are called.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import pandas as pd

from common.faults import fault_kinds, faults_in
from common.hull import HULL_SHAPES, STACK_FROM_BOW, ShipHull
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


def fault_name(kind: object) -> str:
    """Return what a fault is called."""
    return str(kind).replace("_", " ")


def faults_name(row: Row) -> str:
    """Return what the faults of a flight are called, given its row."""
    return fault_name(fault_kinds(dict(row)))


def names_of_faults(rows: pd.DataFrame) -> list[str]:
    """Return what the faults of each flight are called."""
    return [faults_name(row) for row in rows.to_dict("records")]


def fault_marks(row: Row) -> dict[str, float]:
    """Return the time of each fault of a flight [s], by what a mark at it is called."""
    faults = faults_in(dict(row))
    if len(faults) == 1:
        return {"fault": faults[0][1]}
    return {f"fault {i}, {fault_name(kind)}": at for i, (kind, at) in enumerate(faults, start=1)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Hull:
    """A hull as it is drawn.

    Attributes
    ----------
    title : what it is taken to be, in words
    length, beam : [m]
    funnel : from the stern, over the length [-]
    known : whether it is of its class; of a ship without one it stands for a size that is not known
    given : whether the scenario or its reports give it
    aside : how far to starboard of the funnel the middle of the hull is [m]
    """

    title: str
    length: float
    beam: float
    funnel: float = 0.2
    known: bool = True
    given: bool = False
    aside: float = 0.0


HULLS = {
    "container": Hull(title="a container feeder", length=160.0, beam=25.0),
    "coaster": Hull(title="a coaster", length=90.0, beam=14.0),
    "tanker": Hull(title="a tanker", length=180.0, beam=30.0),
    "cruise": Hull(title="a cruise ship", length=290.0, beam=36.0, funnel=0.35),
}
"""By the names of ``measurement/ships.toml``: usual sizes of such ships, assumptions."""

ANY = Hull(title="a merchant ship", length=150.0, beam=23.0, known=False)
"""Hull of a ship whose class is not known, such as one that a user defines."""


def hull_of(config: Mapping[str, Any]) -> Hull:
    """Return the hull of a flight's ship: as its configuration gives it, else that of its class."""
    own = outline_of(config)
    if own is None:
        return HULLS.get(str(config.get("emission", {}).get("ship")), ANY)
    return Hull(
        title="the ship",
        length=own.length,
        beam=own.beam,
        funnel=1.0 - own.stack[0] / own.length,
        given=True,
        aside=0.5 * own.beam - own.stack[1],
    )


def outline_of(config: Mapping[str, Any]) -> ShipHull | None:
    """Return the outline of a flight's ship, where its size is known."""
    vessel = config.get("vessel") or {}
    length, beam = vessel.get("length_m"), vessel.get("beam_m")
    if length is None or beam is None:
        return None
    along, across = vessel.get("stack_from_bow_m"), vessel.get("stack_from_port_m")
    stack = (
        STACK_FROM_BOW * length if along is None else along,
        0.5 * beam if across is None else across,
    )
    return ShipHull(length=length, beam=beam, stack=stack, antenna=stack)
