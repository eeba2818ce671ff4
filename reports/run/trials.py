"""The trials of a run, and what each of them is about."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import pandas as pd

from common.faults import NO_FAULT
from common.hull import HULL_SHAPES
from common.run_layout import DRAWS
from common.text import at_or_below
from common.verdict import Counts, TrialVerdict
from reports.errors import ReportError
from reports.run.columns import Array, column, flights_flown
from reports.run.flight_config import Config, flight_config, keepout_shape
from reports.run.run_data import REMEDY, RunData, refuse_other_version

Parameters = dict[str, Any]


class Kind(Enum):
    """What a trial is about: that decides what its section shows."""

    SWEEP = "sweep"
    FAULTS = "faults"
    MANOEUVRES = "manoeuvres"
    GENERAL = "general"


SHAPES = {
    "sphere": "from the keep-out sphere's centre",
    "cylinder": "horizontal, from the keep-out cylinder's axis",
    HULL_SHAPES["sphere"]: "from the outline of the hull",
    HULL_SHAPES["cylinder"]: "horizontal, from the outline of the hull",
}
"""Shapes of keep-out areas, and what a distance is measured from."""

Name = Callable[["pd.Series[Any]"], str]
"""What a flight is called in the report, by its row."""

AS_IN_THE_STUDY = "as in the study"
"""What the study's own flights are called beside their comparisons."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One trial of a run: flights of one scenario.

    Attributes
    ----------
    run : as read from disk
    key : its name in the run
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
        return int(self.run.manifest.get("trial_flights", {}).get(self.key, self.config["flights"]))

    @property
    def verdict(self) -> TrialVerdict:
        """What its flights have shown."""
        nothing = TrialVerdict(counts=Counts(planned=self.planned))
        return self.run.verdict.trials.get(self.key, nothing)

    @property
    def criteria(self) -> dict[str, Any]:
        """What a flight must show to count as met."""
        return dict(self.config["criteria"])

    @property
    def flown(self) -> pd.DataFrame:
        """Flights that were flown, however they ended."""
        return flights_flown(self.rows)

    @property
    def radius(self) -> float:
        """Largest r_min of its flights [m]."""
        radii = self.rows["keepout_radius_m"].dropna()
        return float(radii.max()) if len(radii) else float(self.setting("keepout.radius_m"))

    @property
    def shape(self) -> str:
        """Shape of the keep-out area in words: "sphere", "cylinder", or both where its flights
        differ in it.
        """
        return shape_words(self.rows) or keepout_shape(self.config)

    @property
    def measured_from(self) -> str:
        """What a distance is measured from, in words: it says which shape the keep-out area has."""
        return measured_from(self.shape)

    def flight_config(self, row: "pd.Series[Any]") -> Config:
        """Return the configuration of one of its flights, given its row: the trial's own but for
        what that flight alone has.
        """
        return flight_config(self.run, row, self.config)

    @property
    def sampled_at_random(self) -> bool:
        """Whether its flights are a random sample, from which a bound on a probability follows."""
        return bool(self.run.manifest.get("sampled_at_random", {}).get(self.key, False))

    @property
    def flights_per_sample(self) -> int:
        """How many of its flights have the same seed and random variables."""
        return int(self.run.manifest.get("flights_per_sample", {}).get(self.key, 1))

    def theory(self, key: str, over: str = "nu") -> tuple[Array, Array] | None:
        """Return speed ratios, by their name, and what theory says of a figure; None where flights
        differ in more than nu.
        """
        curves = self.run.manifest.get("theory", {}).get(self.key, {})
        # In wind the speed ratio through the air is not the one that is swept.
        over_ground = column(self.flown, "vessel_speed_mps") / float(
            self.setting("guidance.airspeed_mps")
        )
        if key not in curves or not np.allclose(column(self.flown, "nu"), over_ground):
            return None
        return np.array(curves[over]), np.array(curves[key])

    def setting(self, key: str, default: Any = None) -> Any:
        """Return the configured value of a dotted key, or a default where its section or itself is
        not set.
        """
        value: Any = self.config
        for part in key.split("."):
            value = value.get(part) if isinstance(value, Mapping) else None
        return default if value is None else value

    def parameters(self) -> list[Parameters]:
        """Return every parameter with value, unit, meaning and, if the run knows it, default."""
        return list(self.run.manifest["trial_parameters"][self.key])

    def is_scaled(self, key: str) -> bool:
        """Return whether the value of a key is its default scaled to the aircraft, and not the
        default itself.
        """
        keys = self.run.manifest.get("scaled_parameters", {}).get(self.key, [])
        return key in keys and any(
            of["value"] != of["default"] for of in self.parameters() if of["key"] == key
        )

    @property
    def swept(self) -> dict[str, list[Any]]:
        """Return the values of every key that the trial sweeps, in their order."""
        sweep = self.setting("sweep", {})
        return {
            key: list(values) for key, values in leaves(sweep).items() if isinstance(values, list)
        }

    @property
    def sampled(self) -> list[dict[str, Any]]:
        """Return how each key is sampled in which flights differ at random or in turn."""
        return list(self.setting("draws", []))

    def input(self, key: str) -> "pd.Series[Any]":
        """Return the value of a swept or sampled key in each flight."""
        draws = self.run.draws
        if key in draws:
            return draws.set_index("flight_id")[key].reindex(self.rows["flight_id"])
        if key not in self.rows:
            raise ReportError(
                f"'{self.run.path / DRAWS}' is gone or has no column '{key}', which flights differ"
                f" in; {REMEDY}"
            )
        return self.rows[key].set_axis(self.rows["flight_id"])

    def varies(self, key: str) -> bool:
        """Return whether flights differ in ``key``, or in anything below it."""
        keys = [*self.swept, *(draw["key"] for draw in self.sampled)]
        return any(at_or_below(varied, key) for varied in keys)

    @property
    def kind(self) -> Kind:
        """What it is about, by what it holds and its criteria; its name says nothing."""
        turbulent = (
            self.setting("turbulence.level", "none") != "none"
            or self.setting("turbulence.gusts", 0) > 0
        )
        calm = not (turbulent or self.varies("turbulence"))
        kinds = {
            Kind.SWEEP: bool(self.swept),
            Kind.FAULTS: self._has_faults(),
            Kind.MANOEUVRES: calm
            and (bool(self.setting("vessel.manoeuvres", [])) or self.varies("vessel.manoeuvres")),
        }
        return next((kind for kind, holds in kinds.items() if holds), Kind.GENERAL)

    def _has_faults(self) -> bool:
        """Return whether flights have faults, one or several."""
        given = self.setting("fault", {})
        entries = given if isinstance(given, list) else [given]
        keys = [f"fault.{i}.kind" for i in range(len(entries))]
        return any(entry.get("kind", NO_FAULT) != NO_FAULT for entry in entries) or any(
            map(self.varies, ["fault.kind", *keys])
        )


def shape_words(rows: pd.DataFrame) -> str:
    """Return the shapes of the keep-out areas of flights, like "sphere or cylinder"; no word where
    they are not known.
    """
    known = set(rows["keepout_shape"].dropna()) if "keepout_shape" in rows else set()
    return " or ".join(shape for shape in SHAPES if shape in known)


def measured_from(shape: str) -> str:
    """Return what a distance is measured from, given the shape of the keep-out area, or shapes, in
    words.
    """
    named = shape.split(" or ")
    return ", or ".join(words for name, words in SHAPES.items() if name in named)


def leaves(tree: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Return the values of nested mappings by their dotted keys."""
    found: dict[str, Any] = {}
    for key, value in tree.items():
        found |= (
            leaves(value, f"{before}{key}.")
            if isinstance(value, Mapping)
            else {f"{before}{key}": value}
        )
    return found


def read_trials(run: RunData) -> list[Trial]:
    """Return the trials of a run, in its order.

    Raises
    ------
    ReportError : the manifest is of another version, and names no trials
    """
    refuse_other_version(run)
    return [
        Trial(
            run=run,
            key=key,
            name=f"trial{i}",
            config=config,
            rows=run.summary[run.summary["trial"] == key],
        )
        for i, (key, config) in enumerate(run.manifest["trials"].items(), start=1)
    ]
