"""A smooth motion through positions and velocities that were reported at some times, with errors."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from scipy.interpolate import BPoly

Array = npt.NDArray[np.float64]

POSITION_SIGMA, VELOCITY_SIGMA = 5.0, 0.15
"""Errors of a report that the motion is smoothed by, one sigma: satellite navigation on board,
whose fix is up to a second old [m, m/s]."""

JERK_DENSITY = 5e-4
"""Density of the white noise that the rate of acceleration is taken for: in 20 s a ship's
acceleration changes by 0.1 m/s^2 and more [m^2/s^5]."""


def smooth_motion(time: Array, place: Array, velocity: Array) -> "BPoly":
    """Return place over time: of degree 5 between reports, with continuous velocity and
    acceleration.

    It is the mean of a motion whose jerk is white noise, given all reports (H. E. Rauch, F. Tung,
    C. T. Striebel, AIAA J. 3:1445, 1965): between two reports that mean is the polynomial of degree
    5 through both smoothed states.

    Parameters
    ----------
    time : of the reports, rising, shape (n,) [s]
    place, velocity : as reported, shape (n, 2) [m, m/s]
    """
    from scipy.interpolate import BPoly

    filtered, predicted = [], []
    # Nothing is known of the acceleration at first but that it is a ship's.
    state = np.stack([place[0], velocity[0], np.zeros(2)])
    covariance = np.diag([POSITION_SIGMA**2, VELOCITY_SIGMA**2, 0.1**2])
    errors = np.diag([POSITION_SIGMA**2, VELOCITY_SIGMA**2])
    for i, step in enumerate(np.diff(time, prepend=time[0]).tolist()):
        transition = _transition(step)
        if i:
            state = transition @ state
            covariance = transition @ covariance @ transition.T + _noise(step)
            predicted.append((state, covariance, transition))
            gain = np.linalg.solve(covariance[:2, :2] + errors, covariance[:2]).T
            state = state + gain @ (np.stack([place[i], velocity[i]]) - state[:2])
            left = np.eye(3) - gain @ np.eye(2, 3)
            # Joseph's form: it stays positive definite where a gap has made the covariance large.
            covariance = left @ covariance @ left.T + gain @ errors @ gain.T
        filtered.append((state, covariance))
    smoothed = [state]
    for (state_before, covariance_before), (ahead, ahead_covariance, transition) in zip(
        reversed(filtered[:-1]), reversed(predicted), strict=True
    ):
        gain = np.linalg.solve(ahead_covariance, transition @ covariance_before).T
        smoothed.append(state_before + gain @ (smoothed[-1] - ahead))
    return BPoly.from_derivatives(time, np.stack(smoothed[::-1]))


def _transition(step: float) -> Array:
    return np.array([[1.0, step, 0.5 * step**2], [0.0, 1.0, step], [0.0, 0.0, 1.0]])


def _noise(step: float) -> Array:
    """Return the covariance that white jerk adds in a time step (Bar-Shalom et al., Estimation with
    Applications, 6.2.3).
    """
    t = step
    return JERK_DENSITY * np.array(
        [
            [t**5 / 20.0, t**4 / 8.0, t**3 / 6.0],
            [t**4 / 8.0, t**3 / 3.0, t**2 / 2.0],
            [t**3 / 6.0, t**2 / 2.0, t],
        ]
    )
