"""The report of a convergence study: when trajectories settle under each law, and the trajectories
that did not converge.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.run_layout import HISTORY_SUFFIX
from extensions.convergence import COUNTEREXAMPLES, TRAJECTORIES, trajectory_path
from reports.document.blocks import Block, Card, Findings, Heading, Section, Table, Text, Verdict
from reports.document.chart import Chart, Line, Panel, Style
from reports.document.parameters import parameter_blocks
from reports.document.state import state_words
from reports.document.tables import Cell, number, rows_table
from reports.run.columns import Array, column
from reports.run.run_data import RunData

CURVE_POINTS, HISTORY_POINTS = 200, 500
"""Points of a cumulative curve and of a time history, at most."""
PANEL_HEIGHT, HISTORIES_PER_LAW, FAILED_ROWS, FAILURES_NAMED = 0.32, 6, 20, 10
DISTANCE_SHOWN_MIN_M, TIME_SHOWN_MIN_S = 1e-3, 1.0
"""Floors of logarithmic axes: distances go to zero, and a start inside the settling band is settled
at once.
"""
QUANTILES = (0.5, 0.9, 0.99, 1.0)


class Law(NamedTuple):
    """A steering law: its key in the run's tables, its name in the report, and whether the paper
    proves that it converges.
    """

    key: str
    name: str
    proven: bool


LAWS = (
    Law("lyapunov", "Law (24)", True),
    Law("cascade", "Law (30)", True),
    Law("cascade_cut", "Law (30), cut at ω_max", False),
)

REFERENCES: dict[str, tuple[str, str, Style]] = {
    "circle": ("circling", "blue", "solid"),
    "oscillation": ("oscillating", "orange", "dash"),
    "random": ("randomly turning", "green", "dot"),
}
"""Kinds of reference: what they are called, and colour and style of curves about them, which are
told apart in grey, too.
"""


@dataclass(frozen=True)
class Convergence:
    """A convergence study as read from disk."""

    run: RunData

    @cached_property
    def rows(self) -> pd.DataFrame:
        """Return a row per trajectory and law that was flown; those whose process was lost are left
        out, because they show nothing about the theory.
        """
        rows = self.run.summary
        for name, known in (("law", [law.key for law in LAWS]), ("reference", list(REFERENCES))):
            if unknown := set(rows[name]) - set(known):
                raise ValueError(
                    f"{name} is {', '.join(map(str, unknown))}; known are {', '.join(known)}"
                )
        return rows[rows["outcome"] != "lost"]

    @property
    def lost(self) -> int:
        """Return the number of trajectories whose process was lost."""
        return len(self.run.summary) - len(self.rows)

    @cached_property
    def laws(self) -> list[Law]:
        """Return the laws that were flown."""
        return [law for law in LAWS if law.key in set(self.rows["law"])]

    @cached_property
    def kept(self) -> set[str]:
        """Return law and number of every trajectory whose time history was kept, as LAW_NUMBER."""
        names = (
            re.fullmatch(r"(\w+)_(\d+)", path.stem)
            for path in (self.run.path / TRAJECTORIES).glob(f"*{HISTORY_SUFFIX}")
        )
        return {f"{name[1]}_{int(name[2])}" for name in names if name}

    def of(self, law: Law, reference: str | None = None) -> pd.DataFrame:
        """Return the rows of a law, for one kind of reference or for all."""
        rows = self.rows[self.rows["law"] == law.key]
        return rows if reference is None else rows[rows["reference"] == reference]

    @property
    def proven(self) -> pd.DataFrame:
        """Return the rows of the laws that the theory covers."""
        return self.rows[self.rows["law"].isin([law.key for law in self.laws if law.proven])]

    @property
    def planned(self) -> int:
        """Return the number of trajectories under the laws that the theory covers in the complete
        run.
        """
        config = self.run.manifest["config"]
        proven = [law.key for law in LAWS if law.proven]
        return int(config["ensemble"]["trajectories"]) * sum(
            law in proven for law in config["guidance"]["laws"]
        )


def failed(rows: pd.DataFrame) -> pd.DataFrame:
    """Return those that did not converge."""
    return rows[rows["outcome"] != "converged"]


def predicted(rows: pd.DataFrame) -> "pd.Series[float]":
    """Return settling times over the predicted ones, without predictions of 0 (starts that are
    settled) and of infinity.
    """
    rows = rows[rows["settling_time_predicted_s"].between(0.0, math.inf, inclusive="neither")]
    return rows["settling_time_s"] / rows["settling_time_predicted_s"]


def convergence_content(run: RunData) -> Findings:
    """Return the findings of a convergence study."""
    data = Convergence(run)
    states = data.rows["trajectory"].nunique()
    laws = ", ".join(law.name.lower() for law in data.laws) or "none"
    charts = _settling_charts(data)
    samples = (
        f"Distance to the reference over time, of up to {HISTORIES_PER_LAW} trajectories per law"
        " that converged."
    )
    return Findings(
        flown=f"{len(data.rows):,} trajectories of the paper's kinematic vehicle, from {states:,}"
        f" initial states at random, under these laws: {laws}.",
        verdict=_verdict(data),
        picture=charts[0] if charts else None,
        sections=[
            Section(anchor="question", title="Question", blocks=_question(data)),
            Section(
                anchor="settling",
                title="How soon they settle",
                nav_title="Settling",
                blocks=[*charts, _settling_table(data)] if len(data.rows) else [],
            ),
            Section(
                anchor="samples",
                title="Sample trajectories",
                nav_title="Samples",
                blocks=_history_charts(data, "samples", samples, converged=True),
            ),
            Section(
                anchor="counterexamples",
                title="What did not converge",
                nav_title="Counter-examples",
                blocks=_failed(data),
            ),
            Section(anchor="parameters", title="Parameters", blocks=parameter_blocks(run)),
        ],
    )


def _question(data: Convergence) -> list[Block]:
    if not len(data.rows):
        return []
    manifest = data.run.manifest
    return [
        Heading("What converged means"),
        Text(
            f"A trajectory has converged once it is within {manifest['converged_distance_m']:g} m"
            " of its reference and φ, the angle from the vector z, along which the law steers, to"
            f" the vehicle's course, is within {manifest['converged_phi_rad']:g} rad: from there"
            " on, under the paper's laws, both stay small. It is settled from the moment from"
            " which its distance stays below"
            f" {manifest['config']['ensemble']['settling_band_m']:g} m."
        ),
        Heading("What the theory says"),
        Text(
            "From every initial state the distance goes to zero: under law (24) but for the"
            " singular point φ = π, towards which its command grows without limit, and under"
            " every law of the class (30). That holds for references that do turn, and for"
            " commands that are carried out as they are. Of commands that are cut at ω_max, as an"
            " aircraft flies them, the theory says nothing: they are shown, and have no part in"
            " the verdict. Trajectories can refute the theory, not prove it."
        ),
    ]


_LIMIT_CYCLE = (
    "A circle that spends nearly all of ω_max leaves almost nothing to steer with. With cut"
    " commands there is then, beside the reference, a limit cycle some hundred metres off: the"
    " command is cut most of each turn, φ swings far out and back once a turn, and on average the"
    " vehicle turns with the reference without coming nearer. Equation (31b), on which the proof"
    " for law (30) rests, does not hold for cut commands. A reserve of a few per cent of ω_max"
    " takes the cycle away; oscillations, at their peak only briefly, have converged without."
)


def _failed(data: Convergence) -> list[Block]:
    caption = (
        f"Distance to the reference over time, of up to {HISTORIES_PER_LAW} trajectories per law"
        " that did not converge."
    )
    blocks = _history_charts(data, "counterexamples", caption, converged=False)
    cut = failed(data.rows[~data.rows["law"].isin(data.proven["law"])])
    limit = 0.98 * float(data.run.manifest["config"]["guidance"]["heading_rate_max_rad_s"])
    if (
        len(cut)
        and (
            (cut["reference"] == "circle") & (cut["reference_heading_rate_max_rad_s"] > limit)
        ).all()
    ):
        blocks.insert(0, Text(_LIMIT_CYCLE))
    for law in data.laws:
        rows = failed(data.of(law))
        if not len(rows):
            continue
        heading = law.name if law.proven else f"{law.name}, of which the theory says nothing"
        if len(rows) > FAILED_ROWS:
            heading += f"; the first {FAILED_ROWS} of {len(rows):,}, all are in {COUNTEREXAMPLES}"
        first = rows.head(FAILED_ROWS).to_dict("records")
        blocks += [
            Heading(heading),
            rows_table(first, _FAILED, left_columns=2, breakable=True),
        ]
    return blocks


def _reason(row: Mapping[Any, Any]) -> str:
    outcome, message = str(row["outcome"]).replace("_", " "), str(row["message"])
    return f"{outcome}: {message}" if message else outcome


_FAILED = (
    Cell("Trajectory", "trajectory", "{:.0f}"),
    Cell("Reference", lambda row: REFERENCES[row["reference"]][0], width=1.6),
    Cell("Start distance [m]", "start_distance_m", "{:.1f}"),
    Cell("Start course [rad]", "start_course_rad", "{:.4f}"),
    Cell("Start φ [rad]", "start_phi_rad", "{:.4f}"),
    Cell("Outcome", _reason, width=5.4),
)
"""Columns of the tables of what did not converge."""


def _settling_table(data: Convergence) -> Table:
    """Return a row per law and kind of reference, and one per law for all."""
    names = {key: name for key, (name, *_) in REFERENCES.items()}
    groups = [
        {"law": law.name, "reference": name, "rows": rows}
        for law in data.laws
        for key, name in (*names.items(), (None, "all"))
        if len(rows := data.of(law, key))
    ]
    return rows_table(
        groups,
        [
            Cell("Law", "law", width=2.0),
            Cell("Reference", "reference", width=1.5),
            Cell("Trajectories", lambda of: len(of["rows"]), "{:,.0f}", 1.1),
            Cell("Converged", lambda of: converged_count(of["rows"]), "{:,.0f}"),
            *(
                Cell(f"{100.0 * share:.0f} % settled [s]", _settled_by(share), width=0.9)
                for share in QUANTILES
            ),
            Cell("Largest command [rad/s]", lambda of: command_words(of["rows"]), width=1.2),
        ],
        caption="Trajectories that converged, and their settling times, by law and kind of"
        " reference.",
        left_columns=2,
    )


def _settled_by(share: float) -> Callable[[Mapping[str, Any]], str]:
    return lambda of: settled_time(of["rows"]["settling_time_s"], share)


def converged_count(rows: pd.DataFrame) -> int:
    """Return how many converged."""
    return len(rows) - len(failed(rows))


def command_words(rows: pd.DataFrame) -> str:
    """Return the largest heading rate that was commanded [rad/s]; law (24) has no limit."""
    largest = rows["heading_rate_max_rad_s"].max()
    return number(largest, "{:,.0f}" if largest >= 100.0 else "{:.3f}")


def settled_time(times: "pd.Series[float]", fraction: float) -> str:
    """Return the time by which a fraction of all trajectories had settled, or a dash if it never
    did.
    """
    when = (
        float(np.quantile(times.fillna(np.inf), fraction, method="inverted_cdf"))
        if len(times)
        else math.inf
    )
    return f"{when:,.0f}" if math.isfinite(when) else "–"


def _verdict(data: Convergence) -> Verdict:
    """Judge a study by the laws that the theory covers, if it flew any: the theory holds if every
    trajectory under them converged.
    """
    rows, planned = data.proven, data.planned
    counter_examples = failed(rows)
    is_done = data.run.manifest.get("state") == "complete"
    all_judged = len(rows) == planned if planned else not (len(failed(data.rows)) or data.lost)
    names = {law.key: law.name for law in LAWS}
    lines = [
        f"{names[row['law']]}, trajectory {row['trajectory']}: {_reason(row)}"
        for row in counter_examples.head(FAILURES_NAMED).to_dict("records")
    ]
    if (more := len(counter_examples) - FAILURES_NAMED) > 0:
        lines.append(f"and {more:,} more, in {COUNTEREXAMPLES}")
    return Verdict(
        holds=not planned or (len(rows) > 0 and not len(counter_examples)),
        complete=is_done and all_judged,
        headline=_headline(data, is_done=is_done),
        detail=_detail(data),
        failures=lines,
        figures=_figures(data),
    )


_CONVERGED = "{converged:,} of {flown:,} trajectories converged"
_ALL_CONVERGED = "All {flown:,} trajectories converged"
_COMMANDED = "; {laws}, where ω_max is {limit:g}"
_CUT = ", with commands cut at ω_max, of which the theory says nothing"


def _headline(data: Convergence, *, is_done: bool) -> str:
    """Return the state, how many converged, and what the laws commanded for it."""
    rows = data.proven if data.planned else data.rows
    planned = data.planned or int(data.run.manifest["config"]["ensemble"]["trajectories"])
    missing = planned - len(rows)
    state = state_words(
        "trajectories", len(rows), planned, is_done=is_done and not missing, interrupted=not is_done
    )
    if not len(rows):
        return ". ".join([*state, "Nothing was flown yet"])
    done = converged_count(rows)
    words = _ALL_CONVERGED if done == len(rows) else _CONVERGED
    answer = words.format(converged=done, flown=len(rows))
    if not data.planned:
        return ". ".join([*state, answer + _CUT])
    commands = [
        f"{law.name.lower()} commanded up to {command_words(data.of(law))} rad/s"
        for law in data.laws
        if law.proven
    ]
    limit = float(data.run.manifest["config"]["guidance"]["heading_rate_max_rad_s"])
    answer += _COMMANDED.format(laws=", ".join(commands), limit=limit)
    return ". ".join([*state, answer])


_STATES = "{states:,} random initial states, each flown with {laws}."
_NOT_JUDGED = (
    "Under {law}, of which the theory says nothing, {converged:,} of {flown:,} converged; that is"
    " not judged."
)
_LOST = (
    "{lost:,} trajectories were lost with their processes, and count as not flown; --resume flies"
    " them again."
)
_RESUME = "The run is {state}; continue it with --resume."


def _detail(data: Convergence) -> str:
    state = data.run.manifest.get("state", "unfinished")
    proven = [law.name.lower() for law in data.laws if law.proven]
    others = [law for law in data.laws if not law.proven]
    sentences = [
        _NOT_JUDGED.format(
            law=law.name.lower(), converged=converged_count(rows := data.of(law)), flown=len(rows)
        )
        for law in others
    ]
    if proven:
        states = data.rows["trajectory"].nunique()
        sentences.insert(0, _STATES.format(states=states, laws=" and ".join(proven)))
    if data.lost:
        sentences.append(_LOST.format(lost=data.lost))
    if state != "complete":
        sentences.append(_RESUME.format(state=state))
    return " ".join(sentences)


def _figures(data: Convergence) -> list[Card]:
    limit = float(data.run.manifest["config"]["guidance"]["heading_rate_max_rad_s"])
    converged, commands = [], []
    for law in data.laws:
        rows = data.of(law)
        done, count = converged_count(rows), len(rows)
        judged = ("all", 0 < count == done) if law.proven else ()
        converged.append(Card(f"{law.name}: converged", f"{done:,} of {count:,}", *judged))
        name = f"{law.name}: largest command, ω_max is {limit:g} rad/s"
        commands.append(Card(name, f"{command_words(rows)} rad/s"))
    slowest = number(data.rows["settling_time_s"].max(), "{:,.0f} s")
    ratio = predicted(data.proven if data.planned else data.rows).median()
    return [
        *converged,
        *commands,
        Card("Slowest to settle", slowest),
        Card("Settling over predicted, median", number(ratio, "{:.2f}")),
    ]


def _by_law(name: str, caption: str, curves: dict[Law, list[Line]], **axes: Any) -> list[Chart]:
    """Return a chart with a panel for each law that has curves, or None; the logarithmic axis has
    the same limits in all panels.
    """
    axis = "x" if axes.get("log_x") else "y"
    limits = _around([getattr(line, axis) for lines in curves.values() for line in lines])
    axes |= {f"{axis}_range": limits}
    panels = [Panel(title=law.name, lines=lines, **axes) for law, lines in curves.items() if lines]
    return (
        [
            Chart(
                name=name,
                caption=caption,
                panels=panels,
                columns=len(panels),
                panel_height=PANEL_HEIGHT,
            )
        ]
        if panels
        else []
    )


def _line(reference: str, x: Array, y: Array) -> Line:
    name, colour, style = REFERENCES[reference]
    return Line(x=x, y=y, label=f"{name} reference", colour=colour, style=style)


def _settling_charts(data: Convergence) -> list[Chart]:
    """Return the charts of settling times, for each law under which some trajectories settled."""
    laws = [law for law in data.laws if data.of(law)["settling_time_s"].notna().any()]
    return _by_law(
        "settling",
        "Fraction of all trajectories that have settled, over time since their start; a curve that"
        " ends below 100 % leaves out those that never did.",
        {law: _settled_shares(data, law) for law in laws},
        x_label="Settling time [s]",
        y_label="Settled [%]",
        log_x=True,
        y_range=(0.0, 103.0),
    )


def _settled_shares(data: Convergence, law: Law) -> list[Line]:
    """Return for each kind of reference the share of a law's trajectories that had settled by a
    time.
    """
    curves = {
        of: cumulative(np.maximum(data.of(law, of)["settling_time_s"].to_numpy(), TIME_SHOWN_MIN_S))
        for of in REFERENCES
    }
    return [_line(of, x, 100.0 * y) for of, (x, y) in curves.items() if len(x)]


def cumulative(values: Array) -> tuple[Array, Array]:
    """Return some of the values in rising order, and for each the fraction of all values up to it.

    NaN counts among all values. The first value comes twice, first with the fraction 0, so that the
    curve rises from there.
    """
    known = np.sort(values[np.isfinite(values)])
    ranks = _thinned(len(known), CURVE_POINTS)
    fraction = (ranks + 1.0) / max(1, len(values))
    return np.append(known[:1], known[ranks]), np.append(np.zeros(len(known[:1])), fraction)


def _history_charts(data: Convergence, name: str, caption: str, *, converged: bool) -> list[Block]:
    """Return distances over time for some of the recorded trajectories: those that converged, or
    those that did not.
    """
    curves = {law: _histories(data, law, converged=converged) for law in data.laws}
    return [*_by_law(name, caption, curves, x_label="Time [s]", y_label="Distance [m]", log_y=True)]


def _histories(data: Convergence, law: Law, *, converged: bool) -> list[Line]:
    rows = data.of(law)
    kept = rows[[f"{law.key}_{trajectory}" in data.kept for trajectory in rows["trajectory"]]]
    chosen = (
        kept[(kept["outcome"] == "converged") == converged]
        .head(HISTORIES_PER_LAW)
        .sort_values("reference", kind="stable")
    )
    lines = []
    for reference, trajectory in zip(chosen["reference"], chosen["trajectory"], strict=True):
        if (history := data.run.parquet(trajectory_path(law.key, int(trajectory)))) is not None:
            known = history[np.isfinite(history["distance_m"])]
            known = known.iloc[_thinned(len(known), HISTORY_POINTS)]
            distance = np.maximum(column(known, "distance_m"), DISTANCE_SHOWN_MIN_M)
            lines.append(_line(reference, column(known, "time_s"), distance))
    return [line for line in lines if len(line.x)]


def _thinned(count: int, most: int) -> npt.NDArray[np.int64]:
    """Return at most ``most`` of ``count`` indices, the first and the last among them."""
    return np.unique(np.round(np.linspace(0, count - 1, min(most, count))).astype(np.int64))


def _around(curves: Sequence[Array]) -> tuple[float, float] | None:
    """Return the powers of ten around all values, as limits of a logarithmic axis; None without
    values.
    """
    values = np.concatenate([*curves, np.empty(0)])
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    low, high = math.floor(math.log10(known.min())), math.ceil(math.log10(known.max()))
    return 10.0**low, 10.0 ** max(high, low + 1)
