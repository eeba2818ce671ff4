"""Readings of a sniffer on board, in lines of text over UDP or a serial line.

A line is a reading: ``age_s,so2_ppb,co2_ppm,no_ppb,no2_ppb``, numbers with a decimal point, an
empty cell for an unknown value, and nothing after the last known one. The age is that of the
reading when it is sent; an empty age is 0. Lines that begin otherwise, such as a header, are not
readings.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from common.columns import described
from common.run_layout import SULPHUR_TABLE
from extensions.companion.ports import Line, TextLines
from gnc.estimation.navigation import MeasuredMotion
from measurement.gases import GASES, UNITS
from measurement.rules import RULES
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from scenarios.instruments.fuel_estimate import FIGURES, TABLES, fuel_estimate
from scenarios.instruments.instrument import Array, Evaluation
from scenarios.instruments.sniffer import CO2, SnifferOnBoard
from scenarios.scenario.scenario import Scenario


def reading_line(age: float, values: Sequence[float]) -> bytes:
    """Return the line of a reading of an age [s], its values in the order of ``GASES``."""
    cells = [f"{age:.3f}", *("" if math.isnan(each) else f"{each:.3f}" for each in values)]
    return (",".join(cells) + "\n").encode()


def reading_of(line: str) -> tuple[float, list[float]] | None:
    """Return age [s] and values of a line, with NaN for missing values; None for a line that is not
    a reading.
    """
    cells = [cell.strip() for cell in line.split(",")]
    if not 2 <= len(cells) <= 1 + len(GASES):
        return None
    try:
        age, *values = [float(cell) if cell else math.nan for cell in cells]
    except ValueError:
        return None
    age = 0.0 if math.isnan(age) else age
    if not 0.0 <= age < math.inf or any(map(math.isinf, values)):
        return None
    return age, values + [math.nan] * (len(GASES) - len(values))


class ReceivedSniffer:
    """A sniffer whose readings come over a line, as ``scenarios.instruments.instrument.GasReader``.

    Parameters
    ----------
    line : on which its readings arrive
    scenario : with the instrument, and the limit of its verdict

    Attributes
    ----------
    spec : its data sheet
    unreadable : number of lines that were not readings
    """

    COLUMNS = described(
        {f"{gas}_reading_{UNITS[gas]}": "reading, held until the next one" for gas in GASES}
    )
    FIGURES = FIGURES
    TABLES = TABLES

    def __init__(self, line: Line, scenario: Scenario) -> None:
        self._lines = TextLines(line)
        self._settings: Any = scenario.payload.settings(SnifferOnBoard)
        self.spec: SnifferSpec = self._settings.spec
        self._times: list[float] = []
        self._values: list[list[float]] = []
        self._not_followed: deque[tuple[float, float]] = deque()
        self.unreadable = 0

    @property
    def limit_percent(self) -> float:
        """Limit of the verdict on the sulphur content [% m/m]."""
        limit: float = self._settings.limit_percent
        return limit

    def receive(self, time: float) -> None:
        """Take the lines that have arrived until a time since the start [s].

        Lines of a sniffer that began to send before the flight have times before it.
        """
        for line in self._lines.receive():
            self._take(time, line)

    def _take(self, time: float, line: str) -> None:
        found = reading_of(line)
        if found is None:
            self.unreadable += 1
            return
        age, values = found
        at = time - age
        if self._times and at <= self._times[-1]:
            # Readings are in the order of their times; two of one time are one.
            self.unreadable += 1
            return
        self._times.append(at)
        self._values.append(values)
        self._not_followed.append((at, values[CO2]))

    def follow(
        self,
        time: float,
        motion: MeasuredMotion,  # noqa: ARG002 - of GasReader
        sample: tuple[float, ...],  # noqa: ARG002 - of GasReader
    ) -> Sequence[tuple[float, float]]:
        """Return times [s] and CO2 [ppm] of the readings that have come by a time [s]."""
        found = []
        while self._not_followed and self._not_followed[0][0] <= time:
            at, co2 = self._not_followed.popleft()
            if not math.isnan(co2):
                found.append((at, co2))
        return found

    def readings(self, since: float) -> Readings:
        """Return the readings since a time [s]."""
        time, values = self._arrays()
        late = time >= since
        return Readings(time[late], values[late])

    def _arrays(self) -> tuple[Array, Array]:
        values = np.array(self._values, dtype=np.float64).reshape(-1, len(GASES))
        return np.array(self._times, dtype=np.float64), values

    def evaluate(self, column: Callable[[str], Array], since: float) -> Evaluation:
        """Return the readings at each sample, and the estimate of the fuel from them."""
        samples = column("time_s")
        time, values = self._arrays()
        columns = np.full((len(samples), len(GASES)), np.nan)
        if len(time):
            held = np.searchsorted(time, samples, side="right") - 1
            columns[held >= 0] = values[held[held >= 0]]
        if not len(time) or not since < samples[-1]:
            return Evaluation(columns=columns)
        known = fuel_estimate(
            self.readings(since),
            self.spec,
            limit=self.limit_percent,
            # The fuel is not known beforehand.
            expected=math.nan,
            rule=RULES.get(self._settings.rule),
        )
        figures = {"sensor": self.spec.name, "sulphur_limit_percent": self.limit_percent}
        return Evaluation(
            columns=columns,
            figures=figures | known.figures,
            tables={SULPHUR_TABLE: known.over_time},
            document=known.document,
        )
