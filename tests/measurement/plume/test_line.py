"""Parcels of a realisation, as a replay draws them, against the concentration of that realisation."""

import numpy as np
import pytest
from plume_cases import plume_behind, turning

STILL = {"structure_intensity": 0.0, "age_max": 120.0}


def centres(line, when):
    """Return north, east, height and ages of the centres of parcels that are alive at a time."""
    age = when - line.emitted
    alive = (age > 5.0) & (age < line.age_max - 5.0)
    alive[[0, -1]] = False
    chosen = np.flatnonzero(alive)
    ages = np.linspace(0.0, line.age_max, line.table.shape[1])
    # Winds of a row agree where the table has one, which is so of a steady ship.
    height, _, _, meander_y, meander_z = (
        np.interp(age[chosen], ages, line.table[0, :, column]) for column in range(5)
    )
    # The stack moves against the apparent wind in the air mass.
    away = np.stack(
        [
            line.north[chosen - 1] - line.north[chosen + 1],
            line.east[chosen - 1] - line.east[chosen + 1],
        ]
    )
    along_north, along_east = away / np.hypot(*away)
    off = meander_y * line.across[chosen]
    north, east = line.north[chosen] - off * along_east, line.east[chosen] + off * along_north
    return north, east, np.abs(height + meander_z * line.up[chosen]), age[chosen]


def test_parcels_are_where_the_realisation_has_its_centre():
    track = turning(8.0, 4.0, 1.0, rate=0.0, until=300.0)
    plume = plume_behind(track, **STILL)
    when = 200.0
    line = plume.line(250.0, length=600.0, spacing=5.0)
    north, east, up, age = centres(line, when)
    assert len(age) > 50
    sample = plume.sample(np.full(len(age), when), north, east, up)
    # The table has 25 ages, between which heights and meanders are linear: to 0.2 m.
    assert sample.age == pytest.approx(age, abs=0.05)
    assert sample.across == pytest.approx(sample.centre_across, abs=0.2)
    assert up == pytest.approx(sample.centre_height, abs=0.2)
