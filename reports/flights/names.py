"""What flights, swept keys, faults and manoeuvres are called."""

import json
import re
from typing import Any

import pandas as pd

from reports.monte_carlo.names import input_name, input_unit
from reports.run.trials import Trial


def flight_name(trial: Trial, row: "pd.Series[Any]") -> str:
    """Return what a flight is called: by what was swept, or by its number, or by its name."""
    flight_id = str(row["flight_id"])
    if trial.swept:
        first, *others = (_swept(key, trial.input(key)[flight_id]) for key in trial.swept)
        return ", ".join([first, *(words[0].lower() + words[1:] for words in others)])
    counted = re.search(r"_(\d+)$", flight_id)
    return f"Flight {int(counted[1])}" if counted else flight_id


def swept_name(trial: Trial) -> str:
    """Return what was swept, for the head of a column of ``swept_value``."""
    first, *others = ("ν" if key == "nu" else input_name(key) for key in trial.swept)
    return ", ".join([first, *(words[0].lower() + words[1:] for words in others)])


def swept_value(trial: Trial, row: "pd.Series[Any]") -> str:
    """Return the values of a flight of what was swept, without their names."""
    return ", ".join(_value(key, trial.input(key)[str(row["flight_id"])]) for key in trial.swept)


def _swept(key: str, value: Any) -> str:
    if key == "nu":
        return f"ν = {_value(key, value)}"
    return f"{input_name(key)} {_value(key, value)}" if isinstance(value, float) else _value(key, value)


def _value(key: str, value: Any) -> str:
    if key == "nu":
        return f"{value:.2f}"
    unit = input_unit(key)
    return f"{value:.4g}{'' if unit == '-' else f' {unit}'}" if isinstance(value, float) else str(value)


def fault_name(kind: object) -> str:
    """Return what a fault is called."""
    return str(kind).replace("_", " ")


def manoeuvre_name(manoeuvres: list[dict[str, Any]]) -> str:
    """Return what a vessel does, in a few words."""
    return ", then ".join(_one_manoeuvre(manoeuvre) for manoeuvre in manoeuvres) or "none"


def manoeuvres_flown(trial: Trial) -> list[str] | None:
    """Return what the vessel did in each flight that was flown, in a few words; None where no table says all of it.

    Where a part of a manoeuvre alone is swept or sampled, every flight has one of its own: a name for each groups nothing.
    """
    key = "vessel.manoeuvres"
    if not trial.varies(key):
        return [manoeuvre_name(trial.setting(key, []))] * len(trial.flown)
    varied = [*trial.swept, *(draw["key"] for draw in trial.sampled)]
    if key not in trial.run.draws or any(name.startswith(f"{key}.") for name in varied):
        return None
    cells = trial.input(key).reindex(trial.flown["flight_id"])
    return [manoeuvre_name(json.loads(cell) if isinstance(cell, str) else []) for cell in cells]


def _one_manoeuvre(manoeuvre: dict[str, Any]) -> str:
    parts = []
    turn, speed = float(manoeuvre.get("turn_deg", 0.0)), manoeuvre.get("speed_mps")
    if turn:
        rate = f" at {float(manoeuvre['turn_rate_deg_s']):g}°/s" if "turn_rate_deg_s" in manoeuvre else ""
        parts.append(f"{abs(turn):g}° to {'starboard' if turn > 0.0 else 'port'}{rate}")
    if speed is not None:
        parts.append("stops" if speed == 0.0 else f"to {float(speed):g} m/s")
    return " and ".join(parts) or "keeps course and speed"
