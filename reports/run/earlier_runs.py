"""Runs of earlier versions, read as those of this one."""

import math
from typing import Any

import pandas as pd

Record = dict[str, Any]

_STUDIES = {"sea": "trials", "sea_trial": "trials", "falsify": "falsification"}

_COLUMNS = {
    "heading_rate_wanted_max_rad_s": "heading_rate_demand_max_rad_s",
    "heading_rate_wanted_rad_s": "heading_rate_demand_rad_s",
    "guard_intervening": "guard",
}


def manifest_today(manifest: Record) -> Record:
    """Return a manifest with the study's name of today and, if of flights, with trials: a sweep is one trial."""
    study = manifest.get("study", "flights")
    manifest = manifest | {"study": _STUDIES.get(str(study), study)}
    if study not in ("flights", "paper") or "trials" in manifest:
        return manifest
    name, config = str(manifest.get("name", "study")), manifest["config"]
    trial = config | {"flights": manifest.get("flights_planned", 0)}
    return {"trials": {name: trial}, "trial_parameters": {name: manifest.get("parameters", [])}, "modes": [], **manifest}


def rows_today(rows: pd.DataFrame, manifest: Record) -> pd.DataFrame:
    """Return a table of flights with the columns of today."""
    rows = rows.rename(columns=_COLUMNS)
    if "variant" not in rows and "flight_id" in rows:
        rows["variant"] = [manifest.get("variants", {}).get(flight_id, "study") for flight_id in rows["flight_id"]]
    if "trial" not in rows and manifest.get("trials"):
        rows["trial"] = next(iter(manifest["trials"]))
    return rows


def history_today(history: pd.DataFrame, config: Record, nu: float) -> pd.DataFrame:
    """Return a time history with the columns of today: in calm air vessel and plume follow from the speed ratio."""
    history = history.rename(columns=_COLUMNS)
    if "vessel_north_m" in history or "vessel" not in config:
        return history
    course = math.radians(config["vessel"]["course_deg"])
    speed = nu * float(config["guidance"]["airspeed_mps"])
    return history.assign(
        vessel_north_m=speed * math.cos(course) * history["time_s"],
        vessel_east_m=speed * math.sin(course) * history["time_s"],
        plume_axis_rad=course + math.radians(config["plume"]["heading_deg"]),
    )
