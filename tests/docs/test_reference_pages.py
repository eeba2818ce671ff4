"""The pages of the reference that are made from the program are complete."""

import re

from reference_pages.columns import tables
from reference_pages.commands import commands_page
from reference_pages.frames import frames_svg
from reference_pages.keys import keys_page
from reference_pages.markdown import literal, plain

from common import run_layout
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
    assert len(files) > 7
    assert [name for name in sorted(files) if name not in titles] == []


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


def test_the_sketch_has_the_orbit_closed_about_the_centre():
    """Equations (2) to (6): the reference comes back to the centre of oscillation after a period."""
    points = re.search(r'class="orbit" points="([^"]+)"', frames_svg())[1].split()
    start, middle, end = (
        tuple(map(float, points[i].split(","))) for i in (0, len(points) // 2, -1)
    )
    # A tenth of a pixel is the rounding of the picture; each of two numbers has half of it.
    for place in (middle, end):
        assert max(abs(a - b) for a, b in zip(start, place, strict=True)) < 0.11
