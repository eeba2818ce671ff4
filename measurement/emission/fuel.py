"""Fuels: how much sulphur and carbon they hold, and what a perfect instrument reads of them."""

from dataclasses import dataclass

from measurement.emission.presets import preset
from measurement.errors import MeasurementError
from measurement.gases import CARBON_FRACTION, CARBON_PER_CO2, SULPHUR_MASS

_FILE = "fuels.toml"

SULPHUR_AS_SO2 = 0.97753
"""Sulphur of the fuel that leaves as SO2 [-], the rest as sulphate: IMO GHG4, eq. 15, as USEPA
Marine_Emissions_Tools has it.

The literature spans losses of 1 to 19 %.
"""

SULPHUR_MAX_PERCENT = 5.0
"""Largest sulphur content that is taken for a fuel's [% m/m]; MARPOL's limit was 4.5 before 2012.
"""


@dataclass(frozen=True, kw_only=True)
class Fuel:
    """A fuel.

    Attributes
    ----------
    name, title : what it is called, short and in words
    residual : whether it is a residual fuel; the engine needs more of it and makes more NOx
    co2_per_fuel : CO2 by mass of fuel [kg/kg], of which the carbon fraction follows
    sulphur_percent : FSC, sulphur by mass [% m/m], 0 to 5

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    name: str
    title: str
    residual: bool
    co2_per_fuel: float
    sulphur_percent: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.sulphur_percent <= SULPHUR_MAX_PERCENT:
            raise MeasurementError(
                f"FSC of {self.name} is {self.sulphur_percent:g} % m/m; give 0 to {SULPHUR_MAX_PERCENT:g}, in per cent"
            )
        if not 0.5 <= self.carbon_fraction <= 1.0:
            raise MeasurementError(
                f"CO2 of {self.name} is {self.co2_per_fuel:g} kg/kg, carbon {self.carbon_fraction:.2f} of its mass; "
                "give 1.9 to 3.6 kg/kg, for fuel oils 3.1 to 3.2"
            )

    @property
    def carbon_fraction(self) -> float:
        """Carbon by mass [-]: 0.8750 for gas oil, 0.8499 for residual fuels."""
        return self.co2_per_fuel * CARBON_PER_CO2

    @property
    def so2_per_fuel(self) -> float:
        """SO2 per fuel [mol/kg]: 19.55 g/kg per per cent of sulphur."""
        return SULPHUR_AS_SO2 * self.sulphur_percent / 100.0 / SULPHUR_MASS


def fuel_preset(name: str, sulphur_percent: float | None = None) -> Fuel:
    """Return the fuel ``name``, with its usual sulphur content or with ``sulphur_percent`` [% m/m].

    Raises
    ------
    MeasurementError : the name is not known, or the content not within 0 to 5
    """
    fields = preset(_FILE, "fuel", name)
    return Fuel(
        name=name,
        **fields if sulphur_percent is None else {**fields, "sulphur_percent": sulphur_percent},
    )


def expected_fsc(fuel: Fuel) -> float:
    """Return the FSC [% m/m] that a perfect instrument reads: without the sulphate, and with the
    carbon of ``CARBON_FRACTION``.

    Gas oil of 0.1000 reads 0.0972, residual fuel of 0.5000 reads 0.5003: there the two errors
    cancel. An estimate is judged against this; what is between it and the fuel's own is a bias of
    the method.
    """
    return fuel.sulphur_percent * SULPHUR_AS_SO2 * CARBON_FRACTION / fuel.carbon_fraction
