"""A ship and a sniffer of one's own, as tables in a scenario file."""

from pathlib import Path

import pandas as pd
import pytest

from reports.output import write_report
from reports.run.run_data import read_run
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from tests.in_process import run_command
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

EXAMPLE = str(Path(__file__).parents[3] / "docs" / "examples" / "own_ship.toml")
QUICK = (
    "fidelity=kinematic", "reports.interval_s=[0,0]", "sensors={}", "start.place_m=[-250,-120]", "start.course_deg=-90",
    "wind.speed_mps=2", "wind.from_deg=0", "flight.after_settling_s=60",
)  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("own") / "run"
    keys = [word for key in QUICK for word in ("--set", key)]
    assert run_command("scenarios.run", EXAMPLE, *keys, "--out", out, "--no-report").status == 0
    return out


def test_the_example_measures_with_its_own_sniffer_beside_its_own_ship(run, tmp_path):
    (row,) = pd.read_csv(run / "summary.csv").to_dict("records")
    assert row["sensor"] == "own cells"
    # Two readings a second: each stands for five of the ten rows.
    history = pd.read_parquet(run / "flights" / "own_ship_00000.parquet")
    changed = (history["co2_reading_ppm"].diff() != 0.0).mean()
    assert 0.17 < changed <= 0.21
    assert load_study(EXAMPLE).source_height == 22.0
    config = manifest_of(run)["trials"]["own_ship"]
    assert config["emission"]["ship"]["stack_height"] == 22.0
    assert config["payload"]["sensor"]["channels"]["so2"]["t90_s"] == 15.0
    write_report(read_run(run), page := tmp_path / "report.html")
    assert "own cells" in page.read_text(encoding="utf-8")


def toml(table):
    words = (f"{key}={value!r}" for key, value in table.items())
    return "{" + ", ".join(words) + "}"


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (
            "emission.ship.stak_height=3",
            "ship 'ferry of 5 MW' has the key 'stak_height'; did you mean 'stack_height'? it may have title, stroke",
        ),
        (
            "emission.ship.stroke=2.5",
            "emission.ship: stroke of ferry of 5 MW is 2.5; it must be 2 or 4",
        ),
        (
            "emission.ship.stack_height=high",
            "stack_height of ship 'ferry of 5 MW' is 'high'; it must be a number",
        ),
        ("emission.ship=5", "emission.ship: value is 5; give the name of a ship, or a table"),
        (
            "emission.ship.stack_height=300",
            "leaves a funnel at 10 to 200 m: set plume.source_height_m",
        ),
        (
            "payload.sensor.channels.so2.t90=3",
            "payload.sensor is an invalid table: channel 'so2' of instrument 'own cells' has",
        ),
        (
            "payload.sensor={}",
            "payload.sensor is an invalid table: instrument 'own sniffer' has no channels",
        ),
    ],
)
def test_a_table_of_no_use_is_refused_in_one_line(override, words):
    with pytest.raises(InputError) as refused:
        load_study(EXAMPLE, [override])
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
