"""The paper's Simulation 3 on one page: a vessel at nu = 0.5, an oscillating reference astern, and
a vehicle under law (30).
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
)  # fmt: skip

V_R, OMEGA_MAX, NU, R_MIN = 19.42, 0.503, 0.5, 200.0
STEP, DURATION = 0.05, 300.0
GAIN, STEERING_MAX = 1.5, 0.4


def simulate() -> tuple[float, float, float]:
    """Return crossing interval [s], distance of the centre of oscillation and closest approach to
    the vessel [m].
    """
    orbit = design_oscillation(nu=NU, speed=V_R, heading_rate_max=OMEGA_MAX)  # (6), (8)
    astern = PlumeAxis(heading=math.pi)
    r_co = distance_by_paper(orbit, astern, R_MIN)  # (10), (11), (12)
    ahead, right, _ = centre_of_oscillation(r_co, astern)  # (9)
    parameters = look_ahead(0.005, 60.0)  # (15)

    vessel = np.zeros(2)
    reference, reference_course = np.array([ahead, right]), orbit.course(0.0)  # (7)
    vehicle = np.array([-600.0, 150.0, 0.4])
    distances = []
    for k in range(round(DURATION / STEP)):
        reference_rate = orbit.heading_rate(orbit.omega_0 * k * STEP)  # (2)
        north, east = reference - vehicle[:2]
        state = relative_state(
            parameters, north, east, reference_course, vehicle[2]
        )  # (14), (16), (19)
        _, omega_rho = relative_velocity(
            parameters, state, V_R, V_R, reference_rate
        )  # (17), (18), (20)
        omega = cascade_law(state.phi, omega_rho, GAIN, STEERING_MAX)  # (30)
        omega = min(max(omega, -OMEGA_MAX), OMEGA_MAX)
        vehicle += STEP * np.array(
            unicycle_rates(V_R, vehicle[2] + 0.5 * STEP * omega, omega)
        )  # (1)
        north_rate, east_rate, _ = unicycle_rates(
            V_R, reference_course + 0.5 * STEP * reference_rate, reference_rate
        )  # (13)
        reference += STEP * np.array([north_rate, east_rate])
        reference_course = orbit.course(orbit.omega_0 * (k + 1) * STEP)  # (3)
        vessel += STEP * np.array([NU * V_R, 0.0])
        distances.append(math.dist(vehicle[:2], vessel))
    return orbit.crossing_interval, r_co, min(distances)


if __name__ == "__main__":
    interval, r_co, closest = simulate()
    print(
        f"crosses the plume every {interval:.1f} s at {r_co:.0f} m; closest approach to the vessel {closest:.1f} m"
    )
