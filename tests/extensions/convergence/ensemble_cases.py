"""What the tests of the ensembles share: a vehicle, references and flights of many trajectories at
once.
"""

import math

import numpy as np
from gnc_cases import HEADING_RATE_MAX, LOOK_AHEAD, OSCILLATION, SPEED
from lyapunov_cases import K_1

from extensions.convergence.ensemble import Tolerances, fly_ensemble
from extensions.convergence.motion import Vehicle
from extensions.convergence.references import TurningReferences

GAIN, STEERING_MAX = 1.5, 0.4
VEHICLE = Vehicle(
    speed=SPEED,
    look_ahead=LOOK_AHEAD,
    gain=GAIN,
    steering_max=STEERING_MAX,
    k_1=K_1,
    heading_rate_max=HEADING_RATE_MAX,
)
BAND = 5.0
TIGHT = Tolerances(relative=1e-10, absolute=1e-9)


def references(*, course=(0.0,), rate=(0.0,), terms=()):
    """References that share their terms of amplitude, frequency and phase."""
    count = len(course)
    columns = np.array(terms, dtype=float).reshape(-1, 3)
    amplitude, frequency, phase = (
        np.repeat(column[:, None], count, axis=1) for column in columns.T
    )
    return TurningReferences(
        course=course, rate=rate, amplitude=amplitude, frequency=frequency, phase=phase
    )


def oscillating(phase=0.7):
    term = (-OSCILLATION.amplitude, OSCILLATION.omega_0, phase)
    return references(course=[OSCILLATION.eta * math.cos(phase)], terms=[term])


def wandering():
    return references(course=[1.0], terms=[(0.1, 0.07, 0.3), (0.2, 0.31, -2.0), (0.05, 0.9, 1.5)])


def fly(law, refs, to_reference, course, **changes):
    settings = {"settling_band": BAND, "time_max": 3000.0} | changes
    return fly_ensemble(law, VEHICLE, refs, to_reference=to_reference, course=course, **settings)


def history(law, refs, to_reference, course, **changes):
    """Fly one trajectory; return its result, times, states and phis."""
    rows = []

    def observe(_, time, state, phi, command):
        rows.append((time[0], state[:, 0].copy(), phi[0], command[0]))

    result = fly(
        law, refs, [[to_reference[0]], [to_reference[1]]], [course], observe=observe, **changes
    )
    time, state, phi, command = zip(*rows, strict=True)
    return result, np.array(time), np.array(state), np.array(phi), np.array(command)
