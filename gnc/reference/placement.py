"""Where the centre of oscillation (CO) goes in the plume, so that the reference stays out of the
keep-out area.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

from gnc.errors import InfeasibleError
from gnc.reference.reference import Orbit

_ORBIT_POINTS = 7201


@dataclass(frozen=True, slots=True, kw_only=True)
class PlumeAxis:
    """Direction of the plume, seen from the vessel.

    Attributes
    ----------
    heading : chi_P, clockwise from the vessel's bow [rad]; pi is straight astern
    elevation : alpha_P, above the horizon [rad]
    """

    heading: float
    elevation: float = 0.0


def centre_of_oscillation(distance: float, axis: PlumeAxis) -> tuple[float, float, float]:
    """Return the CO at ``distance`` r_CO [m] on the axis: metres ahead of, right of and above the
    plume's origin. Equation (9).
    """
    horizontal = distance * math.cos(axis.elevation)
    return (
        horizontal * math.cos(axis.heading),
        horizontal * math.sin(axis.heading),
        distance * math.sin(axis.elevation),
    )


def reach(orbit: Orbit, axis: PlumeAxis) -> float:
    """Return d_max [m], the paper's estimate of how far the orbit reaches from the CO towards the
    vessel: equation (11).
    """
    along, across = orbit.half_widths()
    return along + (across - along) * abs(math.sin(axis.heading))


def distance_by_paper(orbit: Orbit, axis: PlumeAxis, distance_min: float) -> float:
    """Return r_CO [m] by the paper's rule, equation (10), for a keep-out sphere of radius
    ``distance_min`` r_min [m].
    """
    _check(axis, distance_min)
    return distance_min + reach(orbit, axis) * math.cos(axis.elevation)


def distance_exact(orbit: Orbit, axis: PlumeAxis, distance_min: float) -> float:
    """Return the smallest r_CO [m] for which the whole orbit stays ``distance_min`` r_min [m] away
    from the plume's origin.

    For every point o of the orbit, |r_CO u + o| >= r_min bounds r_CO from below by the larger root
    of a quadratic; the result is the largest bound. Differs from equation (10) because (11)
    overestimates the reach of all but an abeam plume: by up to 10 m for a level plume and r_min =
    200 m.

    Raises
    ------
    InfeasibleError : ``distance_min`` or the axis is out of range
    """
    _check(axis, distance_min)

    def needed(time: npt.ArrayLike) -> npt.NDArray[np.float64]:
        along, across = orbit.offset(time)
        towards = math.cos(axis.elevation) * (
            along * math.cos(axis.heading) + across * math.sin(axis.heading)
        )
        inside = towards**2 - along**2 - across**2 + distance_min**2
        # Where the root is imaginary, the line through that point never enters the sphere.
        return np.where(inside >= 0.0, -towards + np.sqrt(np.maximum(inside, 0.0)), 0.0)

    times = np.linspace(0.0, orbit.period, _ORBIT_POINTS)
    step = float(times[1])
    coarse = float(times[np.argmax(needed(times))])
    fine = minimize_scalar(
        lambda t: -float(needed(t)), bounds=(coarse - step, coarse + step), method="bounded"
    )
    return max(-float(fine.fun), 0.0)


def _check(axis: PlumeAxis, distance_min: float) -> None:
    if not (math.isfinite(distance_min) and distance_min >= 0.0):
        raise InfeasibleError(
            f"keep-out radius is {distance_min:g} m; it must be finite and at least 0"
        )
    if not math.isfinite(axis.heading):
        raise InfeasibleError(f"plume heading is {axis.heading:g} rad; it must be finite")
    if not abs(axis.elevation) < 0.5 * math.pi:
        raise InfeasibleError(
            f"plume elevation is {axis.elevation:g} rad; it must lie within -pi/2 and pi/2: a vertical plume cannot be crossed"
        )
