"""Places for runs of squares, and one that nothing disturbed."""

import pytest
from engine_cases import TABLE, Squares, SquareStudy, fly


@pytest.fixture
def marks(tmp_path):
    (tmp_path / "marks").mkdir()
    return tmp_path / "marks"


@pytest.fixture
def out(tmp_path):
    return tmp_path / "run"


@pytest.fixture
def whole(marks, tmp_path):
    """The table of a run that nothing disturbed."""
    (tmp_path / "others").mkdir()
    fly(SquareStudy(Squares(marks=tmp_path / "others")), tmp_path / "whole")
    return (tmp_path / "whole" / TABLE).read_bytes()
