"""The gases of the exhaust, the units of their readings, and the fuel sulphur content."""

GASES = ("so2", "co2", "no", "no2")
"""Gases in the order of every array over gases."""

PARTS = {"so2": 1e9, "co2": 1e6, "no": 1e9, "no2": 1e9}
"""Readings per mole fraction: CO2 is read in ppm, the others in ppb."""

UNITS = {"so2": "ppb", "co2": "ppm", "no": "ppb", "no2": "ppb"}
"""Units of readings, as they are printed."""

CARBON_MASS = 12.011e-3
"""Standard atomic weight [kg/mol], abridged (IUPAC 2021)."""

_OXYGEN = 15.999e-3
"""Standard atomic weight [kg/mol], abridged (IUPAC 2021)."""

_HYDROGEN = 1.008e-3
"""Standard atomic weight [kg/mol], abridged (IUPAC 2021)."""

_NITROGEN = 14.007e-3
"""Standard atomic weight [kg/mol], abridged (IUPAC 2021)."""

SULPHUR_MASS = 32.06e-3
"""Molar mass of sulphur [kg/mol] (IUPAC 2021)."""

MOLAR_MASS = {
    "so2": SULPHUR_MASS + 2.0 * _OXYGEN,
    "co2": CARBON_MASS + 2.0 * _OXYGEN,
    "no": _NITROGEN + _OXYGEN,
    "no2": _NITROGEN + 2.0 * _OXYGEN,
}
"""Molar masses [kg/mol]."""

METHANE_MASS = CARBON_MASS + 4.0 * _HYDROGEN
"""Molar mass of methane [kg/mol] (IUPAC 2021)."""

CARBON_FRACTION = 0.87
"""Carbon by mass that the published factor assumes [-]: Balzani Loov et al., AMT 7:2597 (2014)."""

CARBON_PER_CO2 = CARBON_MASS / MOLAR_MASS["co2"]
"""Carbon by mass in CO2 [-]."""

EXPECTED_PPB_PER_PPM = {"no": (18.0, 7.5), "no2": (2.0, 1.2)}
"""A ship's NO and NO2 over its CO2 where they are not measured: mean and deviation [ppb/ppm].

Assumption: NOx tiers 0 to 3 of two- and four-stroke engines emit 4 to 27 ppb/ppm; 5 to 15 % of it
is NO2, and ozone adds some.
"""

FUEL_SULPHUR_MOST = 5.0
"""Largest sulphur content of a marine fuel [% m/m]: 4.5 was the limit (MARPOL VI, reg. 14)."""

ASSUMED_LEAST = 0.0005
"""Smallest correction for assumed gases that is printed [% m/m]: half of the third decimal."""

MASS_PERCENT = "% m/m"
"""Unit of a sulphur content where it stands first; intervals and limits follow in plain %."""


def limit_words(limit_percent: float) -> str:
    """Return a limit on the sulphur content [% m/m] as printed, with at least two decimals."""
    if round(limit_percent, 2) == limit_percent:
        return f"{limit_percent:.2f} %"
    return f"{limit_percent:g} %"


def fsc_factor(carbon_fraction: float = CARBON_FRACTION) -> float:
    """Return the fuel sulphur content [% m/m] per SO2 over CO2 [ppb/ppm]: 0.2322 at 87 % carbon.

    A part per billion over a part per million is a thousandth by mole, and the content is in per
    cent: hence 0.1.

    Parameters
    ----------
    carbon_fraction : carbon by mass in the fuel [-], usually 0.85 to 0.875
    """
    return 0.1 * carbon_fraction * SULPHUR_MASS / CARBON_MASS
