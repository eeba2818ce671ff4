"""What README.md, CONTRIBUTING.md and the pages of the documentation say can be done as it stands."""

import re
import shlex
import sys
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import pytest

from common.command_line import run_command
from scenarios.cli.main import commands
from scenarios.scenario.files import load_study

ROOT = Path(__file__).parents[2]
PAGES = ("README.md", "CONTRIBUTING.md")
DOCS = [
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "docs").rglob("*.md")
    if not {"generated", "_build"} & set(path.parts)
]
YOURS = re.compile(r"\.py:|mine\.toml|fleet|RUN_DIR|runs/|wind\.csv")
"""What a command names that the reader has, and a clone does not."""


def _lines(page: str) -> list[str]:
    blocks = re.findall(
        r"^```[a-z]*\n(.*?)^```$", (ROOT / page).read_text("utf-8"), re.MULTILINE | re.DOTALL
    )
    joined = (block.replace("\\\n", " ") for block in blocks)
    return [
        line.split(" #")[0].strip()
        for block in joined
        for line in block.splitlines()
        if line.strip()
    ]


def _commands(word: str, pages: Iterable[str] = PAGES) -> list[list[str]]:
    called = (
        shlex.split(line)
        for page in pages
        for line in _lines(page)
        if line.startswith((".venv", "plume-flight"))
    )
    return [words[2:] for words in called if words[0].endswith("plume-flight") and words[1] == word]


@pytest.mark.parametrize("page", PAGES)
def test_every_make_target_exists(page):
    targets = {words.split()[1] for words in _lines(page) if words.startswith("make ")}
    makefile = (ROOT / "Makefile").read_text("utf-8")
    assert targets
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


@pytest.mark.parametrize("page", PAGES)
def test_every_link_and_picture_exists(page):
    text = (ROOT / page).read_text("utf-8")
    places = [*re.findall(r"\]\(([^)#]+)[^)]*\)", text), *re.findall(r'src="([^"]+)"', text)]
    here = [place for place in places if not place.startswith("https://")]
    assert [place for place in here if not (ROOT / place).exists()] == []


def test_every_scenario_and_key_of_readme_and_documentation_is_taken():
    """To read a study refuses scenarios, keys and values that there are not, and keys that act
    nowhere.
    """
    given = _commands("run", (*PAGES, *DOCS))
    flown = [words for words in given if words and not YOURS.search(" ".join(words))]
    assert len(flown) > 20
    for words in flown:
        overrides = [word for flag, word in pairwise(words) if flag == "--set"]
        assert load_study(words[0], overrides).title


@pytest.mark.parametrize("word", sorted(commands()))
def test_every_command_takes_the_options_that_are_given(word, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["plume-flight", word, "--help"])
    with pytest.raises(SystemExit):
        run_command(commands(), "plume-flight")
    shown = capsys.readouterr().out
    for arguments in _commands(word, (*PAGES, *DOCS)):
        options = [argument for argument in arguments if argument.startswith("--")]
        assert [option for option in options if option not in shown] == []
