"""Figures of pairs of flights: one run over the other, and how far the flights of each pair differ."""

from dataclasses import replace

import numpy as np

from reports.compare.figures import JUDGED, Difference
from reports.compare.pairs import Pairs
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import Meaning
from reports.document.panels import Group, around, points
from reports.monte_carlo.names import input_label
from reports.run.columns import Array, met
from reports.run.run_data import WITH_SECTIONS

_SHOWN = (*JUDGED, "guard_time_s", "fsc_percent", "fsc_error_percent", "fsc_uncertainty_percent")
"""Figures of the flight itself that have panels; those of users' parts follow."""

_PAIRS_MIN = 3
"""Pairs that make a picture: of fewer the table says it all."""

_FIGURES_MAX = 2
"""Figures of flights in one chart, a row of panels each: two charts fill a page."""


def pair_charts(pairs: Pairs, found: dict[str, Difference]) -> list[Chart]:
    """Return, figure by figure, one run over the first, and beside it the differences; nothing
    where no figure differs.
    """
    added = [name for name, of in found.items() if of.figure.part not in ("", *WITH_SECTIONS)]
    known = [found[name] for name in (*_SHOWN, *added) if name in found and not found[name].is_none]
    shown = [difference for difference in known if len(difference.known) >= _PAIRS_MIN]
    groups, over = _groups(pairs), _inputs(pairs)
    panels = [
        (
            _scatter(difference, groups, pairs),
            _changes(difference, *over, groups) if over else _ranked(difference, groups),
        )
        for difference in shown
    ]
    caption = (
        f"Each marker is a pair of flights: {pairs.first.title} to the right, {pairs.other.title} upwards; on the dashed line"
        f" both are equal. Then the differences {pairs.other.letter} − {pairs.first.letter}, "
        + (
            "over what was swept."
            if over
            else "in rising order: where the markers pass 50 % is their median."
        )
    )
    return [
        Chart(
            name=f"pairs{pairs.other.letter}-{i + 1}",
            caption=caption
            if i == 0
            else f"Pairs of flights by {_listed(shown[i : i + _FIGURES_MAX])}, and the differences.",
            panels=[panel for row in panels[i : i + _FIGURES_MAX] for panel in row],
            columns=2,
            panel_height=0.27,
        )
        for i in range(0, len(shown), _FIGURES_MAX)
    ]


def _listed(shown: list[Difference]) -> str:
    return " and ".join(difference.figure.title.split(",")[0].lower() for difference in shown)


def _groups(pairs: Pairs) -> list[Group]:
    worse, better = pairs.no_longer_met, pairs.newly_met
    both = met(pairs.before) & met(pairs.after)
    return [
        (~both & ~worse & ~better, "not met in either", "grey"),
        (both, "met in both", "blue"),
        (better, f"met in {pairs.other.letter} alone", "green"),
        (worse, f"met in {pairs.first.letter} alone", Meaning.LIMIT),
    ]


def _marks(x: Array, y: Array, groups: list[Group]) -> list[Line]:
    """Return markers as ``points`` does; those of flights met in one run alone are told apart in
    grey, too.
    """
    return [
        replace(line, style="diamonds") if line.label.endswith(" alone") else line
        for line in points(x, y, groups)
    ]


def _scatter(difference: Difference, groups: list[Group], pairs: Pairs) -> Panel:
    known = np.isfinite(difference.change)
    limits = around(np.concatenate([difference.before[known], difference.after[known]]))
    ends = np.array(limits or (0.0, 1.0))
    equal = Line(x=ends, y=ends, label="no difference", colour="black", style="dash")
    return Panel(
        title=difference.figure.title,
        x_label=f"In {pairs.first.letter}{difference.figure.bracket}",
        y_label=f"In {pairs.other.letter}{difference.figure.bracket}",
        lines=[equal, *_marks(difference.before, difference.after, groups)],
        x_range=limits,
        y_range=limits,
    )


def _inputs(pairs: Pairs) -> tuple[Array, str] | None:
    """Return the values of the key that the flights were swept over and its name; None unless it is
    one key of numbers.
    """
    trials = {trial.key: trial for trial in pairs.first.trials}
    flown = [trials[str(trial)] for trial in dict.fromkeys(pairs.before["trial"])]
    if len(flown) != 1 or len(flown[0].swept) != 1:
        return None
    ((key, values),) = flown[0].swept.items()
    if not all(isinstance(value, int | float) for value in values):
        return None
    x = flown[0].input(key).reindex(pairs.before["flight_id"]).to_numpy(dtype=np.float64)
    return x, "Speed ratio ν [-]" if key == "nu" else input_label(key)


def _changes(difference: Difference, x: Array, x_label: str, groups: list[Group]) -> Panel:
    zero = Line(
        x=np.array(around(x) or (0.0, 1.0)),
        y=np.zeros(2),
        label="no difference",
        colour="black",
        style="dash",
    )
    return Panel(
        title="Difference",
        x_label=x_label,
        y_label=f"Difference{difference.figure.bracket}",
        lines=[zero, *_marks(x, difference.change, groups)],
        x_range=around(x),
    )


def _ranked(difference: Difference, groups: list[Group]) -> Panel:
    """Return the differences in rising order, from the pair with the least to the one with the
    greatest.
    """
    change = difference.change
    share = np.full(len(change), np.nan)
    order = np.argsort(change)[: len(difference.known)]
    share[order] = 100.0 * (np.arange(len(order)) + 0.5) / len(order)
    zero = Line(
        x=np.zeros(2), y=np.array([0.0, 100.0]), label="no difference", colour="black", style="dash"
    )
    return Panel(
        title="Difference",
        x_label=f"Difference{difference.figure.bracket}",
        y_label="Pairs below [%]",
        lines=[zero, *_marks(change, share, groups)],
        x_range=around(np.append(difference.known, 0.0)),
        y_range=(0.0, 100.0),
    )
