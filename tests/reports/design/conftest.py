"""The design of the X8 with a trim at a limit and a throttle that bears any gain."""

import copy

import pytest


@pytest.fixture
def record(designs):
    """The record of a design that meets everything that is required of it."""
    record = copy.deepcopy(designs("x8").record)
    record["trims"][0]["limits"] = ["elevator at 97 % of its travel"]
    for row in record["margins"]:
        if row["loop"] == "throttle":
            row["gain_db"] = None
    return record
