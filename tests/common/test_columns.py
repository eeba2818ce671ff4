"""What columns are: units by their names, what is shown of them, and their way through a file."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.columns import Column, described, from_json, to_json

WORDS = st.text(st.characters(categories=("L", "N")), min_size=1, max_size=12)
COLUMNS = st.builds(
    Column,
    WORDS,
    title=WORDS,
    symbol=WORDS | st.just(""),
    unit=WORDS,
    digits=st.integers(0, 12),
    worse=st.sampled_from(["", "higher", "lower", "off zero"]),
    adds_up=st.booleans(),
    kind=st.sampled_from(["number", "text", "truth", "any"]),
    part=WORDS | st.just(""),
)


@given(st.dictionaries(WORDS, st.dictionaries(WORDS, COLUMNS, max_size=3), max_size=3))
def test_tables_come_back_from_their_file_as_they_were_declared(tables):
    declared = {name: described(columns) for name, columns in tables.items()}
    assert from_json(json.loads(json.dumps(to_json(declared)))) == declared


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"digits": 1.5}, "digits of a column is 1.5; give 0 to 12"),
        ({"digits": True}, "digits of a column is True"),
        ({"worse": "bigger"}, "worse of a column is 'bigger'; give one of '', 'higher'"),
        ({"unit": 3}, "unit of a column is 3; give text of one line"),
        ({"title": "a\nb"}, "give text of one line"),
        ({"scale": 0.0}, "scale of a column is 0.0"),
        ({"scale": float("nan")}, "scale of a column is nan"),
        ({"kind": []}, "kind of a column is []"),
    ],
)
def test_what_is_no_column_is_refused_in_one_line(given, words):
    with pytest.raises(ValueError, match="of a column is") as refused:
        Column(**given)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
