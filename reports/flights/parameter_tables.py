"""Tables of parameters: what trials set, sweep and sample, what follows from it, and the defaults."""

import re
from typing import Any

from reports.document.blocks import Block, Fold, Table, Text
from reports.document.tables import in_symbols, parameter_value, span
from reports.flights.names import flown_elsewhere, manoeuvre_name, swept_column
from reports.flights.trials.tables import OSCILLATION_COLUMNS, flight_table
from reports.monte_carlo.names import input_name, input_unit
from reports.run.columns import column
from reports.run.run_data import RunData
from reports.run.trials import Parameters, Trial

_HEAD = ["Parameter", "Value", "Default", "Unit", "Meaning and equation"]
_WIDTHS = [2.5, 1.5, 0.9, 0.5, 4.1]

_ALL = "Parameters that differ from their defaults; report.html and the manifest have all, and what they mean."

_VALUE, _NO_DEFAULT = "{value} ({default})", " ()"
"""How a value and its default are written, and what is left of that without a default."""

_OWN = "a table of one's own"
"""Value of a key whose table has its keys in rows of their own."""

_ANY_RATIO = 1e9
"""Upper end of the speed ratios of a scenario that limits none [-]."""


def parameter_blocks(run: RunData, trials: list[Trial]) -> list[Block]:
    """Return what a run's trials set, sweep and sample, and behind a fold every other parameter with
    its default.
    """
    if not trials:
        return []
    blocks: list[Block] = []
    more: list[Table] = []
    if len(trials) == 1 and trials[0].swept and len(trials[0].flown):
        more.append(
            flight_table(
                run,
                trials[0].flown,
                *swept_column(trials[0]),
                OSCILLATION_COLUMNS,
                flown_ratio=flown_elsewhere(trials[0]),
                caption="The reference's oscillation in each flight; by equations (6), (8) and (10) of the paper.",
            )
        )
    if len(trials) == 1:
        rows = _rows(trials[0]) + _derived(run, trials[0])
        blocks.append(_in_two_columns(rows))
        more.append(_table(rows))
    else:
        # What a trial is about stands above its figures.
        blocks.append(Text("What each trial sets is in the manifest, and in report.html."))
        blocks += [Fold(title=trial.title, blocks=[_table(_rows(trial))]) for trial in trials]
    every = [[p["key"], "", _default(p), p["unit"], p["meaning"]] for p in trials[0].parameters()]
    title = "Every parameter, with its default"
    return [*blocks, Fold(title=title, blocks=[*more, _table(every)])]


def _in_two_columns(rows: list[list[str]]) -> Table:
    """Return parameters with their values and defaults, without their meanings."""
    half = -(-len(rows) // 2)
    cells = [
        [row[0], _VALUE.format(value=f"{row[1]} {row[3]}".strip(), default=row[2])] for row in rows
    ]
    short = [[name, value.removesuffix(_NO_DEFAULT)] for name, value in cells]
    short += [["", ""]] * (2 * half - len(short))
    return Table(
        caption=_ALL,
        head=["Parameter", "Value, and its default"] * 2,
        rows=[[*left, *right] for left, right in zip(short[:half], short[half:], strict=True)],
        widths=[2.4, 2.6, 2.4, 2.6],
        left_columns=4,
        prose=True,
        breakable=True,
        print_size_pt=6.0,
    )


def _table(rows: list[list[str]]) -> Table:
    shown = [i for i in range(len(_HEAD)) if i in (0, 4) or any(row[i] for row in rows)]
    return Table(
        head=[_HEAD[i] for i in shown],
        rows=[
            [in_symbols(row[i]) if _HEAD[i].startswith("Meaning") else row[i] for i in shown]
            for row in rows
        ],
        widths=[_WIDTHS[i] for i in shown],
        left_columns=len(shown),
        prose=True,
        breakable=True,
    )


def _rows(trial: Trial) -> list[list[str]]:
    """Return what a trial sweeps and samples, and the parameters that differ from their defaults."""
    listed = {parameter["key"]: parameter for parameter in trial.parameters()}
    rows = [
        [
            "flights, seed",
            f"{trial.planned}, {trial.config['seed']}",
            "",
            "",
            "Number of flights; seed of all random numbers",
        ]
    ]
    low, high = trial.setting("speed_ratio") or (0.0, _ANY_RATIO)
    if high < _ANY_RATIO and (trial.varies("wind") or trial.varies("vessel")):
        rows.append(
            [
                "speed_ratio",
                f"{low:g} to {high:g}",
                "",
                "",
                "Samples with another speed ratio ν are sampled again",
            ]
        )
    inputs = {key: f"swept: {parameter_value(values)}" for key, values in trial.swept.items()}
    inputs |= {
        sample["key"]: distribution(sample, trial.setting("study", "flights"))
        for sample in trial.sampled
    }
    for key, words in inputs.items():
        about = listed.get(
            key, {"meaning": _meaning(key), "unit": input_unit(key).replace("-", "")}
        )
        rows.append([key, words, _default(about), about.get("unit", ""), about["meaning"]])
    # A table of the user's own has its keys in the rows below.
    tables = {key for key in listed if any(of.startswith(f"{key}.") for of in listed)}
    return rows + [
        [
            key,
            _OWN if key in tables else value_in_words(p["value"], key),
            _default(p),
            p["unit"],
            p["meaning"],
        ]
        for key, p in listed.items()
        if key not in inputs and ("default" not in p or p["value"] != p["default"])
    ]


def _meaning(key: str) -> str:
    """Return the meaning of an input that is no key of its own: the speed ratio, or of an entry of
    a list.
    """
    if entry := re.fullmatch(r"vessel\.manoeuvres\.(\d+)\.(\w+)", key):
        return (
            f"Of the vessel's manoeuvre number {int(entry[1]) + 1}: {input_name(entry[2]).lower()}"
        )
    return "Speed ratio ν of the vessel and the UAV" if key == "nu" else ""


def distribution(sample: dict[str, Any], study: str) -> str:
    """Return how a key is sampled in flights of a study, in words."""
    if sample["uniform"] is not None:
        low, high = sample["uniform"]
        return f"uniform from {low:g} to {high:g}"
    if sample["choice"] is not None:
        choices = [value_in_words(choice) for choice in sample["choice"]]
        if sample["weights"] is None:
            return f"{'one' if study == 'falsify' else 'in turn one'} of: {'; '.join(choices)}"
        whole = sum(sample["weights"])
        return "; ".join(
            f"{100.0 * w / whole:.0f} % {choice}"
            for w, choice in zip(sample["weights"], choices, strict=True)
        )
    if sample["normal"] is not None:
        mean, sigma = sample["normal"]
        words = f"normal, mean {mean:g}, deviation {sigma:g}"
    else:
        shape, scale = sample["weibull"]
        words = f"Weibull, shape {shape:g}, scale {scale:g}"
    return (
        f"{words}, from {sample['within'][0]:g} to {sample['within'][1]:g}"
        if sample["within"]
        else words
    )


def _default(parameter: Parameters) -> str:
    return (
        value_in_words(parameter["default"], str(parameter["key"]))
        if "default" in parameter
        else ""
    )


def value_in_words(value: Any, key: str = "") -> str:
    """Return a value in words; a list of sections can only be manoeuvres."""
    if isinstance(value, list) and (
        isinstance(value[0], dict) if value else key.endswith("manoeuvres")
    ):
        return manoeuvre_name(value)
    return parameter_value(value, key)


def _derived(run: RunData, trial: Trial) -> list[list[str]]:
    """Return rows for what follows from the parameters."""
    limit = "Largest heading-rate command: g tan(bank)/V_r, or as given."
    derived = [("ω_max", "heading_rate_limit_rad_s", "{:.4f}", "rad/s", limit)]
    if trial.setting("guidance.tuning") == "bounded":
        where = "Over the flights; docs/actuation_bounds.md."
        derived += [
            ("ε as searched", "epsilon_per_m", "{:.5f}", "1/m", where),
            ("R as searched", "look_ahead_m", "{:.1f}", "m", where),
            ("steering_max as searched", "steering_max_rad_s", "{:.4f}", "rad/s", where),
            (
                "bound on the heading-rate demand",
                "heading_rate_bound_rad_s",
                "{:.5f}",
                "rad/s",
                where,
            ),
        ]
    rows = [
        [name, span(column(trial.rows, key), pattern), "", unit, meaning]
        for name, key, pattern, unit, meaning in derived
    ]
    if run.manifest.get("guidance_lag_s") is not None:
        meaning = (
            "Lag of the heading rate behind its command (measured of an aircraft, given of a kinematic vehicle) and half a step of"
            " the guidance: the preview's lead."
        )
        rows.append(["guidance lag", f"{run.manifest['guidance_lag_s']:.3f}", "", "s", meaning])
    return rows
