"""What instruments declare and answer: columns, figures and tables of their own, and none of the
flight's or of each other's.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from types import FunctionType
from typing import Any

import numpy as np
import numpy.typing as npt

from common.columns import described
from common.registry import PluginError
from common.run_layout import TABLES, is_file_name
from scenarios.errors import InputError
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.onboard import PlumeBelief
from scenarios.flight.record import HISTORY_COLUMNS
from scenarios.instruments.instrument import EvaluatedInstrument, Evaluation, figures_of, tables_of
from scenarios.measures.columns import FINDING_COLUMNS, FLIGHT_COLUMNS, SUMMARY_COLUMNS
from scenarios.world.own_part import asked, refuse_answer

Array = npt.NDArray[np.float64]

_FIGURE = (str, bool, int, float, np.generic, type(None))
"""What a cell of the summary may hold."""

_FLIGHT, _RUN = "the flight itself", "the run itself"


def check_instruments(named: Iterable[tuple[str, Any]]) -> None:
    """Refuse instruments that fill what the flight or another one fills: a safety figure could be
    any number.

    Parameters
    ----------
    named : the name and the class, or the object, of each instrument on board

    Raises
    ------
    InputError : one fills a column, a figure or a table that is filled already, or declares what
        are no names
    """
    columns = dict.fromkeys((*HISTORY_COLUMNS, *PlumeBelief.COLUMNS, *GuardBelief.COLUMNS), _FLIGHT)
    figures = dict.fromkeys((*SUMMARY_COLUMNS, *FINDING_COLUMNS), _FLIGHT)
    tables = dict.fromkeys(TABLES, _RUN)
    for name, instrument in named:
        who = f"instrument '{name}'"
        if isinstance(instrument, type) and _is_of_each_object(instrument):
            continue
        if not hasattr(instrument, "COLUMNS"):
            raise InputError(
                f"payload: {who} has no COLUMNS, the names of the columns of the time history that it fills; give it a tuple, as in"
                " COLUMNS = ('so2_ppb',)"
            )
        _fill(who, "column", _names(who, "COLUMNS", instrument.COLUMNS), columns)
        _fill(who, "figure", _names(who, "FIGURES", figures_of(instrument)), figures)
        given = tables_of(instrument)
        if not isinstance(given, Mapping):
            raise InputError(
                f"payload: TABLES of {who} is {given!r}; give the names of the columns of each file, by the file"
            )
        _fill(who, "table", _names(who, "TABLES", tuple(given)), tables)
        for file, of in given.items():
            if not is_file_name(file) or not file.endswith(".csv"):
                raise InputError(
                    f"payload: TABLES of {who} has '{file}'; give a file's name that ends in .csv, without a folder"
                )
            _fill(
                who,
                "column",
                _names(who, f"TABLES of '{file}'", of),
                dict.fromkeys(FLIGHT_COLUMNS, _RUN),
            )


def _is_of_each_object(kind: type) -> bool:
    """Return whether objects of a class have COLUMNS of their own, by ``__init__`` or a property:
    they are checked later.
    """
    made = vars(kind).get("__init__")
    named: tuple[str, ...] = made.__code__.co_names if isinstance(made, FunctionType) else ()
    return "COLUMNS" in named or isinstance(getattr(kind, "COLUMNS", None), property)


def _names(who: str, what: str, declared: Any) -> tuple[str, ...]:
    """Return names of columns, or of tables, that an instrument declares."""
    if isinstance(declared, str):
        raise InputError(
            f"payload: {what} of {who} is the text {declared!r}; give a tuple of names, as in ({declared!r},)"
        )
    given = tuple(declared) if isinstance(declared, Collection) else declared
    if not isinstance(given, tuple) or not all(isinstance(name, str) and name for name in given):
        raise InputError(f"payload: {what} of {who} is {given!r}; give a tuple of names")
    try:
        described(declared if isinstance(declared, Mapping) else given)
    except ValueError as error:
        raise InputError(f"payload: {what} of {who}: {error}") from None
    return given


def _fill(who: str, what: str, names: Iterable[str], filled: dict[str, str]) -> None:
    """Have an instrument fill columns, figures or tables that nothing else fills."""
    for name in names:
        if name in filled:
            raise InputError(
                f"payload: {who} fills the {what} '{name}', which {filled[name]} fills already; call it otherwise, or leave the"
                " instrument out"
            )
        filled[name] = who


def evaluated(
    name: str, instrument: EvaluatedInstrument, column: Callable[[str], Array], since: float
) -> Evaluation:
    """Return what an instrument makes of a flight, with nothing that it does not declare.

    Parameters
    ----------
    name, instrument : its name, and itself
    column, since : as of ``EvaluatedInstrument.evaluate``

    Raises
    ------
    PluginError : it failed, or returned something else
    """
    part = f"payload '{name}'"
    found = asked(
        part, "failed in evaluate()", "column and since", instrument.evaluate, column, since
    )
    if not isinstance(found, Evaluation):
        refuse_answer(
            part, "evaluate()", found, "an Evaluation of scenarios.instruments.instrument"
        )
    try:
        np.asarray(found.columns, dtype=np.float64)
    except (TypeError, ValueError):
        refuse_answer(part, "evaluate()", found.columns, "columns of numbers")
    for figure, value in found.figures.items():
        if not isinstance(value, _FIGURE):
            refuse_answer(
                part,
                f"figure '{figure}' of evaluate()",
                value,
                "a number, a truth value, text or None",
            )
    demanded = (len(column("time_s")), len(instrument.COLUMNS))
    if np.shape(found.columns) != demanded:
        raise PluginError(
            f"{part}: evaluate() returned columns of shape {np.shape(found.columns)}; it has to be {demanded}: a row for each"
            " sample of the flight, and a column for each of COLUMNS"
        )
    for what, where, declared, given in (
        ("figure", "FIGURES", figures_of(instrument), found.figures),
        ("table", "TABLES", tables_of(instrument), found.tables),
    ):
        if other := [key for key in given if key not in declared]:
            raise PluginError(
                f"{part}: evaluate() returned the {what} '{other[0]}', which {where} does not name; add it there"
            )
    return found
