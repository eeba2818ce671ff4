"""Passes through a plume: how well it was hit, and for how long."""

import math

import numpy as np
import numpy.typing as npt

from common.columns import Column, described
from measurement.plume.fluctuating_plume import HIT, PlumeSample, passes

Array = npt.NDArray[np.float64]

INSIDE = math.exp(-2.0)
"""Concentration over that of the axis from which a place counts as inside the plume [-]: two
spreads from the axis.
"""


PASS_FIGURES = described(
    {
        "plume_axis_crossings": "crossings of the smoke's mean axis seen from above, in the time evaluated, with smoke or without",
        "smoke_passes": "of those crossings the ones with smoke: once above exp(-2) of the concentration in the plume's centre",
        "hit_rate": Column(
            "of those crossings the share whose peak is above 0.6 of the concentration in the centre of the plume",
            title="Hit rate",
        ),
        "seconds_in_plume_s": "time in which the concentration is above exp(-2) of that on the axis",
        "dose_per_pass_ppm_s": "mean over plume_axis_crossings, with smoke or without, of the integral of CO2 above clean air",
        "axis_height_error_mean_m": "mean height of plume_axis_crossings above the plume's own axis",
        "axis_height_error_rms_m": "root mean square height of plume_axis_crossings above the plume's own axis",
    }
)
"""Columns of the summary."""


def fraction_of_axis(plume: PlumeSample) -> Array:
    """Return the concentration over that in the centre of the plume's cross-section; 0 where there
    is no plume.
    """
    inside = plume.axis_dilution > 0.0
    return np.divide(
        plume.dilution, plume.axis_dilution, out=np.zeros_like(plume.dilution), where=inside
    )


def pass_figures(
    across: Array, above: Array, fraction: Array, excess_co2: Array, *, time_step: float
) -> dict[str, float]:
    """Return figures of the passes of a flight.

    A change of sides of the plume's mean axis, seen from above, is a crossing, with smoke there or
    without: the UAV may be above or below the plume, and the plume may have meandered away. Of
    these passes those count as passes through smoke in which the UAV was inside the plume, as
    ``INSIDE`` says, at one sample at least.

    Parameters
    ----------
    across, above : from the plume's axis, not a number where there is no plume, shape (n,) [m]
    fraction : as of ``fraction_of_axis``
    excess_co2 : above clean air [ppm]
    time_step : between samples [s]
    """
    found = list(passes(across))
    inside = float(time_step * np.count_nonzero(fraction > INSIDE))
    if not found:
        return {"plume_axis_crossings": 0, "smoke_passes": 0, "seconds_in_plume_s": inside}
    peaks = np.array([np.max(fraction[at]) for at in found])
    error = above[[at.start + int(np.nanargmin(np.abs(across[at]))) for at in found]]
    return {
        "plume_axis_crossings": len(found),
        "smoke_passes": int(np.count_nonzero(peaks > INSIDE)),
        "hit_rate": float(np.mean(peaks > HIT)),
        "seconds_in_plume_s": inside,
        "dose_per_pass_ppm_s": float(time_step * np.sum(excess_co2) / len(found)),
        "axis_height_error_mean_m": float(np.mean(error)),
        "axis_height_error_rms_m": float(np.sqrt(np.mean(error**2))),
    }
