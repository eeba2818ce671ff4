"""What flights, swept keys and manoeuvres are called."""

import json
import math
import re
from collections.abc import Callable
from functools import lru_cache, partial
from numbers import Number
from typing import Any

import numpy as np
import pandas as pd

from reports.document.parameters import manoeuvre_name, parameter_value
from reports.monte_carlo.names import input_name, input_unit
from reports.run.columns import column
from reports.run.trials import Trial

_SPEED_RATIO = "vessel.speed_ratio"
"""Key that ``nu`` stands for where it is swept; in wind the column ``nu`` is another ratio, that
through the air.
"""

_SAME_RATIO = 0.005
"""Within which two speed ratios are written the same [-]."""

_DIGITS_MAX = 17
"""Digits that tell any two numbers apart."""

_BARE = ("none", "yes", "no", "not set")
"""Values that say nothing without the name of their key."""


def flight_name(trial: Trial, row: "pd.Series[Any]") -> str:
    """Return what a flight is called in its trial: by what was swept, or as in the files of the
    run.
    """
    flight_id, values = str(row["flight_id"]), _values(trial, row)
    if not values:
        return flight_id
    counted = re.search(r"_(\d+)$", flight_id)
    first, *others = (_swept(trial, key, value) for key, value in values.items())
    words = [first, *(words[0].lower() + words[1:] for words in others)]
    # Several flights at the same values have a number each.
    return ", ".join(
        [*words, *([f"flight {int(counted[1])}"] if counted and _repeated(trial) else [])]
    )


def name_in_run(trial: Trial, row: "pd.Series[Any]") -> str:
    """Return what a flight is called among those of all trials: swept values alone may be those of
    two trials.
    """
    several = trial.swept and len(trial.run.manifest["trials"]) > 1
    return f"{trial.title}, {flight_name(trial, row)}" if several else flight_name(trial, row)


def swept_column(trial: Trial) -> tuple[str, Callable[["pd.Series[Any]"], str]]:
    """Return head and cells of a column that says which flight a row is about: the values of one
    key, else whole names.
    """
    if len(trial.swept) > 1 or _repeated(trial):
        return "Flight", partial(flight_name, trial)
    (key,) = trial.swept

    def called(row: "pd.Series[Any]") -> str:
        values = _values(trial, row)
        return _value(key, values[key], _numbers(trial, key)) if values else str(row["flight_id"])

    return "ν" if key == "nu" else input_name(key), called


def swept_words(trial: Trial) -> dict[str, list[str]]:
    """Return the values in each flown flight of every key that was swept over words, without the
    folders of files.
    """
    return {
        key: [_value(key, value).replace("_", " ") for value in of]
        for key, of in _words(trial).items()
    }


def words_together(trial: Trial) -> list[str]:
    """Return what each flown flight is called by all words that were swept, with the names of their
    keys where these say which.

    Words that change nothing in the flights, such as sensors that only listen, are left out:
    their markers would cover each other.
    """
    words = {key: of for key, of in _words(trial).items() if changes_flights(trial, key)}
    called = [
        [_swept(trial, key, value).replace("_", " ") for value in of] for key, of in words.items()
    ]
    return [", ".join(each) for each in zip(*called, strict=True)]


def changes_flights(trial: Trial, key: str) -> bool:
    """Return whether flights that differ in a key that was swept, and in no other, differ in how
    near they came.
    """
    ids = trial.flown["flight_id"]
    values = {
        of: trial.input(_SPEED_RATIO if of == "nu" else of).reindex(ids).astype(str).tolist()
        for of in trial.swept
    }
    others = [of for of in trial.swept if of != key]
    found = pd.DataFrame(values).assign(nearest=column(trial.flown, "min_distance_m"))
    alike = found.groupby(others) if others else found.groupby(lambda _: 0)
    differ = alike[key].nunique() > 1
    return not differ.any() or bool((alike["nearest"].nunique(dropna=False)[differ] > 1).any())


def flown_elsewhere(trial: Trial) -> bool:
    """Return whether flights have another speed ratio than the one that was swept: in wind it is
    that through the air.
    """
    if "nu" not in trial.swept:
        return False
    swept = trial.input(_SPEED_RATIO).reindex(trial.flown["flight_id"])
    return bool(
        np.any(np.abs(column(trial.flown, "nu") - swept.to_numpy(dtype=np.float64)) > _SAME_RATIO)
    )


def _repeated(trial: Trial) -> bool:
    """Return whether several flights have the same values of what was swept."""
    return trial.planned > math.prod(len(values) for values in trial.swept.values())


def _values(trial: Trial, row: "pd.Series[Any]") -> dict[str, Any]:
    """Return the values of a flight of what was swept; none of one that was lost with its process,
    before it wrote any.
    """
    flight_id = str(row["flight_id"])
    if not (trial.rows["flight_id"] == flight_id).any():
        # A comparison's flight has the values of the study's own that it is compared with.
        return {}
    values = {
        key: trial.input(_SPEED_RATIO if key == "nu" else key)[flight_id] for key in trial.swept
    }
    return (
        {} if any(_is_number(value) and math.isnan(value) for value in values.values()) else values
    )


def _words(trial: Trial) -> "dict[str, pd.Series[Any]]":
    """Return the values in each flown flight of every key that was swept over words."""
    values = {key: trial.input(key).reindex(trial.flown["flight_id"]) for key in trial.swept}
    return {
        key: of
        for key, of in values.items()
        if not pd.api.types.is_numeric_dtype(of) or pd.api.types.is_bool_dtype(of)
    }


def _swept(trial: Trial, key: str, value: Any) -> str:
    """Return what the value of a key is called, so that others of the sweep differ."""
    words = _value(key, value, _numbers(trial, key))
    if key == "nu":
        return f"ν = {words}"
    # A word may be that of another key, or say nothing by itself.
    bare = _is_number(value) or len(trial.swept) > 1 or words in _BARE
    return f"{input_name(key)} {words}" if bare else words


def _value(key: str, value: Any, among: tuple[float, ...] = ()) -> str:
    if key == "nu":
        return f"{value:.{_digits(among, 'f', 2)}f}"
    unit = input_unit(key)
    return (
        f"{value:.{_digits(among, 'g', 4)}g}{'' if unit == '-' else f' {unit}'}"
        if _is_number(value)
        else parameter_value(value.item() if isinstance(value, np.generic) else value, key)
    )


def _numbers(trial: Trial, key: str) -> tuple[float, ...]:
    """Return the numbers that a key is swept over."""
    return tuple(dict.fromkeys(float(value) for value in trial.swept[key] if _is_number(value)))


@lru_cache
def _digits(values: tuple[float, ...], kind: str, least: int) -> int:
    """Return how many digits tell numbers apart, ``least`` of them at least: after the point ("f"),
    or significant ones ("g").
    """
    counts = range(least, _DIGITS_MAX)
    return next(
        (n for n in counts if len({f"{value:.{n}{kind}}" for value in values}) == len(values)),
        _DIGITS_MAX,
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, Number) and not isinstance(value, bool)


def manoeuvres_flown(trial: Trial) -> list[str] | None:
    """Return what the vessel did in each flight that was flown, in a few words; None where no table
    says all of it.

    Where only a part of a manoeuvre is swept or sampled, every flight has another one: a name for
    each groups nothing.
    """
    key = "vessel.manoeuvres"
    if not trial.varies(key):
        return [manoeuvre_name(trial.setting(key, []))] * len(trial.flown)
    varied = [*trial.swept, *(draw["key"] for draw in trial.sampled)]
    if key not in trial.run.draws or any(name.startswith(f"{key}.") for name in varied):
        return None
    cells = trial.input(key).reindex(trial.flown["flight_id"])
    return [manoeuvre_name(json.loads(cell) if isinstance(cell, str) else []) for cell in cells]
