import math

import pytest
from gnc_cases import SPEED, examples, make_reference, paper_oscillation
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from gnc.paper import eta_for_speed_ratio, mean_speed_ratio

# First zero of J_0, eta of a vessel at rest by (6): Abramowitz and Stegun, table 9.5.
ETA_MAX = 2.404825557695773


@pytest.mark.parametrize("eta", [0.0, 0.3, 1.0, 1.521144, 2.2, ETA_MAX])
def test_the_mean_speed_ratio_is_the_mean_of_equation_5(eta):
    mean_along, _ = quad(
        lambda angle: math.cos(eta * math.cos(angle)) / (2.0 * math.pi),
        0.0,
        2.0 * math.pi,
        epsabs=1e-13,
    )
    # Tolerance of the quadrature.
    assert mean_speed_ratio(eta) == pytest.approx(mean_along, rel=0.0, abs=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.5, 0.95])
def test_the_reference_makes_no_way_across_the_vessels_course(nu):
    # Equation (5), second line: of the reference that is flown, over a period, in steps that divide
    # it; and along it nu V_r T.
    oscillation = paper_oscillation(nu)
    reference = make_reference(oscillation, phase=0.4, time_step=oscillation.period / 400)
    north, east = reference.north, reference.east
    for _ in range(400):
        reference.step()
    # Simpson's rule, 1e-9 m a step.
    assert reference.east == pytest.approx(east, abs=1e-6)
    assert reference.north == pytest.approx(north + nu * SPEED * oscillation.period, abs=1e-6)


@examples(300)
@given(eta=st.floats(1e-3, ETA_MAX))
def test_the_speed_ratio_gives_back_eta(eta):
    # nu rounds by 1e-16, and d eta/d nu = 1/J_1(eta) <= 2000 for eta >= 0.001.
    assert eta_for_speed_ratio(max(0.0, mean_speed_ratio(eta))) == pytest.approx(
        eta, rel=0.0, abs=1e-12
    )
