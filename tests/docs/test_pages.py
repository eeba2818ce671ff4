"""Pages of the documentation are complete, and linked; docstrings come out as text."""

import inspect
import re
from pathlib import Path

import pytest
from docstrings import as_text
from generated_pages import FOLDER, pages
from reference_pages.columns import tables
from reference_pages.commands import commands_page
from reference_pages.keys import keys_page
from reference_pages.markdown import literal, plain
from repository_links import PAGES

from common import run_layout
from gnc.mission.mission import Mode
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
    names = [name for name in vars(run_layout).values() if isinstance(name, str)]
    files = {name for name in names if name.endswith(".csv")}
    assert len(files) > 7
    assert [name for name in sorted(files) if name not in titles] == []


def test_every_command_and_every_option_is_on_its_page():
    page = commands_page()
    assert re.findall(r"^## (\w+)$", page, re.MULTILINE) == list(commands())
    for option in ("--set KEY=VALUE", "--resume", "--to NAME,...", "--from NAME|FILE.toml"):
        assert f"`{option}`".replace("|", r"\|") in page


GLOSSARY = Path(__file__).parents[2] / "docs" / "reference" / "glossary.md"


def test_the_glossary_explains_every_mode_and_no_other():
    lines = GLOSSARY.read_text(encoding="utf-8").partition("## Modes")[2].splitlines()
    explained = [line.split("|")[1].strip(" `") for line in lines if line.startswith("| `")]
    assert sorted(explained) == sorted(mode.value for mode in Mode)


DOCS = Path(__file__).parents[2] / "docs"


def test_every_such_page_exists():
    for source, page in PAGES.items():
        assert (DOCS.parent / source).is_file()
        assert (DOCS / page).is_file()


ROOMS = ("aircraft", "common", "gnc", "innerloop", "measurement", "reports", "scenarios")


def test_every_docstring_of_the_project_names_its_parameters_so():
    # A line of these sections is an entry, ``name : description``, or goes on with one: else it
    # would be lost among the text.
    root = Path(__file__).parents[2]
    strange = []
    for path in sorted(path for room in ROOMS for path in (root / room).rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        # As they are written: to parse the files takes a second.
        for docstring in re.findall(r'"""(.*?)"""', source, re.DOTALL):
            text = inspect.cleandoc(docstring)
            for section in re.findall(
                r"^(?:Parameters|Attributes|Raises)\n-+\n(.*?)(?:\n\n|\Z)",
                text,
                re.MULTILINE | re.DOTALL,
            ):
                lines = as_text(["Parameters", "----------", *section.splitlines()])
                strange += [
                    f"{path.relative_to(root)}: {line}"
                    for line in lines[2:]
                    if re.match(r" {3}(?!``| )\S", line)
                ]
    assert strange == []


@pytest.mark.slow
def test_every_page_is_in_the_contents_once():
    blocks = re.findall(
        r"```\{toctree\}\n(.*?)```", (DOCS / "index.md").read_text("utf-8"), re.DOTALL
    )
    listed = [
        line for block in blocks for line in block.splitlines() if line and not line.startswith(":")
    ]
    written = {
        path.relative_to(DOCS)
        for path in DOCS.rglob("*.md")
        if not {FOLDER, "_build"} & set(path.relative_to(DOCS).parts)
    }
    made = {f"{FOLDER}/{name[:-3]}" for name in pages() if name.endswith(".md") and "/" not in name}
    assert sorted(listed) == sorted(
        made | {path.with_suffix("").as_posix() for path in written} - {"index"}
    )
