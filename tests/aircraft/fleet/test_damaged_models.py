"""Models of others with one element damaged: each is a line that names it, and no traceback."""

import re
import shutil
from pathlib import Path

import pytest

from aircraft.envelope import first_trim
from aircraft.fdm import Fdm
from aircraft.fleet.find import folder_spec
from aircraft.model import stock_root
from aircraft.spec import AircraftError

pytestmark = pytest.mark.slow

ELEMENTS = ("wingarea", "wingspan", "chord", "ixx", "iyy", "izz", "emptywt")

DAMAGES = {
    "missing": ("", "no element <{}>"),
    "zero": (r"\g<1>0\g<3>", "<{}> in"),
    "no number": (r"\g<1>nan\g<3>", "<{}> in"),
    "below zero": (r"\g<1>-5\g<3>", "<{}> in"),
    "twice": (r"\g<0>\g<0>", "2 elements <{}>"),
}
"""What an element is replaced by, and what the message says of it."""

NOT_FINITE = Path(__file__).parent / "not_finite" / "aircraft" / "nan1"
"""A model whose lift depends on its own rate: in JSBSim it becomes infinite, and stays so."""


@pytest.fixture
def copied(tmp_path):
    """A folder of a stock model that may be changed, and the text of its file."""
    folder = tmp_path / "aircraft" / "c172p"
    shutil.copytree(stock_root() / "aircraft" / "c172p", folder)
    for shared in ("engine", "systems"):
        shutil.copytree(stock_root() / shared, tmp_path / shared)
    return folder


def damaged(folder, element, replacement):
    file = folder / "c172p.xml"
    text = file.read_text(encoding="utf-8", errors="replace")
    changed, count = re.subn(
        rf"(<{element}\b[^>]*>)(.*?)(</{element}>)", replacement, text, count=1, flags=re.DOTALL
    )
    assert count == 1
    file.write_text(changed, encoding="utf-8")


def refusal(action):
    with pytest.raises(AircraftError) as error:
        action()
    assert "\n" not in str(error.value)
    return str(error.value)


def test_every_damage_of_every_needed_element_is_named(copied):
    whole = (copied / "c172p.xml").read_bytes()
    for element in ELEMENTS:
        for replacement, words in DAMAGES.values():
            (copied / "c172p.xml").write_bytes(whole)
            damaged(copied, element, replacement)
            line = refusal(lambda: folder_spec(str(copied)))
            assert words.format(element) in line
    (copied / "c172p.xml").write_bytes(whole)
    assert folder_spec(str(copied)).model == "c172p"


def test_jsbsims_own_reason_with_its_line_reaches_the_user(copied):
    damaged(copied, "wingspan", r'<wingspan unit="FURLONG">36</wingspan>')
    line = refusal(lambda: Fdm(folder_spec(str(copied))))
    assert 'aircraft/c172p/c172p.xml: line 25 Supplied unit: "FURLONG" does not exist' in line
    # Neither a folder that is gone by then, nor colours of a terminal.
    assert "/tmp" not in line
    assert "\x1b" not in line


def test_a_model_that_becomes_infinite_is_an_outcome_that_names_where():
    spec = folder_spec(str(NOT_FINITE))
    line = refusal(lambda: first_trim(Fdm(spec), 60.0))
    assert "'aero/L'" in line
    assert "not finite: correct it in nan1.xml" in line
