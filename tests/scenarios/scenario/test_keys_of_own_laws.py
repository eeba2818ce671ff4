"""The keys that a steering law of one's own brings: their names, defaults and types."""

import pytest

from scenarios.errors import InputError
from scenarios.planning.guidance import steering_law
from scenarios.scenario.files import load_study


def loaded(*overrides):
    # Without its comparison with another law, for which keys count as acting.
    return load_study("sweep_nu", ["comparison={}", *overrides])


def refusal(*overrides):
    with pytest.raises(InputError) as refused:
        loaded(*overrides)
    message = str(refused.value)
    assert "\n" not in message
    return message


OWN = """
from dataclasses import dataclass

@dataclass(frozen=True, kw_only=True)
class Same:
    gain_per_s: float = 1.5
    count: int = 2
    word: "str" = "x"
    flag: bool = False
    gain: float = 2
    def heading_rate(self, *_): return 0.0

@dataclass(frozen=True, kw_only=True)
class Other(Same):
    look_ahead_m: float = 25.0
"""


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("guidance.count=1.5", "count is 1.5; law"),
        ("guidance.count=true", "takes a whole number, by default 2"),
        ("guidance.word=5", "takes a word in quotation marks, by default 'x'"),
        ("guidance.flag=no", "flag is 'no'; law"),
        ("guidance.flag=1", "takes true or false, by default False"),
        ("guidance.gain=much", "gain is 'much'; law"),
        (f"guidance.gain={10**400}", "takes a finite number, by default 2"),
    ],
)
def test_a_key_of_a_law_is_of_the_type_of_its_field(tmp_path, override, words):
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    law = f"guidance.law={tmp_path}/own.py:Same"
    assert words in refusal(law, override)
    fitting = ["guidance.count=3", 'guidance.word="y"', "guidance.flag=true", "guidance.gain=0.5"]
    made = steering_law(loaded(law, *fitting).guidance)
    assert (made.count, made.word, made.flag, made.gain) == (3, "y", True, 0.5)
