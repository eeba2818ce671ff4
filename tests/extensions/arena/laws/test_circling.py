"""Laws of others circle a moving vessel as the paper's law does, in the mission that stands off."""

import pytest

from extensions.arena.laws.lgvf import LgvfLaw
from extensions.arena.laws.npfg import NpfgLaw
from tests.gnc.mission.test_standoff import RADIUS, Flown


@pytest.mark.parametrize(
    ("law", "most"), [(NpfgLaw(), 0.2), (LgvfLaw(), 2.0)], ids=["npfg", "lgvf"]
)
def test_laws_of_others_circle_a_moving_vessel_at_the_radius(law, most):
    flight = Flown(law, 200.0)
    # Within the centimetres of a law that is called twenty times a second; LGVF converges within
    # V/R.
    assert flight.mission.orbit.in_place
    assert max(abs(distance - RADIUS) for distance in flight.distances[-1000:]) < most
