"""What trials ask for beside keeping out, and the worst that was measured."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Array
from reports.document.tables import limit
from reports.run.trials import Trial, column, interval_error

_COMPLETED = "completed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """One criterion of one trial.

    Attributes
    ----------
    key : of the configuration, without its section
    what : it is about
    limit : in words
    worst : what was measured at worst, in words
    short : flights that fell short of it, or have no such figure
    share : the worst over the limit, where both are figures; else not a number [-]
    """

    key: str
    what: str
    limit: str
    worst: str
    short: int
    share: float = float("nan")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Measure:
    """How a criterion on a figure is measured and written: by ``scale`` in ``unit``."""

    what: str
    values: Callable[[pd.DataFrame], Array]
    unit: str
    scale: float = 1.0


_MEASURES = {
    "crossing_interval_error": _Measure(
        what="Mean crossing interval off π/ω₀", values=lambda rows: np.abs(interval_error(rows)), unit="%", scale=100.0
    ),
    "tracking_error_rms_m": _Measure(
        what="Tracking error, rms after settling", values=lambda rows: column(rows, "tracking_error_rms_m"), unit="m"
    ),
    "resumes_within_periods": _Measure(
        what="Next crossing after the last manoeuvre", values=lambda rows: column(rows, "resume_periods"), unit="periods"
    ),
}


def asked(trial: Trial) -> list[Asked]:
    """Return what a trial's configuration asks for beside keeping out, in its order."""
    return [_asked(trial, key, value) for key, value in trial.criteria.items() if value not in (None, False, [])]


def _asked(trial: Trial, key: str, value: Any) -> Asked:
    if key in _MEASURES:
        return _figure(trial, key, float(value), _MEASURES[key])
    if key == "settles":
        return _settles(trial)
    if key == "modes_at_end":
        return _modes(trial, [str(mode) for mode in value])
    return Asked(key=key, what=key.replace("_", " "), limit=str(value), worst="see the flights that fell short", short=0)


def _figure(trial: Trial, key: str, value: float, measure: _Measure) -> Asked:
    measured = measure.values(trial.rows)
    known = measured[np.isfinite(measured)]
    worst = float(known.max()) if len(known) else float("nan")
    missing = len(measured) - len(known)
    words = f"{measure.scale * worst:.3g} {measure.unit}" if len(known) else "none measured"
    return Asked(
        key=key,
        what=measure.what,
        limit=f"≤ {limit(measure.scale * value)} {measure.unit}",
        worst=words + (f"; {missing} without" if missing and len(known) else ""),
        short=int(np.count_nonzero(~(measured <= value))),
        share=worst / value,
    )


def _settles(trial: Trial) -> Asked:
    settled = column(trial.rows, "settling_time_s")
    done = np.isfinite(settled) & (trial.rows["outcome"] == _COMPLETED).to_numpy()
    short = len(done) - int(np.count_nonzero(done))
    slowest = f"slowest after {np.max(settled[done]):.0f} s" if done.any() else "none did"
    crossings = int(trial.config["flight"]["crossings"])
    return Asked(
        key="settles",
        what=f"Settles and flies {crossings} crossings" if crossings else "Settles",
        limit="each flight",
        worst=slowest + (f"; {short} never" if short and done.any() else ""),
        short=short,
    )


def _modes(trial: Trial, modes: list[str]) -> Asked:
    ends = trial.rows["mode_at_end"].fillna("nothing flown")
    others = ends[~ends.isin(modes)]
    return Asked(
        key="modes_at_end",
        what="Mode at the end",
        limit=" or ".join(modes),
        worst=counted(others) if len(others) else "no other",
        short=len(others),
    )


def counted(values: "pd.Series[Any]") -> str:
    """Return how often each value occurs, in words, the most frequent first."""
    counts = values.dropna().value_counts()
    return ", ".join(f"{count} {value}" for value, count in counts.items())
