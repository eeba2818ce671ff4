import math
from dataclasses import fields
from types import SimpleNamespace

import numpy as np
import pytest
from gnc_cases import SPEED, examples
from hypothesis import given
from hypothesis import strategies as st

from gnc.laws import CascadeLaw, LineOfSightLaw, LyapunovLaw, line_of_sight_law
from gnc.paper import RelativeState, lyapunov_law
from gnc.steering import STILL_AIR, LimitedLaw, Motion, started

# What the laws command in the guidance is tested in test_guidance.py.
GAIN, K_1 = 1.5, 0.001

omegas = st.floats(-1.0, 1.0)


@examples(200)
@given(phi=st.floats(-3.1, 3.1), rho=st.floats(10.0, 2000.0), omega_rho=omegas)
def test_the_lyapunov_law_is_equation_24_as_printed(phi, rho, omega_rho):
    printed = -K_1 * rho * SPEED * math.sin(phi) / (1.0 + math.cos(phi)) + omega_rho
    # 1 + cos(3.1) = 9e-4 cancels three digits of the printed form.
    assert lyapunov_law(RelativeState(60.0, rho, 0.3, phi), SPEED, omega_rho, K_1) == pytest.approx(
        printed, rel=1e-12, abs=1e-12
    )


def test_the_lyapunov_law_grows_without_limit_towards_the_opposite_course():
    # EQUATIONS.md, errata: singular at phi = pi. tan(x) is 1/(pi/2 - x) there: 60 m * 19.42 m/s *
    # 0.001/m^2 * 2/1e-6.
    command = lyapunov_law(RelativeState(60.0, 60.0, 0.0, math.pi - 1e-6), SPEED, 0.0, K_1)
    # The angle's rounding, 4e-16 of 1e-6.
    assert command == pytest.approx(-60.0 * SPEED * K_1 * 2e6, rel=1e-9)


@pytest.mark.parametrize("angle", [-3.0, -0.5, 0.0, 3.0])
def test_the_line_of_sight_law_is_proportional_to_the_angle_off_the_nose(angle):
    for course in (0.0, 2.5, -3.0):
        north, east = 70.0 * math.cos(course + angle), 70.0 * math.sin(course + angle)
        # The proportional controller of Sim. 2. Rounding of angles.
        assert line_of_sight_law(north, east, course, 0.7) == pytest.approx(0.7 * angle, abs=1e-14)
        # On the reference it is undefined.
        assert line_of_sight_law(0.0, 0.0, course, GAIN) == 0.0


@pytest.mark.parametrize("law", [CascadeLaw, LyapunovLaw, LineOfSightLaw])
def test_a_law_refuses_parameters_that_are_not_finite_and_above_zero(law):
    for name in [field.name for field in fields(law) if field.init]:
        for value in (0.0, -1.0, math.inf, math.nan):
            with pytest.raises(ValueError, match=f"{name} is {value:g}"):
                law(**{name: value})


class Constant:
    """A law that demands what it is given."""

    def __init__(self, demand):
        self._demand = demand

    def heading_rate(self, *_):
        return self._demand


def demanded(law, course=0.0):
    reference = SimpleNamespace(north=50.0, east=0.0, course=0.0, heading_rate=0.0, speed=SPEED)
    own = Motion(0.0, 0.0, course, SPEED, 0.0)
    return LimitedLaw(law, limit=0.5, time_step=0.05).demand(reference, own, STILL_AIR)


@pytest.mark.parametrize(
    "demand", [0.3, 1, np.float32(0.25), np.array(-0.7), np.where(True, 0.5, 0.0), -math.inf]
)
def test_a_demand_is_a_plain_number_and_its_command_is_within_the_limit(demand):
    found = demanded(Constant(demand))
    assert [type(rate) for rate in found] == [float, float]
    assert found == (float(demand), min(max(float(demand), -0.5), 0.5))


class Counts:
    """A law with a memory: demands the time of its flight."""

    def start(self, time_step):
        return CountsOneFlight(time_step)


class CountsOneFlight:
    def __init__(self, time_step):
        self._time, self._time_step = 0.0, time_step

    def heading_rate(self, *_):
        self._time += self._time_step
        return self._time


def test_a_law_with_a_memory_starts_each_flight_afresh():
    law = Counts()
    for _ in range(2):
        flown = started(law, 0.25)
        assert [flown.heading_rate(), flown.heading_rate()] == [0.25, 0.5]
    without_memory = CascadeLaw()
    assert started(without_memory, 0.25) is without_memory
