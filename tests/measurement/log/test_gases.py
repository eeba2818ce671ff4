"""Other gases in a log: found by name and unit or declared, and what cannot be is refused."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from logged_flights import flight_table, run

from measurement.errors import MeasurementError
from measurement.log.analysis import estimate_gases
from measurement.log.config import read_config
from measurement.log.read import read_flight

pytestmark = pytest.mark.slow


@pytest.fixture
def gases(logged):
    """Return the log of ``golden``, with methane, black carbon and particles."""
    flight_table(rows=121, gases=True).to_csv(logged, index=False)
    return logged


def configured(logged, text):
    path = logged.parent / "instrument.toml"
    path.write_text(f'instrument = "electrochemical"\n{text}', encoding="utf-8")
    return read_config(path)


def recorded(logged):
    return json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))


def test_gases_are_found_by_name_and_unit(golden):
    found = {record["gas"]: record for record in golden.json("out/estimate.json")["gases"]}
    assert list(found) == ["nox", "ch4", "bc", "pn"]
    # 70 ppb/ppm by (1) of measurement.species: 6.6 % of a fuel with 75 % of carbon.
    for gas, value in (("ch4", 6.6), ("bc", 0.209), ("pn", 10.1)):
        assert found[gas]["value"] == pytest.approx(value, abs=2.0 * found[gas]["total"])
    assert found["ch4"]["remarks"][0] == "column 'CH4 [ppm]'"
    assert found["nox"]["stage"]["stage"] == "II"


def test_a_gas_of_its_own_has_the_constants_of_the_configuration(gases):
    config = configured(
        gases,
        "[gases.ethane]\nmolar_mass_g_mol = 30.07\ncarbon_atoms = 2\nresult = '% of the fuel'\n"
        "[columns]\nethane = 'CH4 [ppm]'\n[channels.ethane]\nt90_s = 4.0\nnoise = 4.0\n",
    )
    found = {of.species.name: of for of in read_flight(gases, config).gases}
    assert found["ethane"].species.carbon_atoms == 2
    assert found["ethane"].instrument.known("so2").noise == 4.0
    # ppm to ppb
    assert np.nanmedian(found["ethane"].readings.values[:, 0]) > 1900.0


def test_a_found_gas_that_cannot_be_estimated_is_named_and_a_declared_one_refused(gases):
    table = pd.read_csv(gases).drop(columns=["no_ppb", "BC [ug/m3]", "pn_cm3"])
    table.assign(**{"CH4 [ppm]": 5000.0}).to_csv(gases, index=False)
    config = configured(gases, "[channels.ch4]\nt90_s = 1.0\n")
    found = read_flight(gases, config).gases
    reason = r"CH4: CH4 reaches 5e\+06 ppb"
    estimates, [remark] = estimate_gases(found, (), air=config.air)
    assert estimates == []
    assert re.match(f"not estimated: {reason}", remark)
    with pytest.raises(MeasurementError, match=reason):
        estimate_gases(found, config.declared, air=config.air)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[columns]\nch4 = 'methane'\n", "no CH4 column 'methane'"),
        ("[channels.nox]\nt90_s = 2.0\n", "[channels] has nox, and the log no column of it"),
        ("[columns]\nhumidity = 'RH'\n", "no humidity column 'RH'"),
        ("", "are both of CH4; name one of them"),
    ],
)
def test_what_cannot_be_a_gas_is_refused_in_a_line(gases, text, message):
    if not text:
        pd.read_csv(gases).assign(ch4_ppb=1900.0).to_csv(gases, index=False)
    config = configured(gases, text)
    with pytest.raises(MeasurementError, match=re.escape(message)) as caught:
        read_flight(gases, config)
    assert "\n" not in str(caught.value)


def test_a_log_without_so2_has_the_same_figures_of_the_others(golden, gases, capsys):
    toml = (golden.log.parent / "instrument.toml").read_text(encoding="utf-8")
    pd.read_csv(gases).drop(columns=["so2_ppb", "so2_true_ppb"]).to_csv(gases, index=False)
    (gases.parent / "instrument.toml").write_text(toml, encoding="utf-8")
    assert run(gases) == 2
    assert "no SO2 column 'so2_ppb'" in capsys.readouterr().err
    without = f'{toml}[columns]\nso2 = ""\n'
    (gases.parent / "instrument.toml").write_text(without, encoding="utf-8")
    path = gases.parent / "record.json"
    assert run(gases, "--record", str(path)) == 0
    assert "without SO2" in capsys.readouterr().out
    found = recorded(gases)
    assert found["estimate"] is None
    assert found["gases"] == golden.json("out/estimate.json")["gases"]
    samples = pd.read_csv(gases.parent / "out" / "samples.csv")
    assert {"time_s", "co2_ppm", "nox_reading", "nox_excess", "north_m"} <= set(samples)
    figures = json.loads(path.read_text(encoding="utf-8"))["figures"]
    assert [of["gas"] for of in figures] == ["nox", "ch4", "bc", "pn"]
    # With nothing else to compare with CO2, there is no estimate.
    pd.read_csv(gases)[["time_s", "co2_ppm"]].to_csv(gases, index=False)
    configured(gases, '[columns]\nso2 = ""\n')
    assert run(gases) == 2
    assert "there is no other gas to compare with CO2" in capsys.readouterr().err


PAGE = Path(__file__).parents[3] / "docs" / "howto" / "gases.md"
_NUMBER = r"(\d+(?:\.\d+)?)"


def test_the_page_shows_what_the_command_prints_and_a_calculator_agrees(tmp_path, capsys):
    examples = PAGE.parents[1] / "examples"
    for name, source in (("flight.csv", "example_flight.csv"), ("instrument.toml", None)):
        content = (examples / (source or "example_gases.toml")).read_bytes()
        (tmp_path / name).write_bytes(content)
    assert run(tmp_path / "flight.csv") == 0
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
    [nox] = recorded(tmp_path / "flight.csv")["gases"]
    # The steps of the page, with its rounding.
    per_fuel = round(233.0 / 12.0, 1) / 1000.0 * 46.0 * 72.4
    assert per_fuel == pytest.approx(nox["per_fuel"], rel=0.05)
    assert pytest.approx(nox["load"], rel=0.01) == (12.0 / 13.0) ** 3
    assert per_fuel * 0.208 == pytest.approx(nox["value"], rel=0.05)
    assert np.linalg.norm((0.81, 0.66, 0.39, 0.32)) == pytest.approx(1.16, abs=0.01)
    assert nox["total"] == pytest.approx(1.20, rel=0.1)
    assert nox["verdict"]["limit"] == pytest.approx(44.0 * 500.0**-0.23)
