"""Instruments on board: what they read goes into the time history."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from common.columns import Column, Declared, described
from common.provenance import without_folders
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
    COLUMNS : of the time history that it fills: a mapping from their names to ``Column`` of
        ``common.columns``, or to their meanings, or their names alone, which end in their units, as
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
    """What an instrument makes of a flight.

    Attributes
    ----------
    columns : values of ``COLUMNS``, shape (samples, columns)
    figures : of the flight's row in the summary
    tables : rows by file
    document : what a report shows beside all this, or none; it is written as JSON beside the time
        history
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
    empty.

    Attributes
    ----------
    COLUMNS : same as ``Instrument``
    """

    @property
    def COLUMNS(self) -> Collection[str]:  # noqa: N802 - of the class, in capitals
        """Return the columns that it fills."""

    def evaluate(self, column: Callable[[str], Array], since: float, /) -> Evaluation:
        """Return what it makes of the flight.

        Parameters
        ----------
        column : returns a column of the flight's record by name, shape (samples,)
        since : when the measurement begins: where the flight has settled; NaN if it never
            does [s]
        """


@runtime_checkable
class GasReader(Protocol):
    """An instrument that says in flight what it reads of CO2; otherwise as ``EvaluatedInstrument``.

    Attributes
    ----------
    spec : as its data sheet says
    limit_percent : sulphur content that a verdict is on [% m/m]
    """

    spec: SnifferSpec

    @property
    def limit_percent(self) -> float:
        """Limit of the verdict [% m/m]."""

    def follow(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...], /
    ) -> Sequence[tuple[float, float]]:
        """Return times [s] and CO2 [ppm] of the readings that have come; called for each row of the
        flight's record.

        Parameters are those of ``Instrument.read``.
        """

    def readings(self, since: float, /) -> Readings:
        """Return what has been read since a time [s]."""


def figures_of(instrument: Any) -> Declared:
    """Return the columns of the summary that an instrument, or a class of instruments, declares."""
    figures: Declared = getattr(instrument, "FIGURES", ())
    return figures


def tables_of(instrument: Any) -> Mapping[str, Declared]:
    """Return the columns of the tables that an instrument, or a class of instruments, declares, by
    file.
    """
    tables: Mapping[str, Declared] = getattr(instrument, "TABLES", {})
    return tables


@dataclass(frozen=True, slots=True, kw_only=True)
class Declarations:
    """What the instruments of some scenarios fill: columns that bear the instrument's name.

    Attributes
    ----------
    histories : of time histories, but those that objects alone have
    figures : of the summary
    tables : by file
    """

    histories: dict[str, Column] = field(default_factory=dict)
    figures: dict[str, Column] = field(default_factory=dict)
    tables: dict[str, dict[str, Column]] = field(default_factory=dict)


def declarations(scenarios: Iterable[Scenario]) -> Declarations:
    """Return what the instruments of scenarios fill, each instrument once.

    Raises
    ------
    PluginError : there is no such instrument
    """
    named = {
        name: part for scenario in scenarios for name, part in scenario.payload.parts().items()
    }
    found = Declarations()
    for name, instrument in named.items():
        part = without_folders(name)
        # Objects may have columns of their own: a property of a class says nothing yet.
        columns = getattr(instrument, "COLUMNS", ())
        if isinstance(columns, Collection):
            found.histories.update(described(columns, part=part))
        if hasattr(instrument, "evaluate"):
            found.figures.update(described(figures_of(instrument), part=part))
            for file, declared in tables_of(instrument).items():
                found.tables[file] = described(declared, part=part)
    return found
