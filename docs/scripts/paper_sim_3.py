"""The paper's Simulation 3: a vessel at nu = 0.5, a reference that oscillates astern of it, and a
vehicle under law (30). Numbers in brackets are those of equations; see ``gnc/paper.py``.
"""

import math

import numpy as np

from gnc.paper import (
    PlumeAxis,
    cascade_law,
    centre_of_oscillation,
    design_oscillation,
    distance_by_paper,
    look_ahead,
    relative_state,
    relative_velocity,
    unicycle_rates,
)

V_R, OMEGA_MAX, NU, R_MIN = 19.42, 0.503, 0.5, 200.0  # m/s, rad/s, -, m
STEP, DURATION = 0.05, 300.0  # s
GAIN, STEERING_MAX = 1.5, 0.4  # 1/s, rad/s


def simulate() -> tuple[float, float, float]:
    """Return crossing interval [s], distance r_CO [m] and closest approach to the vessel [m]."""
    orbit = design_oscillation(nu=NU, speed=V_R, heading_rate_max=OMEGA_MAX)  # (6), (8)
    astern = PlumeAxis(heading=math.pi)
    r_co = distance_by_paper(orbit, astern, R_MIN)  # (10) to (12)
    ahead, right, _ = centre_of_oscillation(r_co, astern)  # (9)
    delta = look_ahead(0.005, 60.0)  # (15)

    vessel, vehicle = np.zeros(2), np.array([-600.0, 150.0, 0.4])
    reference, chi_r = np.array([ahead, right]), orbit.course(0.0)  # (7)
    closest = math.inf
    for k in range(round(DURATION / STEP)):
        omega_r = orbit.heading_rate(orbit.omega_0 * k * STEP)  # (2)
        north, east = reference - vehicle[:2]
        state = relative_state(delta, north, east, chi_r, vehicle[2])  # (14), (16), (19)
        _, omega_rho = relative_velocity(delta, state, V_R, V_R, omega_r)  # (18)
        omega = cascade_law(state.phi, omega_rho, GAIN, STEERING_MAX)  # (30)
        omega = min(max(omega, -OMEGA_MAX), OMEGA_MAX)
        vehicle += STEP * np.array(
            unicycle_rates(V_R, vehicle[2] + 0.5 * STEP * omega, omega)
        )  # (1)
        reference += STEP * np.array(orbit.velocity(orbit.omega_0 * (k + 0.5) * STEP))  # (4)
        chi_r = orbit.course(orbit.omega_0 * (k + 1) * STEP)  # (3)
        vessel += STEP * np.array([NU * V_R, 0.0])
        closest = min(closest, math.dist(vehicle[:2], vessel))
    return orbit.crossing_interval, r_co, closest


if __name__ == "__main__":
    interval, r_co, closest = simulate()
    print(f"crosses the plume every {interval:.1f} s at {r_co:.0f} m from the vessel")
    print(f"closest approach to the vessel: {closest:.1f} m")
