"""Parameters of trials: what they set, sweep and sample, and what follows from it."""

import re

from reports.document.blocks import Block, Fold, Text
from reports.document.parameters import (
    brief_table,
    distribution,
    full_table,
    parameter_rows,
    parameter_table,
    parameter_value,
)
from reports.document.tables import span
from reports.monte_carlo.names import input_name, input_unit
from reports.run.columns import column
from reports.run.run_data import RunData
from reports.run.trials import Trial

_ANY_RATIO = 1e9
"""Upper end of the speed ratios of a scenario that limits none [-]."""

_SEARCHED = "Over the flights; docs/actuation_bounds.md."

_FOLLOWS = {
    "heading_rate_limit_rad_s": (
        "ω_max",
        "{:.4f}",
        "rad/s",
        "Largest heading-rate command: g tan(bank)/V_r, or as given.",
    ),
    "epsilon_per_m": ("ε as searched", "{:.5f}", "1/m", _SEARCHED),
    "look_ahead_m": ("R as searched", "{:.1f}", "m", _SEARCHED),
    "steering_max_rad_s": ("steering_max as searched", "{:.4f}", "rad/s", _SEARCHED),
    "heading_rate_bound_rad_s": ("bound on the demand", "{:.5f}", "rad/s", _SEARCHED),
}
"""Name, pattern, unit and meaning of columns that follow from the parameters."""

_LAG = (
    "Lag of the heading rate behind its command (measured of an aircraft, given of a kinematic"
    " vehicle) and half a step of the guidance: the preview's lead."
)


def trial_parameters(run: RunData, trials: list[Trial]) -> list[Block]:
    """Return what a run's trials set, sweep and sample, and behind a fold every other parameter
    with its default.
    """
    if not trials:
        return []
    blocks: list[Block] = []
    if len(trials) == 1:
        rows = _rows(trials[0]) + _follows(run, trials[0])
        blocks.append(brief_table(rows))
        more = [full_table(trials[0].parameters(), _sampled(trials[0]))]
    else:
        # What a trial is about stands above its figures.
        blocks.append(Text("What each trial sets is in the manifest, and in report.html."))
        blocks += [Fold(title=of.title, blocks=[parameter_table(_rows(of))]) for of in trials]
        more = [full_table(trials[0].parameters())]
    return [*blocks, Fold(title="Every parameter, with its default", blocks=more)]


def _rows(trial: Trial) -> list[list[str]]:
    """Return what a trial sweeps and samples, and the parameters that differ from their
    defaults.
    """
    numbers = f"{trial.planned}, {trial.config['seed']}"
    rows = [["flights, seed", numbers, "", "", "Number of flights; seed of all random numbers"]]
    low, high = trial.setting("speed_ratio") or (0.0, _ANY_RATIO)
    if high < _ANY_RATIO and (trial.varies("wind") or trial.varies("vessel")):
        meaning = "Samples with another speed ratio ν are sampled again"
        rows.append(["speed_ratio", f"{low:g} to {high:g}", "", "", meaning])
    inputs = _sampled(trial)
    own = parameter_rows(trial.parameters(), inputs)
    listed = {row[0] for row in own}
    others = [
        [key, words, "", input_unit(key).replace("-", ""), _meaning(key)]
        for key, words in inputs.items()
        if key not in listed
    ]
    return [*rows, *others, *sorted(own, key=lambda row: row[0] not in inputs)]


def _sampled(trial: Trial) -> dict[str, str]:
    """Return how each key is swept or sampled in which flights differ."""
    study = trial.setting("study", "flights")
    words = {key: f"swept: {parameter_value(values)}" for key, values in trial.swept.items()}
    return words | {sample["key"]: distribution(sample, study) for sample in trial.sampled}


def _meaning(key: str) -> str:
    """Return the meaning of an input that is no key: the speed ratio, or an entry of a list."""
    if entry := re.fullmatch(r"vessel\.manoeuvres\.(\d+)\.(\w+)", key):
        number = int(entry[1]) + 1
        return f"Of the vessel's manoeuvre number {number}: {input_name(entry[2]).lower()}"
    return "Speed ratio ν of the vessel and the UAV" if key == "nu" else ""


def _follows(run: RunData, trial: Trial) -> list[list[str]]:
    """Return rows for what follows from the parameters."""
    bounded = trial.setting("guidance.tuning") == "bounded"
    rows = [
        [name, span(column(trial.rows, key), pattern), "", unit, meaning]
        for key, (name, pattern, unit, meaning) in _FOLLOWS.items()
        if bounded or meaning is not _SEARCHED
    ]
    if (lag := run.manifest.get("guidance_lag_s")) is not None:
        rows.append(["guidance lag", f"{lag:.3f}", "", "s", _LAG])
    return rows
