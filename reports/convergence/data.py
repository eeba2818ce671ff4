"""Trajectories of a convergence study: which laws flew them, about which references, and how they
ended.
"""

import math
import re
from dataclasses import dataclass

import pandas as pd

from common.run_layout import HISTORY_SUFFIX, TRAJECTORIES
from reports.document.chart import Style
from reports.run.run_data import RunData


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """A steering law of the study.

    Attributes
    ----------
    key : in the run's tables
    name : in the report
    proven : the paper proves that it converges
    """

    key: str
    name: str
    proven: bool


LAWS = (
    Law(key="lyapunov", name="Law (24)", proven=True),
    Law(key="cascade", name="Law (30)", proven=True),
    Law(key="cascade_cut", name="Law (30), cut at ω_max", proven=False),
)

REFERENCES: dict[str, tuple[str, str, Style]] = {
    "circle": ("circling", "blue", "solid"),
    "oscillation": ("oscillating", "orange", "dash"),
    "random": ("randomly turning", "green", "dot"),
}
"""Kinds of reference: what they are called, and colour and style of curves about them, which are
told apart in grey, too.
"""

CONVERGED = "converged"
"""What a trajectory that did is called."""

_LOST = "lost"
"""What one is called whose process was lost: it was not flown, and says nothing of the theory;
``--resume`` flies it again.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvergenceData:
    """A convergence study.

    Attributes
    ----------
    run : as read from disk
    rows : a row per trajectory and law that was flown
    lost : number of those whose process was lost
    laws : those flown
    references : kinds of reference about which they were
    kept : law and number of every trajectory whose time history was kept
    """

    run: RunData
    rows: pd.DataFrame
    lost: int
    laws: list[Law]
    references: list[str]
    kept: set[tuple[str, int]]

    def of(self, law: Law, reference: str | None = None) -> pd.DataFrame:
        """Return the rows of a law, about one kind of reference or all."""
        rows = self.rows[self.rows["law"] == law.key]
        return rows if reference is None else rows[rows["reference"] == reference]

    def proven(self) -> pd.DataFrame:
        """Return the rows of the laws that the theory is about."""
        return self.rows[self.rows["law"].isin([law.key for law in self.laws if law.proven])]

    @property
    def planned(self) -> int:
        """Trajectories under the laws that the theory is about, once the run is complete."""
        config = self.run.manifest["config"]
        proven = [law.key for law in LAWS if law.proven]
        return int(config["ensemble"]["trajectories"]) * sum(
            law in proven for law in config["guidance"]["laws"]
        )


def read_convergence(run: RunData) -> ConvergenceData:
    """Return the study of a run.

    Raises
    ------
    ValueError : it has a law or a kind of reference that this report does not know
    """
    rows = run.summary
    for column, known in (("law", [law.key for law in LAWS]), ("reference", list(REFERENCES))):
        unknown = set(rows[column]) - set(known)
        if unknown:
            raise ValueError(
                f"{column} is {', '.join(map(str, unknown))}; known are {', '.join(known)}"
            )
    lost = rows["outcome"] == _LOST
    rows = rows[~lost]
    names = (
        re.fullmatch(r"(\w+)_(\d+)", path.stem)
        for path in (run.path / TRAJECTORIES).glob(f"*{HISTORY_SUFFIX}")
    )
    return ConvergenceData(
        run=run,
        rows=rows,
        lost=int(lost.sum()),
        laws=[law for law in LAWS if law.key in set(rows["law"])],
        references=[reference for reference in REFERENCES if reference in set(rows["reference"])],
        kept={(name[1], int(name[2])) for name in names if name},
    )


def predicted(rows: pd.DataFrame) -> pd.DataFrame:
    """Return those of which a settling time is predicted: neither 0, of a start where it is
    settled, nor infinite.
    """
    times = rows["settling_time_predicted_s"]
    return rows[(times > 0.0) & (times < math.inf)]


def failed(rows: pd.DataFrame) -> pd.DataFrame:
    """Return those that did not converge."""
    return rows[rows["outcome"] != CONVERGED]
