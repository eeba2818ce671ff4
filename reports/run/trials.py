"""The trials of a run over the real sea, and what each of them is about."""

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from reports.document.chart import Array
from reports.run.run_data import RunData

Mask = npt.NDArray[np.bool_]
Parameters = dict[str, Any]


class Kind(Enum):
    """What a trial is about: that decides what its section shows."""

    FAULTS = "faults"
    TOGETHER = "turbulence with reports, sensors or manoeuvres"
    MANOEUVRES = "manoeuvres"
    TURBULENCE = "turbulence"
    CROSSINGS = "crossings"
    APPROACH = "approach"
    OTHER = "other"


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One trial of a run.

    Attributes
    ----------
    run : as read from disk
    key : what its flights are called by
    name : for anchors and figures, unique in the report; letters and figures
    config : its whole configuration
    rows : a row per flight that is done
    """

    run: RunData
    key: str
    name: str
    config: dict[str, Any]
    rows: pd.DataFrame

    @property
    def title(self) -> str:
        """What the report calls it."""
        return str(self.config["title"])

    @property
    def planned(self) -> int:
        """Number of flights once the run is complete."""
        return int(self.config["flights"])

    @property
    def criteria(self) -> dict[str, Any]:
        """What a flight must show to count as met."""
        return dict(self.config["criteria"])

    @property
    def flown(self) -> pd.DataFrame:
        """Flights of which anything was measured."""
        return self.rows[self.rows["min_distance_m"].notna()]

    @property
    def radius(self) -> float:
        """Largest r_min of its flights [m]."""
        radii = self.rows["keepout_radius_m"].dropna()
        return float(radii.max()) if len(radii) else float(self.config["keepout"]["radius_m"])

    @property
    def source_height(self) -> float:
        """Height of the funnel, from where distances count [m]."""
        return float(self.config["plume"]["source_height_m"])

    def parameters(self) -> list[Parameters]:
        """Return every parameter with value, unit, meaning and, if the run knows it, default."""
        return list(self.run.manifest["trial_parameters"][self.key])

    def draws(self, key: str) -> bool:
        """Return whether flights differ in ``key``, or in anything below it."""
        return any(draw["key"] == key or draw["key"].startswith(f"{key}.") for draw in self.config["draws"])

    @property
    def kind(self) -> Kind:
        """What it is about, by what it holds and what it asks for; its name says nothing."""
        config = self.config
        turbulent = config["turbulence"]["level"] != "none" or config["turbulence"]["gusts"] > 0 or self.draws("turbulence")
        moving = bool(config["vessel"]["manoeuvres"]) or self.draws("vessel.manoeuvres")
        kinds = {
            Kind.FAULTS: config["fault"]["kind"] != "none" or self.draws("fault.kind"),
            Kind.TOGETHER: turbulent and (moving or self.errs),
            Kind.MANOEUVRES: moving,
            Kind.TURBULENCE: turbulent,
            Kind.CROSSINGS: config["criteria"].get("crossing_interval_error") is not None,
            Kind.APPROACH: config["criteria"].get("settles", False),
        }
        return next((kind for kind, holds in kinds.items() if holds), Kind.OTHER)

    @property
    def reported(self) -> bool:
        """Whether the vessel is known by its reports alone, not exactly."""
        return bool(self.config["reports"]["interval_s"][1] > 0.0) or self.draws("reports")

    @property
    def errs(self) -> bool:
        """Whether reports or sensors are less than perfect."""
        return self.reported or any(self.config["sensors"].values()) or self.draws("sensors")

    def dealt(self, key: str) -> list[Any]:
        """Return the value of a configured key for each row: as drawn, where it is dealt in turn by the flight's number."""
        choices = next((draw["choice"] for draw in self.config["draws"] if draw["key"] == key and draw["choice"]), None)
        if choices is None:
            value: Any = self.config
            for part in key.split("."):
                value = value[part]
            choices = [value]
        return [choices[int(flight_id.rsplit("_", 1)[1]) % len(choices)] for flight_id in self.rows["flight_id"]]


def read_trials(run: RunData) -> list[Trial]:
    """Return the trials of a run, in its order.

    Raises
    ------
    KeyError : the manifest names no trials
    """
    return [
        Trial(run=run, key=key, name=f"trial{i}", config=config, rows=run.summary[run.summary["trial"] == key])
        for i, (key, config) in enumerate(run.manifest["trials"].items(), start=1)
    ]


def column(rows: pd.DataFrame, name: str) -> Array:
    """Return a column as figures; nothing but "not a number" where the run has no such column."""
    return rows[name].to_numpy(dtype=np.float64) if name in rows else np.full(len(rows), np.nan)


def total(rows: pd.DataFrame, name: str) -> int:
    """Return the sum of a column of counts."""
    return int(np.nansum(column(rows, name)))


def clearance(rows: pd.DataFrame) -> Array:
    """Return how far from the keep-out area each flight stayed at its closest, negative if it entered [m]."""
    return column(rows, "min_distance_m") - column(rows, "keepout_radius_m")


def entered(rows: pd.DataFrame) -> Mask:
    """Return which flights entered the keep-out area, as truth values."""
    inside: Mask = column(rows, "keepout_violations") > 0.0
    return inside


def interval_error(rows: pd.DataFrame) -> Array:
    """Return the mean crossing interval's relative difference from pi/omega_0 [-]."""
    ratio: Array = column(rows, "crossing_interval_mean_s") / column(rows, "crossing_interval_predicted_s") - 1.0
    return ratio
