"""Three hundred wrong inputs: whatever key has whatever value that it cannot have, the command says
so in one line with the key, and ends with status 2.
"""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenarios.errors import InputError
from scenarios.scenario.errors import known_keys
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario
from tests.in_process import run_command

pytestmark = pytest.mark.slow

KEYS = sorted(known_keys(Scenario))
VALUES = st.one_of(
    st.sampled_from(
        ["nan", "inf", "true", "word", '""', "[]", "[[]]", "{}", "{x=1}", "1e999", "é"]
    ),
    st.sampled_from(["-1", "-1e9", "1e12", "2.5", "[1, -1]", "[1, 2, 3]", '["a", 3]', "0x"]),
    st.integers(-(2**70), 2**70).map(str),
    st.floats(-1e300, 1e300).map(repr),
    st.text("abc_. ", min_size=1, max_size=6),
)
ENDS = st.sampled_from(["", "", "", "x", "_", ".x", ".0", ".0.x"])
"""Behind a key, what makes another one of it, known or not."""


@settings(max_examples=300, deadline=None, derandomize=True)
@given(key=st.sampled_from(KEYS), end=ENDS, value=VALUES)
def test_a_wrong_value_or_key_is_one_line_and_status_2(key, end, value):
    override = f"{key}{end}={value}"
    try:
        load_study("sea_wind", [override])
    except InputError as error:
        message = str(error)
    else:
        assume(False)
    ended = run_command("scenarios.run", "sea_wind", "--set", override, "--no-report")
    assert ended.status == 2
    assert ended.errors == f"error: {message}\n"
    assert any(part in message for part in key.split(".") if not part.isdecimal()), message
