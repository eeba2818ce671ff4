"""The gases and particles that are compared with CO2, and what their ratio to it means.

Of a kilogram of fuel with the carbon w, w/0.012011 mol of carbon leave as CO2 and, for a gas that
holds carbon itself, in that gas. With the ratio r of a gas to CO2, the emission per fuel is

    r M w / (0.012011 (1 + n r))                                                         (1)

where M is the mass that counts per mole, and n the carbon atoms of a molecule. Carbon that leaves
as CO, soot or other hydrocarbons is neglected: some per mille (Balzani Loov et al., AMT 7:2597,
2014, for ships' diesel engines). Particles are counted or weighed per volume of air: the volume of
a mole of air takes the place of M.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from measurement.errors import MeasurementError, check_keys, check_range, number
from measurement.gases import (
    CARBON_FRACTION,
    CARBON_MASS,
    FUEL_SULPHUR_MOST,
    MASS_PERCENT,
    METHANE_MASS,
    MOLAR_MASS,
    SULPHUR_MASS,
    UNITS,
)

PER_FUEL_PERCENT, PER_FUEL_G, PER_FUEL_1E15 = "% of the fuel", "g/kg", "10^15/kg"
"""Units of an emission per fuel."""

PER_ENERGY = "g/kWh"
"""Unit of an emission per work of the engine's shaft."""

SLOT = "so2"
"""Gas whose place another gas takes in readings and fit."""

_AMOUNT = {"ppb": 1e-3, "ng/m3": 1e-6, "1/cm3": 1e12}
"""What 1 of a reading's unit is over 1 ppm of CO2, in mol, kg or particles: per mole of CO2 for
"ppb"; the others are per mole of CO2 and per molar volume of air [m3/mol]."""

_RESULT = {MASS_PERCENT: 100.0, PER_FUEL_PERCENT: 100.0, PER_FUEL_G: 1e3, PER_FUEL_1E15: 1e-15}
"""A unit of results per kg/kg, or per particle and kg."""

_GAS_CONSTANT = 8.314462618
"""[J/(mol K)]"""

_OWN_KEYS = ("carbon_atoms", "figure", "molar_mass_g_mol", "most", "result", "title", "unit")
"""Keys of a gas in a configuration."""


@dataclass(frozen=True, kw_only=True)
class Species:
    """A gas, or particles, and its constants.

    Attributes
    ----------
    name, title : in columns and configurations, and in words
    figure : what the ratio to CO2 shows, in words
    unit : of readings: ppb, ng/m3 or 1/cm3
    result : unit of the figure, per fuel
    mass : that counts, per mole [kg/mol]; None where readings are per volume of air
    carbon_atoms : of a molecule
    carbon : by mass in the fuel that ships with this gas burn, unless it is stated [-]
    most : largest figure that can be [result]
    digits : decimals of the figure as printed
    judged : whether it has a limit
    per_energy : whether it becomes an emission per kWh where the engine is known
    source : of its constants, and the year
    columns : words before a unit that name its column, in lower case
    step : what the fit counts as 1, so that its numbers are of the size of SO2's [unit]
    """

    name: str
    title: str
    figure: str
    unit: str
    result: str
    mass: float | None
    carbon_atoms: int = 0
    carbon: float = CARBON_FRACTION
    most: float
    digits: int = 2
    judged: bool = False
    per_energy: bool = False
    source: str
    columns: tuple[str, ...] = ()
    step: float = 1.0

    @property
    def slope_unit(self) -> str:
        """Unit of the ratio to CO2."""
        return f"{self.unit} per ppm"

    def factor(self, carbon: float, air: tuple[float, float]) -> float:
        """Return the figure per small ratio to CO2 [result per unit/ppm].

        Parameters
        ----------
        carbon : by mass in the fuel [-]
        air : temperature [deg C] and pressure [hPa] of the air that masses and numbers of
            particles are in; of no effect on gases
        """
        temperature_c, pressure_hpa = air
        counted = self.mass
        if counted is None:
            counted = _GAS_CONSTANT * (temperature_c + 273.15) / (100.0 * pressure_hpa)
        return _AMOUNT[self.unit] * _RESULT[self.result] * carbon * counted / CARBON_MASS

    def per_fuel(self, factor: float, slope: float) -> tuple[float, float]:
        """Return the figure of a slope, and its derivative by the slope: (1).

        Parameters
        ----------
        factor : of ``factor``
        slope : [unit/ppm]
        """
        escaped = 1.0 + self.carbon_atoms * _AMOUNT["ppb"] * slope
        return factor * slope / escaped, factor / escaped**2

    def slope(self, factor: float, figure: float) -> float:
        """Return the ratio to CO2 of a figure [unit/ppm]: (1), solved for r.

        Parameters
        ----------
        factor : of ``factor``
        figure : [result]
        """
        return figure / (factor - self.carbon_atoms * _AMOUNT["ppb"] * figure)


SPECIES = {
    species.name: species
    for species in (
        Species(
            name="so2",
            title="SO2",
            figure="fuel sulphur content",
            unit=UNITS["so2"],
            result=MASS_PERCENT,
            mass=SULPHUR_MASS,  # of the sulphur in it
            most=FUEL_SULPHUR_MOST,
            digits=3,
            judged=True,
            source="atomic weights, IUPAC 2021; limits, MARPOL Annex VI, regulation 14, 2008",
            columns=("so2",),
        ),
        Species(
            name="nox",
            title="NOx",
            figure="nitrogen oxides, as NO2",
            unit="ppb",
            result=PER_FUEL_G,
            mass=MOLAR_MASS["no2"],  # regulation 13 counts NOx as NO2
            # 25 g/kWh with 150 g/kWh of fuel: more than any engine that was found.
            most=170.0,
            judged=True,
            per_energy=True,
            source="atomic weights, IUPAC 2021; limits, MARPOL Annex VI, regulation 13, 2008",
            columns=("nox",),
        ),
        Species(
            name="ch4",
            title="CH4",
            figure="methane slip",
            unit="ppb",
            result=PER_FUEL_PERCENT,
            mass=METHANE_MASS,
            carbon_atoms=1,
            # That of methane alone is 0.7487, by these atomic weights.
            carbon=0.75,
            most=30.0,
            source="atomic weights, IUPAC 2021; the fuel is taken as methane with a little ethane",
            columns=("ch4", "methane"),
        ),
        Species(
            name="bc",
            title="black carbon",
            figure="black carbon",
            unit="ng/m3",
            result=PER_FUEL_G,
            mass=None,
            most=20.0,
            digits=3,
            source="ideal gas at the stated temperature and pressure; by definition",
            columns=("bc", "black carbon", "ebc"),
        ),
        Species(
            name="pn",
            title="particle number",
            figure="particle number",
            unit="1/cm3",
            result=PER_FUEL_1E15,
            mass=None,
            most=1000.0,
            digits=1,
            source="ideal gas at the stated temperature and pressure; by definition",
            columns=("pn", "particle number", "particles", "cn"),
            step=1000.0,
        ),
    )
}
"""Gases by name. ``most`` are assumptions that catch a wrong unit."""


def species_of(name: str, given: Mapping[str, Any]) -> Species:
    """Return a gas with the constants of a configuration's table.

    Raises
    ------
    MeasurementError : a constant is missing, or is not of its kind or range
    """
    where = f"gases.{name}"
    check_keys(given, _OWN_KEYS, f"[{where}]")
    words = {key: given.get(key, "") for key in ("figure", "result", "title", "unit")}
    for key, text in words.items():
        if not isinstance(text, str) or not text.isprintable():
            raise MeasurementError(f"{where}.{key} is {text!r}; give a text of one line")
    unit, result = words["unit"] or "ppb", words["result"] or PER_FUEL_G
    for key, value, known in (
        ("unit", unit, _AMOUNT),
        ("result", result, [of for of in _RESULT if of != MASS_PERCENT]),
    ):
        if value not in known:
            raise MeasurementError(f"{where}.{key} is {value!r}; it must be {', '.join(known)}")
    mass = None
    if unit == "ppb":
        if "molar_mass_g_mol" not in given:
            raise MeasurementError(
                f"gas '{name}' has no molar_mass_g_mol; give it in [{where}], as 28.01 of CO"
            )
        mass = number(given["molar_mass_g_mol"], "molar_mass_g_mol", where) / 1000.0
        check_range(f"{where}.molar_mass_g_mol", 1000.0 * mass, 1.0, 1000.0, " g/mol")
    atoms = number(given.get("carbon_atoms", 0), "carbon_atoms", where)
    if atoms not in range(20):
        raise MeasurementError(f"{where}.carbon_atoms is {atoms:g}; give a whole number, 0 to 19")
    most = number(given.get("most", 1e3), "most", where)
    check_range(f"{where}.most", most, 1e-9, 1e9)
    return Species(
        name=name,
        title=words["title"] or name.upper(),
        figure=words["figure"] or words["title"] or name.upper(),
        unit=unit,
        result=result,
        mass=mass,
        carbon_atoms=int(atoms),
        most=most,
        digits=3,
        source="the configuration",
        columns=(name.lower(),),
    )
