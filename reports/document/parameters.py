"""Parameters of a run: what differs from the defaults, how keys are sampled, and how their values
are written.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from common.provenance import without_folders
from reports.document.blocks import Block, Fold, Table
from reports.document.tables import in_symbols
from reports.run.run_data import RunData

_DIFFERENT = (
    "Parameters that differ from their defaults; report.html and the manifest have all, and what"
    " they mean."
)

_HEAD = {"Parameter": 2.5, "Value": 1.5, "Default": 0.9, "Unit": 0.5, "Meaning and equation": 4.1}
"""Heads of the columns of parameters, and their widths in print."""

_OWN = "a table of one's own"
"""Value of a key whose table has its keys in rows of their own."""

_RANGES = {
    "start.distance_m",
    "reports.interval_s",
    "fault.at_s",
    "criteria.crossing_interval_s",
    "criteria.crossing_distance_m",
    "following.source_height_m",
    "following.load",
    "speed_ratio",
    "search.mutation",
}
"""Keys with a lower and an upper limit; other lists of two figures are two values, or a place."""

Parameters = Mapping[str, Any]
"""A parameter with its key, value, unit, meaning and, if it has one, default."""


def parameter_blocks(run: RunData, sampled: Mapping[str, str] | None = None) -> list[Block]:
    """Return the parameters of a run that differ from their defaults, and behind a fold all; of
    those that are ``sampled`` how, by their keys.
    """
    every = run.manifest["parameters"]
    words = sampled or {}
    own = parameter_rows(every, words)
    return [brief_table(own), Fold(title="Every parameter", blocks=[full_table(every, words)])]


def parameter_rows(every: Sequence[Parameters], words: Mapping[str, str]) -> list[list[str]]:
    """Return a row for each parameter that differs from its default: its key, its value, its
    default, its unit and its meaning.

    Parameters
    ----------
    every : all of them
    words : instead of a value, such as that of a key that is sampled
    """
    # A table that the user gives has its keys in the rows below.
    tables = {p["key"] for p in every if any(of["key"].startswith(f"{p['key']}.") for of in every)}
    return [
        [
            p["key"],
            words.get(p["key"])
            or (_OWN if p["key"] in tables else parameter_value(p["value"], p["key"])),
            _default(p),
            p["unit"],
            p["meaning"],
        ]
        for p in every
        if p["key"] in words or "default" not in p or p["value"] != p["default"]
    ]


def brief_table(rows: Sequence[Sequence[str]]) -> Table:
    """Return parameters in two columns, with their values and defaults, without their meanings."""
    cells = [
        [key, f"{value} {unit}".strip() + (f" ({default})" if default else "")]
        for key, value, default, unit, _ in rows
    ]
    half = -(-len(cells) // 2)
    cells += [["", ""]] * (2 * half - len(cells))
    return Table(
        caption=_DIFFERENT,
        head=["Parameter", "Value, and its default"] * 2,
        rows=[[*left, *right] for left, right in zip(cells[:half], cells[half:], strict=True)],
        widths=[2.4, 2.6, 2.4, 2.6],
        left_columns=4,
        prose=True,
        breakable=True,
        print_size_pt=6.0,
    )


def parameter_table(rows: Sequence[Sequence[str]]) -> Table:
    """Return parameters in a row each, with the columns that hold anything."""
    shown = [i for i in range(len(_HEAD)) if any(row[i] for row in rows)]
    heads, widths = list(_HEAD), list(_HEAD.values())
    return Table(
        head=[heads[i] for i in shown],
        rows=[[in_symbols(row[i]) for i in shown] for row in rows],
        widths=[widths[i] for i in shown],
        left_columns=len(shown),
        prose=True,
        breakable=True,
    )


def full_table(every: Iterable[Parameters], words: Mapping[str, str] | None = None) -> Table:
    """Return every parameter with its value, or the ``words`` for it, and its default; without
    ``words`` the default alone.
    """
    return parameter_table(
        [
            [
                p["key"],
                "" if words is None else words.get(p["key"]) or parameter_value(p["value"]),
                _default(p),
                p["unit"],
                p["meaning"],
            ]
            for p in every
        ]
    )


def _default(parameter: Parameters) -> str:
    if "default" not in parameter:
        return ""
    return parameter_value(parameter["default"], str(parameter["key"]))


def distribution(sample: Mapping[str, Any], study: str) -> str:
    """Return how a key is sampled in flights of a study, in words."""
    if sample["uniform"] is not None:
        low, high = sample["uniform"]
        return f"uniform from {low:g} to {high:g}"
    if sample["choice"] is not None:
        choices = [parameter_value(choice) for choice in sample["choice"]]
        if sample["weights"] is None:
            return f"{'one' if study == 'falsify' else 'in turn one'} of: {'; '.join(choices)}"
        whole = sum(sample["weights"])
        shares = zip(sample["weights"], choices, strict=True)
        return "; ".join(f"{100.0 * weight / whole:.0f} % {choice}" for weight, choice in shares)
    if sample["normal"] is not None:
        mean, sigma = sample["normal"]
        words = f"normal, mean {mean:g}, deviation {sigma:g}"
    else:
        shape, scale = sample["weibull"]
        words = f"Weibull, shape {shape:g}, scale {scale:g}"
    if sample["within"]:
        words += f", from {sample['within'][0]:g} to {sample['within'][1]:g}"
    return words


def parameter_value(value: Any, key: str = "") -> str:
    """Return the value of a parameter in words; some lists mean a range, which their key tells."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        if _are_manoeuvres(value, key):
            return manoeuvre_name(value)
        # The entries of a list have the keys of one.
        between = " to " if re.sub(r"\.\d+\.", ".", key) in _RANGES else ", "
        return between.join(map(_entry_in_words, value)) or "none"
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {_in_braces(of, name)}" for name, of in value.items()) or "none"
    if isinstance(value, float):
        return f"{value:g}"
    return "not set" if value is None else without_folders(str(value)) or "none"


def _are_manoeuvres(value: list[Any], key: str) -> bool:
    return (not value and key.endswith("manoeuvres")) or any(
        isinstance(entry, Mapping) and {"turn_deg", "speed_mps"} & set(entry) for entry in value
    )


def _in_braces(value: Any, key: str) -> str:
    """Return a value in a table in words, of a table in braces: they show where it ends."""
    words = parameter_value(value, key)
    return f"{{ {words} }}" if isinstance(value, Mapping) and value else words


def _entry_in_words(entry: Any) -> str:
    """Return an entry of a list: of a table by its name, of a draw by the key that is drawn and
    how.
    """
    if not isinstance(entry, Mapping):
        return parameter_value(entry)
    if "name" in entry:
        return str(entry["name"]).replace("_", " ")
    settings = (f"{name} {parameter_value(of)}" for name, of in entry.items() if name != "key")
    return " ".join([str(entry.get("key", "")), *settings]).strip()


def manoeuvre_name(manoeuvres: Sequence[Mapping[str, Any]]) -> str:
    """Return what a vessel does, in a few words."""
    return ", then ".join(map(_one_manoeuvre, manoeuvres)) or "none"


def _one_manoeuvre(manoeuvre: Mapping[str, Any]) -> str:
    parts = []
    turn, speed = float(manoeuvre.get("turn_deg", 0.0)), manoeuvre.get("speed_mps")
    if turn:
        rate = manoeuvre.get("turn_rate_deg_s")
        side = "starboard" if turn > 0.0 else "port"
        parts.append(f"{abs(turn):g}° to {side}" + (f" at {float(rate):g}°/s" if rate else ""))
    if speed is not None:
        parts.append("stops" if speed == 0.0 else f"to {float(speed):g} m/s")
    return " and ".join(parts) or "keeps course and speed"
