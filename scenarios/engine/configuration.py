"""In which keys the configuration of a run differs from that of the one that is to continue it."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

_NAMED = 3
"""Keys that are named, at most."""

_SHOWN = 60
"""Letters of a value that are shown, at most."""


def changed_keys(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the first keys that differ, each with both values, in words; nothing if the manifests
    do not say which.

    Parameters
    ----------
    before, now : manifests of the run, and of the study that is to continue it
    """
    if not isinstance(before.get("config"), dict):
        return ""
    then, today = dict(_values(before)), dict(_values(json.loads(json.dumps(now))))
    keys = [key for key in dict.fromkeys([*today, *then]) if then.get(key) != today.get(key)]
    named = [
        f"{key} was {_shown(then.get(key))}, and is {_shown(today.get(key))} now"
        for key in keys[:_NAMED]
    ]
    more = [f"and {len(keys) - _NAMED} more"] if len(keys) > _NAMED else []
    return "; ".join([*named, *more])


def _values(manifest: Mapping[str, Any]) -> Iterator[tuple[str, object]]:
    yield "the scenario's name", manifest.get("name")
    yield from _flat(config := manifest.get("config"), "")
    of_trials = manifest.get("trial_parameters")
    # A list of trials says nothing of the keys that they have.
    if isinstance(config, dict) and config.get("study") == "trials" and isinstance(of_trials, dict):
        for trial, listed in of_trials.items():
            yield from (
                (f"{of['key']} of {trial}", of.get("value"))
                for of in listed
                if isinstance(of, dict) and "key" in of
            )
    yield from _flat(manifest.get("plugins"), "the hash of ")


def _flat(values: object, before: str) -> Iterator[tuple[str, object]]:
    for key, value in values.items() if isinstance(values, dict) else ():
        if isinstance(value, dict) and value:
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _shown(value: object) -> str:
    if value is None:
        return "not set"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
