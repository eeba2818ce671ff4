"""How fast the reference is approached, by the motion averaged over the reference's turns."""

import numpy as np
import numpy.typing as npt

from gnc.analysis.turning_reference import Array, TurningReferences
from gnc.errors import InfeasibleError
from gnc.paper import LookAhead


def averaged_settling_time(
    look_ahead: LookAhead,
    speed: float,
    references: TurningReferences,
    to_reference: npt.ArrayLike,
    distance: float,
) -> Array:
    """Return the time [s] after which d is down to ``distance``, shape (n,); 0 where it starts
    there, infinite on straight courses.

    With phi = 0 and d well below delta, only the part of d across chi_r shrinks, at V/delta.
    Averaged over the reference's courses the part along its mean course shrinks at V/(2 delta) (1 -
    m), that across it at V/(2 delta) (1 + m), with m the reference's anisotropy; in the time tau of
    d tau = V/delta dt both decay exponentially. Of a circle, m = 0, the time from d_0 to d_1 is
    [2 R ln(d_0/d_1) + epsilon (d_0^2 - d_1^2)]/V. A slow oscillation is not averaged, and near d =
    delta the expansion is rough.

    Parameters
    ----------
    look_ahead, speed : of the vehicles [m/s]
    references : of n vehicles
    to_reference : d at the start, north and east, shape (2, n) [m]
    distance : where it ends, above 0 [m]

    Raises
    ------
    InfeasibleError : ``distance`` is not above 0
    """
    if not distance > 0.0:
        raise InfeasibleError(
            f"distance is {distance:g} m; it must be above 0: exponential decay takes forever to 0"
        )
    north, east = np.asarray(to_reference, dtype=float)
    cos_m, sin_m = np.cos(references.mean_course), np.sin(references.mean_course)
    anisotropy = references.anisotropy
    parts = (north * cos_m + east * sin_m) ** 2, (east * cos_m - north * sin_m) ** 2
    rates = 1.0 - anisotropy, 1.0 + anisotropy
    target = distance * distance
    start = parts[0] + parts[1]
    settled = start <= target
    slowest = np.minimum(*rates)
    possible = (slowest > 0.0) & ~settled
    # d^2 falls in tau at slowest to 2 - slowest; bisect for where it is down to the target.
    later = np.zeros_like(start)
    np.divide(np.log(np.maximum(start / target, 1.0)), slowest, out=later, where=possible)
    earlier = np.zeros_like(start)
    for _ in range(60):
        middle = 0.5 * (earlier + later)
        above = (
            parts[0] * np.exp(-rates[0] * middle) + parts[1] * np.exp(-rates[1] * middle) > target
        )
        earlier, later = np.where(above, middle, earlier), np.where(above, later, middle)
    area = np.zeros_like(start)
    for part, rate in zip(parts, rates, strict=True):
        area += part * np.divide(-np.expm1(-rate * later), rate, out=later.copy(), where=rate > 0.0)
    time: Array = (look_ahead.radius * later + look_ahead.epsilon * area) / speed
    return np.where(settled, 0.0, np.where(possible, time, np.inf))
