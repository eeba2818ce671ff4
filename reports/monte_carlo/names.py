"""What the figures and the inputs of a Monte Carlo study are called, and how they are written."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from measurement.gases import MASS_PERCENT
from reports.document.tables import minus

_UNITS = {
    "_per_hour": "1/h", "_per_m2": "1/m2", "_per_m_s": "1/(m s)", "_per_m": "1/m", "_per_s": "1/s", "_deg_s": "deg/s",
    "_rad_s": "rad/s", "_mps2": "m/s2", "_mps": "m/s", "_deg": "deg", "_rad": "rad", "_percent": MASS_PERCENT, "_ppm": "ppm", "_hz": "Hz",
    "_c": "degC", "_m": "m", "_s": "s",
}  # fmt: skip
"""Units by the suffix of a key that names them, of keys that no parameter documents; the first that
fits.
"""

Units = Mapping[str, str]
"""Units of inputs by their keys."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """How a figure is written.

    Attributes
    ----------
    name, unit : of the figure
    digits : after the point
    scale : from the figure as it is recorded to ``unit``
    missing : what flights without it are
    """

    name: str
    unit: str
    digits: int
    scale: float = 1.0
    missing: str = "without"

    @property
    def label(self) -> str:
        """What an axis says."""
        return f"{self.name} [{self.unit}]"

    def text(self, value: float | None) -> str:
        """Return a value in digits, and a dash if there is none."""
        return "–" if value is None else minus(f"{self.scale * value:.{self.digits}f}")


FIGURES = {
    "clearance_m": Figure(name="Distance kept beyond r_min", unit="m", digits=1),
    "min_distance_m": Figure(name="Closest approach", unit="m", digits=1),
    "crossing_interval_error": Figure(
        name="Mean crossing interval off π/ω₀", unit="%", digits=2, scale=100.0
    ),
    "crossing_distance_min_m": Figure(name="Nearest crossing", unit="m", digits=1),
    "crossing_clearance_m": Figure(name="Nearest crossing, beyond r_min", unit="m", digits=1),
    "tracking_error_rms_m": Figure(name="Tracking error, rms after settling", unit="m", digits=2),
    "settling_time_s": Figure(name="Settling time", unit="s", digits=1, missing="not settled"),
}
"""By the keys of ``statistics.json``, in the order they are shown."""

FROM_THE_CENTRE = ("min_distance_m", "crossing_distance_min_m")
"""Figures that say little of flights with different r_min: those beyond it are shown in their
place.
"""

CLEARANCE = FIGURES["clearance_m"].label
"""Label of an axis of clearances."""


def input_name(key: str) -> str:
    """Return what an input is called, by its dotted key, without its unit."""
    bare = next((key.removesuffix(suffix) for suffix in _UNITS if key.endswith(suffix)), key)
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
    return units.get(key) or next(
        (unit for suffix, unit in _UNITS.items() if key.endswith(suffix)), "-"
    )


def input_label(key: str, units: Units = MappingProxyType({})) -> str:
    """Return what an axis says of an input."""
    return f"{input_name(key)} [{input_unit(key, units)}]"
