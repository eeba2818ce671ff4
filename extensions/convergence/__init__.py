"""Global convergence of the steering laws, from many starts."""

from common.run_layout import HISTORY_SUFFIX

COUNTEREXAMPLES = "counterexamples.csv"
"""Rows of the trajectories that did not converge."""

TRAJECTORIES = "trajectories"
"""Directory of the time histories."""


def trajectory_path(law: str, number: int) -> str:
    """Return the path of the time history of a trajectory, relative to the run directory."""
    return f"{TRAJECTORIES}/{law}_{number:05d}{HISTORY_SUFFIX}"
