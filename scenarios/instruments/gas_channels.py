"""Channels of a sniffer for gases and particles that a ship emits beside SO2, CO2 and NOx.

They disperse with the exhaust: the excess over clean air is the ship's ratio to CO2 times the
excess of CO2. Each channel is read, and its figure estimated, by the code for SO2, as in the
analysis of a log.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from common.columns import Column, described
from measurement.errors import MeasurementError, check_keys
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec, channel_of
from measurement.species import PER_FUEL_1E15, PER_FUEL_G, PER_FUEL_PERCENT, SLOT, SPECIES, Species
from scenarios.instruments.failing_sniffer import FailingSniffer
from scenarios.instruments.instrument import Declarations
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.world import GAS_KEYS
from scenarios.world.faults import TimedFault
from scenarios.world.plume import air_of_particles, fuel_of

Array = npt.NDArray[np.float64]

CLEAN_AIR = {"ch4": 1900.0, "bc": 50.0, "pn": 400.0}
"""In clean air over the sea, in the units of readings. CH4: the mean of NOAA's marine sites passed
1900 ppb in 2021; the others are assumptions. A level that does not vary has no part in an estimate.
"""

_SLOT = GASES.index(SLOT)
"""Column in which another gas is read."""

_ENDS = {
    "ppb": "ppb",
    "ng/m3": "ngm3",
    "1/cm3": "cm3",
    PER_FUEL_PERCENT: "percent",
    PER_FUEL_G: "g_kg",
    PER_FUEL_1E15: "1e15_kg",
}
"""Ends of the names of columns, by their units."""


def channels_of(given: Mapping[str, Any]) -> dict[str, Channel]:
    """Return the channels in a table by gas, in the order of ``GAS_KEYS``.

    Raises
    ------
    MeasurementError : a gas or key is unknown, a value has a wrong type or is out of range, or
        response, delay or noise are missing
    """
    check_keys(given, tuple(GAS_KEYS), "channels")
    found = {gas: channel_of(gas, given[gas]) for gas in GAS_KEYS if gas in given}
    for gas, channel in found.items():
        if not math.isfinite(channel.t90_sd + channel.delay_sd_s + channel.noise):
            raise MeasurementError(
                f"channel '{gas}' has no t90_s, delay_s or noise; give all three to fly it"
            )
    return found


def gas_columns(gases: Iterable[str]) -> Declarations:
    """Return the columns and figures that the channels of some gases fill."""
    found = Declarations()
    for gas in gases:
        species = SPECIES[gas]
        title, end = species.title, _ENDS[species.result]

        def of(meaning: str, heading: str, species: Species = species) -> Column:
            unit = species.result
            return Column(meaning, title=heading, unit=unit, digits=species.digits + 1)

        unit = species.unit
        truth, reading = _names(species)
        found.histories.update(
            described(
                {
                    truth: Column(f"true {title} along the path", unit=unit),
                    reading: Column(f"reading of {title}, held until the next one", unit=unit),
                }
            )
        )
        figure = f"{species.figure[0].upper()}{species.figure[1:]}"
        found.figures.update(
            described(
                {
                    f"{gas}_emitted_{end}": of(
                        f"{species.figure} of the ship, per fuel", f"{figure} of the ship"
                    ),
                    f"{gas}_{end}": of(
                        f"{species.figure} by the ratio of {title} to CO2", f"{figure} found"
                    ),
                    f"{gas}_uncertainty_{end}": of(
                        "its standard uncertainty", f"Uncertainty of {species.figure}, 1σ"
                    ),
                    f"{gas}_low_{end}": of("lower end of its 95 % interval", f"{figure}, low"),
                    f"{gas}_high_{end}": of("upper end of its 95 % interval", f"{figure}, high"),
                    f"{gas}_quality": Column("class A, B or C of the result", kind="text"),
                    f"{gas}_reason": Column("reason for a class other than A", kind="text"),
                }
            )
        )
    return found


def _names(species: Species) -> tuple[str, str]:
    """Return the columns with the true and the read values of a gas."""
    end = _ENDS[species.unit]
    return f"{species.name}_{end}", f"{species.name}_reading_{end}"


@dataclass(frozen=True, kw_only=True)
class _GasChannel:
    """A channel in flight: its data sheet, its sampled properties, the air that it met, and its
    readings.
    """

    species: Species
    stated: Channel
    sniffer: FailingSniffer
    met: list[Array] = field(default_factory=list)
    read: list[Array] = field(default_factory=list)


class GasChannels:
    """The channels of a flight.

    Parameters
    ----------
    channels : of ``channels_of``
    ratios : of ``Exhaust``
    scenario : scenario with the fuel and the air
    spec : the sniffer to which the channels belong
    exact : whether the channels are exactly as on their data sheets
    fault : of the sniffer
    generator : of the sniffer; not used without channels
    time_step : between samples of the air [s]
    """

    def __init__(
        self,
        channels: Mapping[str, Channel],
        ratios: Mapping[str, float],
        scenario: Scenario,
        spec: SnifferSpec,
        *,
        exact: bool,
        fault: TimedFault,
        generator: np.random.Generator,
        time_step: float,
    ) -> None:
        self._spec, self._ratios = spec, ratios
        self._emitted = scenario.emission.emitted
        self._carbon = fuel_of(scenario).carbon_fraction
        self._air = air_of_particles(scenario)
        self._each = []
        for gas, channel in channels.items():
            # Each channel has its own random numbers, so that readings do not depend on the parts
            # in which the air is given.
            own = np.random.default_rng(int(generator.integers(2**63)))
            alone = SnifferSpec(name=gas, title=gas, rate_hz=spec.rate_hz, channels=(channel,))
            sniffer = FailingSniffer(
                alone if exact else alone.drawn(own), fault, generator=own, time_step=time_step
            )
            self._each.append(_GasChannel(species=SPECIES[gas], stated=channel, sniffer=sniffer))

    def advance(self, excess_co2: Array, pressure: Array) -> None:
        """Read further samples.

        Parameters
        ----------
        excess_co2 : of the measured ship, shape (n,) [ppm]
        pressure : see ``AirSamples``
        """
        for each in self._each:
            gas = each.species.name
            met = CLEAN_AIR[gas] + self._ratios[gas] * excess_co2
            air = np.zeros((len(met), len(GASES)))
            air[:, _SLOT] = met
            each.met.append(met)
            each.read.append(each.sniffer.advance(air, pressure).values[:, _SLOT])

    def columns(self, time: Array, at: Array, held: npt.NDArray[np.intp]) -> list[Array]:
        """Return truth and readings of each gas in the rows of a record.

        Parameters
        ----------
        time : of the rows, shape (m,) [s]
        at : of the samples, shape (n,) [s]
        held : index of the reading that each row shows, shape (m,)
        """
        found = []
        for each in self._each:
            met, read = np.concatenate(each.met), np.concatenate(each.read)
            found += [np.interp(time, at, met), read[held]]
        return found

    def estimates(
        self, readings: Readings, kept: npt.NDArray[np.bool_]
    ) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        """Return figures of the summary, and records for a report.

        The carbon of the fuel is taken as known, as a log's configuration would state it.

        Parameters
        ----------
        readings : readings of the sniffer that the estimate of the fuel uses
        kept : mask of the used readings among all readings
        """
        from measurement.estimate.gas import estimate_gas, placed

        figures: dict[str, Any] = {}
        records = []
        for each in self._each:
            species = each.species
            gas, end = species.name, _ENDS[species.result]
            figures[f"{gas}_emitted_{end}"] = self._emitted[gas]
            column = np.concatenate(each.read)[kept]
            try:
                found = estimate_gas(
                    placed(species, each.stated, column, readings, self._spec),
                    carbon=self._carbon,
                    air=self._air,
                )
            except MeasurementError as error:
                figures |= {f"{gas}_quality": "C", f"{gas}_reason": str(error)}
                continue
            figures |= {
                f"{gas}_{end}": found.value,
                f"{gas}_uncertainty_{end}": found.total,
                f"{gas}_low_{end}": found.low,
                f"{gas}_high_{end}": found.high,
                f"{gas}_quality": found.quality,
                f"{gas}_reason": "; ".join(found.quality_reasons),
            }
            records.append(found.record())
        return figures, records
