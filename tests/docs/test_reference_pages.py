"""The pages of the reference that are made from the program are complete."""

import re
from pathlib import Path

from generated_pages import pages
from reference_pages.columns import columns_page, tables
from reference_pages.commands import commands_page
from reference_pages.frames import frames_svg
from reference_pages.keys import keys_page
from reference_pages.markdown import literal, plain, table

from common import run_layout
from measurement.estimate.estimator import estimate
from measurement.log.config import LogConfig
from measurement.log.read import read_flight
from measurement.log.run_files import SAMPLE_MEANINGS, samples
from scenarios.cli.main import commands
from scenarios.scenario.documentation import documented_keys


def test_every_key_of_a_scenario_is_on_its_page_with_its_meaning():
    rows = keys_page().splitlines()
    for key in documented_keys():
        name, meaning = literal(key.key.replace(".0", "")), plain(key.meaning).replace("|", r"\|")
        assert any(row.startswith(f"| {name} |") and meaning in row for row in rows), key.key


def test_every_column_that_is_written_has_a_meaning():
    for title, columns in tables().items():
        assert [name for name, column in columns.items() if not column.meaning] == [], title


def test_every_table_that_a_run_may_have_is_on_the_page():
    titles = " ".join(tables())
    files = {
        name
        for name in vars(run_layout).values()
        if isinstance(name, str) and name.endswith(".csv")
    }
    assert len(files) > 9
    assert [name for name in sorted(files) if name not in titles] == []


def test_the_samples_of_a_logged_flight_have_the_columns_that_are_said():
    log = Path(__file__).parents[2] / "docs" / "examples" / "example_flight.csv"
    flight = read_flight(log, LogConfig())
    table = samples(estimate(flight.readings, LogConfig().instrument).signals, flight)
    assert list(table) == list(SAMPLE_MEANINGS)


def test_columns_stand_with_their_units():
    rows = set(columns_page().splitlines())
    assert (
        "| `heading_rate_limit_rad_s` | Limit of the heading rate ω\\_max | rad/s | omega\\_max, to which commands are limited |"
        in rows
    )
    counted = "crossings of the straight axis along the apparent wind, seen from above, settled, with smoke or without"
    assert f"| `crossing_count` | Plume crossings after settling |  | {counted} |" in rows


def test_every_command_and_every_option_is_on_its_page():
    page = commands_page()
    assert re.findall(r"^## (\w+)$", page, re.MULTILINE) == list(commands())
    for option in (
        "--set KEY=VALUE",
        "--resume",
        "--no-report",
        "--to NAME,...",
        "--from NAME|FILE.toml",
    ):
        assert f"`{option}`".replace("|", r"\|") in page


def test_the_page_of_a_module_names_its_modules():
    made = pages()
    assert ".. automodule:: gnc.path_laws.npfg" in made["modules/gnc.path_laws.md"]
    assert "modules/gnc.path_laws\n" in made["modules.md"]


def test_the_sketch_has_the_orbit_closed_about_the_centre():
    """Equations (2) to (6): the reference comes back to the centre of oscillation after a period."""
    points = re.search(r'class="orbit" points="([^"]+)"', frames_svg())[1].split()
    start, middle, end = (
        tuple(map(float, points[i].split(","))) for i in (0, len(points) // 2, -1)
    )
    # A tenth of a pixel is the rounding of the picture; each of two numbers has half of it.
    for place in (middle, end):
        assert max(abs(a - b) for a, b in zip(start, place, strict=True)) < 0.11


def test_a_cell_of_a_table_cannot_end_it():
    assert table(("a",), [("x | y",)])[-2] == r"| x \| y |"
    assert plain("a_b*[c]") == r"a\_b\*\[c\]"
