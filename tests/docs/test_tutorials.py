"""The code of the tutorials runs as it stands, cell by cell, and shows what the text says."""

import re
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

pytestmark = pytest.mark.slow

TUTORIALS = Path(__file__).parents[2] / "docs" / "tutorials"

PRINTED = {
    "first_flight": (
        "nu_0.50 met",
        "min_distance_m",
        "steepest bank",
        "did you mean 'wind.from_deg'?",
    ),
    "own_law": ("met\n", "less lead"),
    "ship_from_ais": ("411 of 417 rows", "keep-out violations: 0", "flight.kmz"),
    "measure_a_plume": ("of them with smoke", "fuel sulphur content", "limit 0.1 %: "),
}


def test_every_tutorial_is_tested():
    assert {path.stem for path in TUTORIALS.glob("*.md")} == set(PRINTED)


@pytest.mark.parametrize("name", PRINTED)
def test_the_cells_of_a_tutorial_run(name, designs, tmp_path, monkeypatch, capsys):
    # At whatever altitude, with the autopilot that other tests have: to design another takes
    # seconds.
    monkeypatch.setattr(
        "scenarios.studies.base.design_of", lambda spec, _: (designs(spec.name), "")
    )
    cells = re.findall(
        r"^```\{code-cell\}[^\n]*\n(.*?)^```$",
        (TUTORIALS / f"{name}.md").read_text("utf-8"),
        re.MULTILINE | re.DOTALL,
    )
    script = tmp_path / "cells.py"
    script.write_text("\n".join(cells), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    plt.close("all")
    printed = capsys.readouterr().out
    for words in PRINTED[name]:
        assert words in printed
