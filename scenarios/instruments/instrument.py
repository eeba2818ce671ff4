"""Instruments on board; their readings go into the time history."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from common.columns import Column, described
from common.plugins import check_result
from common.provenance import without_folders
from common.run_layout import is_file_name
from gnc.estimation.navigation import MeasuredMotion
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.scenario import Scenario

Array = npt.NDArray[np.float64]

payload = PAYLOADS.register
"""Decorator that registers an instrument by a name."""


@runtime_checkable
class Instrument(Protocol):
    """An instrument that is read in flight, made fresh for each flight with its scenario and world
    and a random generator.

    Attributes
    ----------
    COLUMNS : columns of the time history that it fills: a mapping from their names to ``Column`` of
        ``common.columns`` or to their meanings, or only their names, which end in their units, as
        in ``so2_ppb``. Reports of a flight have a panel for each
    """

    @property
    def COLUMNS(self) -> Collection[str]:  # noqa: N802 - of the class, in capitals
        """Return the columns that it fills."""

    def read(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...], /
    ) -> tuple[float, ...]:
        """Return a value for each column.

        Parameters
        ----------
        time : [s]
        motion : true north, east [m], their rates [m/s], heading rate [rad/s]
        sample : ``scenarios.vehicles.vehicle.SAMPLE_COLUMNS``
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluation:
    """An instrument's results of a flight.

    Attributes
    ----------
    columns : values of ``COLUMNS``, shape (samples, columns)
    figures : of the flight's row in the summary
    tables : rows by file
    document : further data for the report, or None; it is written as JSON beside the time history
    """

    columns: Array
    figures: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, Sequence[dict[str, Any]]] = field(default_factory=dict)
    document: Mapping[str, Any] | None = None


@runtime_checkable
class EvaluatedInstrument(Protocol):
    """An instrument whose readings are computed after the flight, all at once; otherwise as
    ``Instrument``.

    It may have ``FIGURES``, the columns of the summary that it fills, and ``TABLES``, the columns
    of the tables that it fills, by file, beside those that name the flight. Both are declared as
    ``COLUMNS`` are; reports and comparisons show the figures. A figure that it does not return is
    empty. If a key of its settings is a table that adds columns, ``FILLED_BY`` has a function under
    that key, which returns the ``Declarations`` of the added columns.

    Attributes
    ----------
    COLUMNS : same as ``Instrument``
    """

    @property
    def COLUMNS(self) -> Collection[str]:  # noqa: N802 - of the class, in capitals
        """Return the columns that it fills."""

    def evaluate(self, column: Callable[[str], Array], since: float, /) -> Evaluation:
        """Return its results of the flight.

        Parameters
        ----------
        column : returns a column of the flight's record by name, shape (samples,)
        since : begin of the measurement, when the flight has settled; NaN if it never settles [s]
        """


@runtime_checkable
class GasReader(Protocol):
    """An instrument whose readings of CO2 are used in flight; otherwise as ``EvaluatedInstrument``.

    Attributes
    ----------
    spec : its data sheet
    limit_percent : limit of the sulphur content for the verdict [% m/m]
    """

    spec: SnifferSpec

    @property
    def limit_percent(self) -> float:
        """Limit of the verdict [% m/m]."""

    def follow(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...], /
    ) -> Sequence[tuple[float, float]]:
        """Return times [s] and CO2 [ppm] of the readings so far; called for each row of the
        flight's record.

        Parameters are those of ``Instrument.read``.
        """

    def readings(self, since: float, /) -> Readings:
        """Return the readings since a time [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Declarations:
    """Declared columns of the instruments of some scenarios; each column has its instrument's name
    as ``part``.

    Attributes
    ----------
    histories : columns of time histories, without those that only objects declare
    figures : of the summary
    tables : by file
    """

    histories: dict[str, Column] = field(default_factory=dict)
    figures: dict[str, Column] = field(default_factory=dict)
    tables: dict[str, dict[str, Column]] = field(default_factory=dict)


def declarations(scenarios: Iterable[Scenario]) -> Declarations:
    """Return the declared columns of the instruments of scenarios, each instrument once.

    Raises
    ------
    PluginError : there is no such instrument
    """
    named, further = {}, {}
    for scenario in scenarios:
        given = scenario.payload.model_extra or {}
        for name, part in scenario.payload.parts().items():
            named[name] = part
            for key, fills in getattr(part, "FILLED_BY", {}).items():
                if given.get(key):
                    further[name, key, tuple(given[key])] = fills(given[key])
    found = Declarations()
    for of in (*(declared_by(name, part) for name, part in named.items()), *further.values()):
        found.histories.update(of.histories)
        found.figures.update(of.figures)
        found.tables.update(of.tables)
    return found


def declared_by(name: str, instrument: Any) -> Declarations:
    """Return the columns that an instrument, or a class of instruments, declares.

    Raises
    ------
    PluginError : it declares something other than columns, or a table whose name cannot be a file
        of the run
    """
    part = without_folders(name)

    def columns(declared: Any) -> dict[str, Column]:
        if isinstance(declared, str) or not isinstance(declared, Collection):
            raise TypeError("a tuple of names, or a mapping from each")
        if not all(isinstance(column, str) and column for column in declared):
            raise TypeError("names, each of them text")
        try:
            return described(declared, part=part)
        except ValueError as error:
            raise ValueError(f"names, each with its meaning or a Column ({error})") from None

    def tables(declared: Any) -> dict[str, dict[str, Column]]:
        if not isinstance(declared, Mapping):
            raise TypeError("a mapping from files to the names of their columns")
        for file in declared:
            if not is_file_name(file) or not file.endswith(".csv"):
                raise ValueError(f"names of files that end in .csv, without a folder; not {file!r}")
        return {file: columns(of) for file, of in declared.items()}

    # A property has columns only for an object, not for the class.
    declared = {
        what: {} if isinstance(of := getattr(instrument, what, {}), property) else of
        for what in ("COLUMNS", "FIGURES", "TABLES")
    }
    what = f"payload '{name}':"
    return Declarations(
        histories=check_result(f"{what} COLUMNS is", declared["COLUMNS"], columns),
        figures=check_result(f"{what} FIGURES is", declared["FIGURES"], columns),
        tables=check_result(f"{what} TABLES is", declared["TABLES"], tables),
    )
