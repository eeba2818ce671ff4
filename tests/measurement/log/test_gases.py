"""Other gases in a log: found by name and unit or declared, and what cannot be is refused."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from logged_flights import run

from measurement.log.command import main
from measurement.log.config import read_config
from measurement.log.read import read_flight

pytestmark = pytest.mark.slow

BRIEFLY = pytest.mark.usefixtures("briefly")

ENGINE = """
[engine]
keel_laid = 2012-05-01
rated_rpm = 120
design_speed_mps = 8.0
speed_mps = 7.0
"""


@pytest.fixture
def gases(logged):
    """Return a log with methane, black carbon and particles beside the others."""
    table = pd.read_csv(logged)
    generator = np.random.default_rng(1)
    excess = table["co2_ppm"] - table["co2_ppm"].quantile(0.05)
    for name, level, slope, noise in (
        ("CH4 [ppm]", 1.95, 0.07, 0.004),
        ("BC [ug/m3]", 0.2, 0.12, 0.05),
        ("pn_cm3", 1500.0, 5800.0, 200.0),
    ):
        read = level + slope * excess + noise * generator.standard_normal(len(table))
        table[name] = read.round(6)
    table.to_csv(logged, index=False)
    return logged


def configured(logged, text):
    (logged.parent / "instrument.toml").write_text(
        f'instrument = "electrochemical"\n{text}', encoding="utf-8"
    )


def recorded(logged):
    return json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))


@BRIEFLY
def test_gases_are_found_by_name_and_unit_with_a_row_for_each(gases, capsys):
    configured(gases, ENGINE)
    assert run(gases) == 0
    printed = capsys.readouterr().out
    found = {record["gas"]: record for record in recorded(gases)["gases"]}
    assert list(found) == ["nox", "ch4", "bc", "pn"]
    # 70 ppb/ppm by (1) of measurement.species: 6.6 % of a fuel with 75 % of carbon.
    assert found["ch4"]["value"] == pytest.approx(6.6, abs=2.0 * found["ch4"]["total"])
    assert found["ch4"]["remarks"][0] == "column 'CH4 [ppm]'"
    assert found["bc"]["value"] == pytest.approx(0.209, abs=2.0 * found["bc"]["total"])
    assert found["pn"]["value"] == pytest.approx(10.1, abs=2.0 * found["pn"]["total"])
    assert found["nox"]["stage"]["stage"] == "II"
    assert "stage II" in printed
    assert "a verdict screens, and certifies nothing" in printed
    assert "no limit on this gas" in printed


@BRIEFLY
def test_other_gases_do_not_change_the_sulphur_content(gases):
    assert run(gases) == 0
    with_gases = recorded(gases)["estimate"]
    table = pd.read_csv(gases)
    table.drop(columns=["CH4 [ppm]", "BC [ug/m3]", "pn_cm3"]).to_csv(gases, index=False)
    assert run(gases) == 0
    assert recorded(gases)["estimate"] == with_gases


def test_a_gas_of_its_own_has_the_constants_of_the_configuration(gases):
    configured(
        gases,
        "[gases.ethane]\nmolar_mass_g_mol = 30.07\ncarbon_atoms = 2\nresult = '% of the fuel'\n"
        "[columns]\nethane = 'CH4 [ppm]'\n[channels.ethane]\nt90_s = 4.0\nnoise = 4.0\n",
    )
    config = read_config(gases.parent / "instrument.toml")
    found = {of.species.name: of for of in read_flight(gases, config).gases}
    assert found["ethane"].species.carbon_atoms == 2
    assert found["ethane"].instrument.known("so2").noise == 4.0
    # ppm to ppb
    assert np.nanmedian(found["ethane"].readings.values[:, 0]) > 1900.0


@BRIEFLY
def test_a_found_gas_that_cannot_be_estimated_is_named_and_a_declared_one_refused(gases, capsys):
    table = pd.read_csv(gases)
    table["CH4 [ppm]"] = 5000.0
    table.to_csv(gases, index=False)
    assert run(gases) == 0
    assert "not estimated: CH4: CH4 reaches 5e+06 ppb" in capsys.readouterr().out
    configured(gases, "[channels.ch4]\nt90_s = 1.0\n")
    assert run(gases) == 2
    assert capsys.readouterr().err.count("\n") == 1


@BRIEFLY
@pytest.mark.parametrize(
    ("text", "quality"),
    [
        ("", {"so2": "C", "nox": "C", "ch4": "C"}),
        ("[humidity]\nso2 = [-5.0, 3.0]\nch4 = [0.0, 1.0]\n", {"so2": "B", "nox": "C", "ch4": "A"}),
    ],
)
def test_humid_air_needs_its_effect_to_be_stated(gases, text, quality):
    # Beecken et al. 2023: seven of eight systems read too little, possibly above 80 %.
    table = pd.read_csv(gases)
    table["humidity_percent"] = 60.0
    table.to_csv(gases, index=False)
    configured(gases, "")
    assert run(gases) == 0
    dry = recorded(gases)
    assert dry["estimate"]["quality"] != "C"
    table["humidity_percent"] = 88.0
    table.to_csv(gases, index=False)
    configured(gases, text)
    assert run(gases) == 0
    humid = recorded(gases)
    found = {of["gas"]: of["quality"] for of in humid["gases"]}
    found["so2"] = humid["estimate"]["quality"]
    assert {gas: found[gas] for gas in quality} == quality
    if text:
        ratio = humid["estimate"]["fsc_percent"] / dry["estimate"]["fsc_percent"]
        assert ratio == pytest.approx(1.0 / 0.95, rel=0.02)
        assert humid["estimate"]["total_percent"] > dry["estimate"]["total_percent"]
    else:
        assert "more than 80 % relative humidity" in " ".join(humid["estimate"]["quality_reasons"])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[gases.n2o]\n", "gas 'n2o' has no molar_mass_g_mol"),
        ("[gases.ch4]\nmolar_mass_g_mol = 17.0\n", "gases has the name 'ch4', which is taken"),
        ("[gases]\nn2o = 44.0\n", "gases.n2o is 44.0; give a table [gases.n2o]"),
        ("[columns]\nn2o = 'N2O [ppb]'\n", "[columns] has the key 'n2o'"),
        ("[columns]\nch4 = 'methane'\n", "no CH4 column 'methane'"),
        ("[units]\nch4 = 'kg'\n", "units.ch4: 'kg' is no unit of this quantity"),
        ("[channels.nox]\nt90_s = 2.0\n", "[channels] has nox, and the log no column of it"),
        ("[channels.ch4]\nt90 = 2.0\n", "channel 'ch4' has the key 't90'"),
        ("[channels.ch4]\ncross = { no = 0.1 }\n", "only SO2, NO and NO2 may have one"),
        ("[engine]\nkeel_laid = 'May'\n", "engine.keel_laid is 'May'; give a date"),
        ("[engine]\nrated_rpm = 'slow'\n", "engine.rated_rpm is 'slow'; give a number"),
        ("[humidity]\nso2 = -5.0\n", "humidity.so2 is -5.0; give its effect"),
        ("[columns]\nhumidity = 'RH'\n", "no humidity column 'RH'"),
        ("calibration_hours = 0\n", "calibration_hours is 0"),
        ("serial = true\n", "serial is True"),
    ],
)
def test_what_cannot_be_a_gas_is_refused_in_a_line(gases, capsys, text, message):
    configured(gases, text)
    assert run(gases) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1


@BRIEFLY
def test_a_log_without_so2_has_the_same_figures_of_the_others(gases, capsys):
    configured(gases, ENGINE)
    assert run(gases) == 0
    with_sulphur = recorded(gases)["gases"]
    pd.read_csv(gases).drop(columns=["so2_ppb", "so2_true_ppb"]).to_csv(gases, index=False)
    assert run(gases) == 2
    assert "no SO2 column 'so2_ppb'" in capsys.readouterr().err
    configured(gases, f'[columns]\nso2 = ""\n{ENGINE}')
    path = gases.parent / "record.json"
    assert run(gases, "--record", str(path)) == 0
    assert "without SO2" in capsys.readouterr().out
    found = recorded(gases)
    assert found["estimate"] is None
    assert found["gases"] == with_sulphur
    samples = pd.read_csv(gases.parent / "out" / "samples.csv")
    assert {"time_s", "co2_ppm", "nox_reading", "nox_excess", "north_m"} <= set(samples)
    figures = json.loads(path.read_text(encoding="utf-8"))["figures"]
    assert [of["gas"] for of in figures] == ["nox", "ch4", "bc", "pn"]
    # With nothing else to compare with CO2, there is no estimate.
    table = pd.read_csv(gases)[["time_s", "co2_ppm"]]
    table.to_csv(gases, index=False)
    assert run(gases) == 2
    assert "there is no other gas to compare with CO2" in capsys.readouterr().err


def test_two_columns_of_one_gas_are_asked_about(gases, capsys):
    table = pd.read_csv(gases)
    table["ch4_ppb"] = 1900.0
    table.to_csv(gases, index=False)
    assert run(gases) == 2
    assert "are both of CH4; name one of them" in capsys.readouterr().err


PAGE = Path(__file__).parents[3] / "docs" / "howto" / "gases.md"


@BRIEFLY
def test_the_page_shows_what_the_command_prints_and_a_calculator_agrees(tmp_path, capsys):
    examples = PAGE.parents[1] / "examples"
    config = examples / "example_gases.toml"
    log = examples / "example_flight.csv"
    words = [str(log), "--config", str(config), "--out", str(tmp_path / "out"), "--no-report"]
    assert main(words) == 0
    printed = [line for line in capsys.readouterr().out.splitlines() if line]
    shown = PAGE.read_text(encoding="utf-8").split("```")[3].strip().splitlines()
    first = next(i for i, line in enumerate(printed) if line.startswith("NOx: nitrogen"))
    for line, page in zip(printed[first:], shown, strict=False):
        # Figures may change with the fit by some per cent, and with them the order of their parts.
        if line.startswith("  standard uncertainty"):
            continue
        words, of_page = (" ".join(re.split(_NUMBER, text)[::2]).split() for text in (line, page))
        assert words == of_page
        for number, shown_number in zip(
            *(re.findall(_NUMBER, text) for text in (line, page)), strict=True
        ):
            assert float(number) == pytest.approx(float(shown_number), rel=0.1, abs=1.0)
    [nox] = json.loads((tmp_path / "out" / "estimate.json").read_text(encoding="utf-8"))["gases"]
    # The steps of the page, with its rounding.
    per_fuel = round(233.0 / 12.0, 1) / 1000.0 * 46.0 * 72.4
    assert per_fuel == pytest.approx(nox["per_fuel"], rel=0.05)
    assert pytest.approx(nox["load"], rel=0.01) == (12.0 / 13.0) ** 3
    assert per_fuel * 0.208 == pytest.approx(nox["value"], rel=0.05)
    assert np.linalg.norm((0.81, 0.66, 0.39, 0.32)) == pytest.approx(1.16, abs=0.01)
    assert nox["total"] == pytest.approx(1.20, rel=0.1)
    assert nox["verdict"]["limit"] == pytest.approx(44.0 * 500.0**-0.23)


_NUMBER = r"(\d+(?:\.\d+)?)"
