"""What differs in the configuration of runs, key by key, and in the software that flew them."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from reports.compare.pairs import Run
from reports.document.blocks import Table
from reports.document.parameters import distribution, parameter_value
from reports.run.trials import Trial, leaves

NOT_A_KEY = "not a key"
"""What stands for the value of a key that a run's scenario does not have."""

_WORDS = ("title", "description", "study")
"""Keys that name a scenario rather than change what is flown."""

_LONG = 6
"""Numbers of a list that are all shown."""

_SAME = "the same"

Values = tuple[str, ...]


def configuration_table(runs: Sequence[Run]) -> Table | None:
    """Return each key that differs between runs, with its value in each of them, or None if none
    does.
    """
    rows = []
    about = _meanings(runs)
    for (key, values), trials in _differing(runs).items():
        where = f"{key} ({', '.join(trials)})" if all(trials) else key
        meaning, unit = about.get(key, ("", ""))
        rows.append([where, *values, unit, meaning])
    if not rows:
        return None
    return Table(
        head=["Key", *(run.letter for run in runs), "Unit", "Meaning"],
        rows=rows,
        widths=[2.6, *(1.4 for _ in runs), 0.6, 3.0],
        left_columns=len(runs) + 3,
        prose=True,
        breakable=True,
    )


def trials_apart(runs: Sequence[Run]) -> list[str]:
    """Return a sentence for each run that has trials which others do not have; none where each run
    has one trial alone.
    """
    if _single(runs):
        return []
    shared = set.intersection(*({trial.key for trial in run.trials} for run in runs))
    found = {
        run.title: [trial.key for trial in run.trials if trial.key not in shared] for run in runs
    }
    return [
        f"Not in every run are, of {title}, the trials {', '.join(names)}."
        for title, names in found.items()
        if names
    ]


def _single(runs: Sequence[Run]) -> bool:
    return all(len(run.trials) == 1 for run in runs)


def _differing(runs: Sequence[Run]) -> dict[tuple[str, Values], list[str]]:
    """Return the trials, by key and its values, in which they differ; runs of one trial each are
    compared even if their trials have other names.
    """
    found: dict[tuple[str, Values], list[str]] = {}
    single = _single(runs)
    trials = [{"" if single else trial.key: trial for trial in run.trials} for run in runs]
    for name in trials[0]:
        if all(name in of for of in trials):
            configured = [_settings(of[name]) for of in trials]
            # A key of a part that is not set is no key of the configuration.
            defaults = [
                {parameter["key"]: parameter["value"] for parameter in of[name].parameters()}
                for of in trials
            ]
            for key in dict.fromkeys(key for settings in configured for key in settings):
                given = [
                    of.get(key, default.get(key, NOT_A_KEY))
                    for of, default in zip(configured, defaults, strict=True)
                ]
                if any(value != given[0] for value in given[1:]):
                    found.setdefault((key, _in_words(key, given)), []).append(name)
    return found


def _settings(trial: Trial) -> dict[str, Any]:
    """Return the values of a trial's configuration by dotted keys: a sampled key’s distribution;
    cases and variants by name.
    """
    config = {key: value for key, value in trial.config.items() if key not in (*_WORDS, "draws")}
    sampled = {draw["key"]: distribution(draw, str(config.get("study"))) for draw in trial.sampled}
    return leaves(_named(config)) | sampled


def _named(value: Any) -> Any:
    """Return nested settings in which lists of named tables are mappings by their names."""
    if (
        isinstance(value, list)
        and value
        and all(isinstance(entry, Mapping) and "name" in entry for entry in value)
    ):
        return {
            str(entry["name"]): _named({key: of for key, of in entry.items() if key != "name"})
            for entry in value
        }
    return {key: _named(of) for key, of in value.items()} if isinstance(value, Mapping) else value


def _in_words(key: str, values: Sequence[Any]) -> Values:
    """Return values as they are printed: long lists by their number and range, unless that hides in
    what they differ.
    """
    different = len({json.dumps(value) for value in values})
    for words in (_brief, _whole):
        written = tuple(words(value, key) for value in values)
        if len(set(written)) == different:
            return written
    return tuple(json.dumps(value) for value in values)


def _whole(value: Any, key: str) -> str:
    return parameter_value(value, key)


def _brief(value: Any, key: str) -> str:
    if (
        isinstance(value, list)
        and len(value) > _LONG
        and all(isinstance(entry, int | float) for entry in value)
    ):
        return f"{len(value)} values, {min(value):g} to {max(value):g}"
    return _whole(value, key)


def _meanings(runs: Sequence[Run]) -> dict[str, tuple[str, str]]:
    """Return meaning and unit of each key that acts in some run, or has there another value than
    its default.
    """
    return {
        str(parameter["key"]): (str(parameter["meaning"]), str(parameter["unit"]))
        for run in runs
        for trial in run.trials
        for parameter in (
            *trial.parameters(),
            *run.manifest.get("unused_parameters", {}).get(trial.key, []),
        )
    }


def software_table(runs: Sequence[Run]) -> Table:
    """Return what each run is and what flew it; what differs from the first run is in bold."""
    rows = [
        ["Scenario", *(f"{run.manifest['name']}: {run.manifest['title']}" for run in runs)],
        [
            "State",
            *(
                f"{run.state}, {len(run.data.summary):,} of {run.manifest['flights_planned']:,}"
                " flights"
                for run in runs
            ),
        ],
        ["Overrides", *(", ".join(run.manifest["overrides"]) or "none" for run in runs)],
        ["Configuration hash", *(str(run.manifest["config_hash"]) for run in runs)],
        ["Source revision", *(str(run.manifest["git_revision"]) for run in runs)],
        [
            "Hash of the source",
            *(str(run.manifest["fingerprint"].get("source", "unknown")) for run in runs),
        ],
        ["Python", *(f"{run.manifest['python']} on {run.manifest['platform']}" for run in runs)],
        *_packages(runs),
        *_files(runs),
        ["Autopilot’s design", *_designs(runs)],
    ]
    bold = [
        (i, k)
        for i, row in enumerate(rows)
        for k in range(2, len(row))
        if row[k] not in (row[1], _SAME)
    ]
    return Table(
        head=["", *(run.title for run in runs)],
        rows=rows,
        widths=[1.0, *(2.0 for _ in runs)],
        left_columns=len(runs) + 1,
        prose=True,
        breakable=True,
        bold=bold,
    )


def _packages(runs: Sequence[Run]) -> list[list[str]]:
    """Return a row for each package whose versions differ, and one for all others."""
    versions = [dict(run.manifest["packages"]) for run in runs]
    names = dict.fromkeys(name for of in versions for name in of)
    differing = [name for name in names if len({of.get(name) for of in versions}) > 1]
    rows = [
        [f"Version of {name}", *(str(of.get(name, "not recorded")) for of in versions)]
        for name in differing
    ]
    same = [f"{name} {versions[0][name]}" for name in names if name not in differing]
    return (
        [
            *rows,
            ["Other packages" if rows else "Packages", ", ".join(same), *(_SAME for _ in runs[1:])],
        ]
        if same
        else rows
    )


def _files(runs: Sequence[Run]) -> list[list[str]]:
    """Return a row for each file of the user that some run takes a part or a vessel's track
    from.
    """
    used = [run.manifest.get("plugins", {}) | run.manifest.get("vessel_files", {}) for run in runs]
    # Their directories are left out: they are those of a machine.
    named = [
        {name.replace("\\", "/").rpartition("/")[2]: known for name, known in of.items()}
        for of in used
    ]
    names = sorted({name for of in named for name in of})
    return [[f"File {name}", *(_file(of.get(name)) for of in named)] for name in names]


def _file(known: Any) -> str:
    """Return a file's hash, or how many of its rows were used."""
    if known is None:
        return "not used"
    return f"{known['used']} of {known['rows']} rows" if isinstance(known, Mapping) else str(known)


def _designs(runs: Sequence[Run]) -> list[str]:
    """Return what designs are called, and their hashes."""
    designs = (run.data.innerloop for run in runs)
    return [f"{of['title']}, {_hash(of)}" if of else "none" for of in designs]


def _hash(design: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(design, sort_keys=True).encode()).hexdigest()[:12]
