"""Tables of a convergence study."""

from typing import Any

import numpy as np
import pandas as pd

from reports.convergence.data import REFERENCES, ConvergenceData, Law, failed
from reports.document.blocks import Table
from reports.document.tables import number

QUANTILES = (0.5, 0.9, 0.99, 1.0)
FAILED_ROWS = 20
"""Counter-examples of a law that are listed, at most."""


def settling_table(data: ConvergenceData) -> Table:
    """Return a row per law and kind of reference, and one per law for all."""
    rows = []
    for law in data.laws:
        kinds: list[str | None] = [*data.references, None]
        for reference in kinds:
            of = data.of(law, reference)
            if len(of):
                rows.append([
                    law.name,
                    "all" if reference is None else REFERENCES[reference][0],
                    f"{len(of):,}",
                    f"{len(of) - len(failed(of)):,}",
                    *(settled_time(of["settling_time_s"], fraction) for fraction in QUANTILES),
                    rate(of["heading_rate_max_rad_s"]),
                ])  # fmt: skip
    head = [
        "Law", "Reference", "Trajectories", "Converged", *(f"{100.0 * fraction:.0f} % settled [s]" for fraction in QUANTILES),
        "Largest command [rad/s]",
    ]  # fmt: skip
    return Table(
        caption="Trajectories that converged, and their settling times, by law and kind of reference.",
        head=head,
        rows=rows,
        widths=[2.0, 1.5, 1.1, 1.0, *[0.9] * len(QUANTILES), 1.2],
        left_columns=2,
    )


def failed_table(data: ConvergenceData, law: Law) -> Table:
    """Return the first trajectories of a law that did not converge, with their starts and reasons."""
    rows = [
        [
            f"{row['trajectory']:.0f}",
            REFERENCES[str(row["reference"])][0],
            number(row["start_distance_m"], "{:.1f}"),
            number(row["start_course_rad"], "{:.4f}"),
            number(row["start_phi_rad"], "{:.4f}"),
            reason(row),
        ]
        for _, row in failed(data.of(law)).head(FAILED_ROWS).iterrows()
    ]
    head = [
        "Trajectory",
        "Reference",
        "Start distance [m]",
        "Start course [rad]",
        "Start φ [rad]",
        "Outcome",
    ]
    return Table(
        head=head, rows=rows, widths=[1.0, 1.6, 1.0, 1.0, 1.0, 5.4], left_columns=2, breakable=True
    )


def reason(row: "pd.Series[Any]") -> str:
    """Return how a trajectory ended, in words."""
    outcome, message = str(row["outcome"]).replace("_", " "), str(row["message"])
    return f"{outcome}: {message}" if message else outcome


def rate(values: "pd.Series[float]") -> str:
    """Return the largest of some heading rates; under law (24) they have no limit."""
    largest = values.max()
    return number(largest, "{:,.0f}" if largest >= 100.0 else "{:.3f}")


def settled_time(times: "pd.Series[float]", fraction: float) -> str:
    """Return when so many of all had settled, and a dash if never."""
    if not len(times):
        return "–"
    when = float(np.quantile(times.fillna(np.inf), fraction, method="inverted_cdf"))
    return f"{when:,.0f}" if np.isfinite(when) else "–"
