"""Constants of gases and stages of NOx: worked by hand, with their sources."""

from dataclasses import replace
from datetime import date

import pytest

from measurement.emission import consumption_with_load
from measurement.engine import Engine, limit_of
from measurement.errors import MeasurementError
from measurement.gases import fsc_factor
from measurement.species import SPECIES, species_of

AIR = (20.0, 1013.25)
MASS = {"molar_mass_g_mol": 44.0}


@pytest.mark.parametrize("slip", [0.01, 0.064, 0.10])
def test_methane_slip_keeps_the_balance_of_carbon(slip):
    # 1 kg of fuel with 0.75 of carbon; what does not slip burns to CO2.
    escaped = slip / 0.016043
    burnt = 0.75 / 0.012011 - escaped
    methane = SPECIES["ch4"]
    found, _ = methane.per_fuel(methane.factor(0.75, AIR), 1000.0 * escaped / burnt)
    assert found == pytest.approx(100.0 * slip, rel=1e-4)
    # What a ship emits is the same the other way round.
    ratio = methane.slope(methane.factor(0.75, AIR), 100.0 * slip)
    assert ratio == pytest.approx(1000.0 * escaped / burnt, rel=1e-4)


def test_sulphur_nox_and_particles_per_fuel_are_those_of_a_hand_calculation():
    # Section 4.1 of the specification, four digits; 0.232 in Balzani Loov et al., AMT 7:2597
    # (2014).
    for carbon, factor in ((0.87, 0.2322), (0.85, 0.2268), (0.875, 0.2336)):
        assert fsc_factor(carbon) == SPECIES["so2"].factor(carbon, AIR)
        assert fsc_factor(carbon) == pytest.approx(factor, abs=1e-4)
    # 20 ppb/ppm: 0.020 mol of NO2 per mol of CO2; 870 g/kg of carbon are 72.43 mol.
    grams, _ = SPECIES["nox"].per_fuel(SPECIES["nox"].factor(0.87, AIR), 20.0)
    assert grams == pytest.approx(0.020 * 46.005 * 870.0 / 12.011, rel=1e-4)
    # A mole of air has 24.055 l at 20 deg C; a kilogram of fuel makes 72.43 mol of CO2, which at 1
    # ppm are in 1.7424e6 m3 of air.
    volume = 72.433 * 0.024055 * 1e6
    number, carbon = SPECIES["pn"], SPECIES["bc"]
    counted, _ = number.per_fuel(number.factor(0.87, AIR), 5840.0)
    weighed, _ = carbon.per_fuel(carbon.factor(0.87, AIR), 117.0)
    assert counted == pytest.approx(5840e6 * volume / 1e15, rel=1e-3)
    assert weighed == pytest.approx(117e-9 * volume, rel=1e-3)


@pytest.mark.parametrize(
    ("keel", "rpm", "area", "stage", "cycle", "at_load"),
    [
        ("2000-01-01", 100.0, "", "I", 17.0, 17.0),
        ("2010-12-31", 720.0, "", "I", 45.0 * 720.0**-0.2, 45.0 * 720.0**-0.2),
        ("2011-01-01", 129.9, "", "II", 14.4, 14.4),
        ("2020-06-01", 500.0, "north_sea", "II", 44.0 * 500.0**-0.23, 44.0 * 500.0**-0.23),
        ("2021-01-01", 500.0, "north_sea", "III", 9.0 * 500.0**-0.2, 13.5 * 500.0**-0.2),
        ("2016-01-01", 2000.0, "north_america", "III", 2.0, 3.0),
        ("2022-01-01", 2000.0, "", "II", 7.7, 7.7),
    ],
)
def test_stages_follow_regulation_13(keel, rpm, area, stage, cycle, at_load):
    # MARPOL Annex VI, regulation 13 (MEPC.176(58)); one load: NOx Technical Code 2008, 3.1.4.
    found = limit_of(date.fromisoformat(keel), rpm, area)
    assert found is not None
    assert found.stage == stage
    assert found.cycle_g_kwh == pytest.approx(cycle)
    assert found.at_load_g_kwh == pytest.approx(at_load)


def test_load_goes_with_the_cube_of_the_speed_and_so_does_its_uncertainty():
    engine = Engine(rated_rpm=120.0, design_speed_mps=8.0, speed_mps=6.0, speed_sd_mps=0.4)
    load, deviation = engine.load
    assert load == pytest.approx(0.75**3)
    # 3 x 0.4/6 by the speed, and 15 % by all else.
    assert deviation / load == pytest.approx((0.2**2 + 0.15**2) ** 0.5)
    consumption, by_load, by_engine = engine.consumption()
    assert consumption == pytest.approx(0.185 * consumption_with_load(load), rel=0.01)
    assert 0.02 < by_load < 0.06
    assert by_engine == 0.06
    for speed, problem in (
        (6.0, ""),
        (4.0, "below 0.25"),
        (16.0, "beyond the engine"),
        (None, "not known"),
    ):
        found = replace(engine, speed_mps=speed).load_problem()
        assert problem in found
        assert bool(found) == bool(problem)
    assert limit_of(date(1999, 12, 31), 100.0) is None
    old = replace(engine, keel_laid=date(1999, 12, 31))
    assert old.limit_problem().startswith("no limit: the keel was laid before 2000-01-01")
    for unknown in ("keel_laid", "rated_rpm"):
        known = {"keel_laid": date(2012, 1, 1), unknown: None}
        assert f"give engine.{unknown}" in replace(engine, **known).limit_problem()


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (lambda: species_of("n2o", {}), "'n2o' has no molar_mass_g_mol; give it in [gases.n2o]"),
        (lambda: species_of("n2o", {"molar_mass_g_mol": -1.0}), "molar_mass_g_mol is -1 g/mol"),
        (lambda: species_of("n2o", {"molar_mass_g_mol": "44"}), "must be a number"),
        (lambda: species_of("n2o", {"molar_mass": 44.0}), "has the key 'molar_mass'"),
        (lambda: species_of("n2o", {"unit": "ppt", **MASS}), "gases.n2o.unit is 'ppt'"),
        (lambda: species_of("n2o", {"carbon_atoms": 0.5, **MASS}), "give a whole number"),
        (lambda: species_of("n2o", {"title": 3, **MASS}), "give a text of one line"),
        (lambda: Engine(rated_rpm=0.0), "engine.rated_rpm is 0"),
        (lambda: Engine(strokes=3), "engine.strokes is 3"),
        (lambda: Engine(control_area="baltick"), "did you mean 'baltic'"),
        (lambda: Engine(consumption_sd=2.0), "engine.consumption_sd is 2"),
    ],
)
def test_gases_and_engines_that_cannot_be_are_refused_in_a_line(refused, message):
    with pytest.raises(MeasurementError) as caught:
        refused()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
