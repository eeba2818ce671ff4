"""What the tests of law (24) share."""

from gnc_cases import SPEED

from gnc.paper import lyapunov_law

K_1 = 0.001
"""Gain of the tested law [1/m^2]."""


def law_24(state, omega_rho):
    return lyapunov_law(state, SPEED, omega_rho, K_1)
