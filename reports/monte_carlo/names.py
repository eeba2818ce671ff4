"""What the inputs of a Monte Carlo study are called, and their units."""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from common.columns import DIMENSIONLESS, unit_of, without_unit

Units = Mapping[str, str]
"""Units of inputs by their keys."""


FROM_THE_CENTRE = ("min_distance_m", "crossing_distance_min_m")
"""Figures that say little of flights with different r_min: those beyond it are shown in their
place.
"""


def input_name(key: str) -> str:
    """Return what an input is called, by its dotted key, without its unit."""
    bare = without_unit(key)
    # Entries of a list count from 1, and have a time rather than an "at".
    bare = re.sub(r"s?\.(\d+)\.", lambda entry: f" {int(entry[1]) + 1} ", bare)
    bare = re.sub(r"(?<=[. ])at$", "time", bare)
    return bare.replace(".", " ").replace("_", " ").replace("keepout", "keep-out").capitalize()


def documented_units(manifest: Mapping[str, Any]) -> Units:
    """Return the units that the parameters of a run's trials have, by the manifest."""
    listed = (parameter for of in manifest.get("trial_parameters", {}).values() for parameter in of)
    return {parameter["key"]: parameter["unit"] for parameter in listed if parameter.get("unit")}


def input_unit(key: str, units: Units = MappingProxyType({})) -> str:
    """Return the unit of an input: the documented one, or that which its key names; an entry of a
    list has no other.
    """
    unit = units.get(key) or unit_of(key)
    return "-" if unit == DIMENSIONLESS else unit


def input_label(key: str, units: Units = MappingProxyType({})) -> str:
    """Return what an axis says of an input."""
    return f"{input_name(key)} [{input_unit(key, units)}]"
