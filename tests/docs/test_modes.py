"""The table of modes in the glossary."""

from pathlib import Path

from gnc.mission.mission import Mode

GLOSSARY = Path(__file__).parents[2] / "docs" / "reference" / "glossary.md"


def test_the_glossary_explains_every_mode_and_no_other():
    lines = GLOSSARY.read_text(encoding="utf-8").partition("## Modes")[2].splitlines()
    explained = [line.split("|")[1].strip(" `") for line in lines if line.startswith("| `")]
    assert sorted(explained) == sorted(mode.value for mode in Mode)
