"""Results of instruments: columns, figures and tables, which must not be those of the flight or of
another instrument.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from common.errors import PluginError
from common.plugins import call_plugin, check_result
from common.run_layout import TABLES
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.onboard import PlumeBelief
from scenarios.flight.record import HISTORY_COLUMNS
from scenarios.instruments.instrument import EvaluatedInstrument, Evaluation, declared_by
from scenarios.measures.columns import FINDING_COLUMNS, FLIGHT_COLUMNS, SUMMARY_COLUMNS

Array = npt.NDArray[np.float64]

_FIGURE = (str, bool, int, float, np.generic, type(None))
"""What a cell of the summary may hold."""


def check_instruments(named: Iterable[tuple[str, Any]]) -> None:
    """Refuse instruments that fill a column, a figure or a table of the flight or of another
    instrument: one could overwrite a safety figure.

    Parameters
    ----------
    named : the name and the class, or the object, of each instrument on board

    Raises
    ------
    PluginError : an instrument fills a name that is taken already, or declares something other than
        names
    """
    histories = {*HISTORY_COLUMNS, *PlumeBelief.COLUMNS, *GuardBelief.COLUMNS}
    figures, tables = {*SUMMARY_COLUMNS, *FINDING_COLUMNS}, {*TABLES}
    for name, instrument in named:
        if not hasattr(instrument, "COLUMNS"):
            raise PluginError(f"payload '{name}' has no COLUMNS, the names of the columns it fills")
        declared = declared_by(name, instrument)
        filled: list[tuple[str, Iterable[str], set[str]]] = [
            ("column", declared.histories, histories),
            ("figure", declared.figures, figures),
            ("table", declared.tables, tables),
            *(("column", columns, {*FLIGHT_COLUMNS}) for columns in declared.tables.values()),
        ]
        for what, names, known in filled:
            if twice := known & {*names}:
                raise PluginError(
                    f"payload '{name}' fills the {what} '{min(twice)}', which the flight or another"
                    " instrument fills already; call it otherwise, or leave the instrument out"
                )
            known |= {*names}


def evaluated(
    name: str, instrument: EvaluatedInstrument, column: Callable[[str], Array], since: float
) -> Evaluation:
    """Return an instrument's results of a flight; all of them have to be declared.

    Parameters
    ----------
    name, instrument : its name, and itself
    column, since : same as ``EvaluatedInstrument.evaluate``

    Raises
    ------
    PluginError : it failed, or returned something else
    """
    part, shape = f"payload '{name}'", (len(column("time_s")), len(instrument.COLUMNS))
    found = call_plugin(part, instrument.evaluate, column, since, result=_evaluation)

    def columns(given: Array) -> Array:
        if np.shape(given) != shape or np.asarray(given).dtype.kind not in "fiub":
            raise ValueError(
                f"numbers of shape {shape}: a row for each sample, a column for each of COLUMNS"
            )
        return given

    def figure(value: Any) -> Any:
        if not isinstance(value, _FIGURE):
            raise TypeError("a number, a truth value, text or None")
        return value

    declared = declared_by(name, instrument)
    undeclared = [
        *({*found.figures} - {*declared.figures}),
        *({*found.tables} - {*declared.tables}),
    ]
    if undeclared:
        raise PluginError(
            f"{part}: evaluate() returned '{undeclared[0]}', which FIGURES and TABLES do not name"
        )
    check_result(f"{part}: columns of evaluate() are", found.columns, columns)
    for called, value in found.figures.items():
        check_result(f"{part}: figure '{called}' of evaluate() is", value, figure)
    return found


def _evaluation(found: Any) -> Evaluation:
    if not isinstance(found, Evaluation):
        raise TypeError("an Evaluation of scenarios.instruments.instrument")
    return found
