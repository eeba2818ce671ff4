"""Amplitude and orbit of a steered reference, from tables: they are needed while it flies."""

import bisect
import math

import numpy as np

from gnc.numeric import clip
from gnc.reference.reference import Array

SPEED_RATIO_MIN = -0.2
"""Least mean speed over speed in the tables [-]: a reference may back away from its vessel at a
fifth of its speed.
"""

ETA_STEP = 0.005
"""Step of the tables [rad], between whose rows values are linear: good to its square over 8, 3e-6,
times a curvature up to 1.
"""


class OrbitTables:
    """Mean speed and orbit of the courses of a shape over their amplitude eta, which are those of
    their Fourier series.

    Parameters
    ----------
    ratios : mean speed over speed at equal steps ``ETA_STEP`` of eta from 0, falling to below
        ``SPEED_RATIO_MIN``, shape (n,) [-]
    series : coefficients of sin(theta), sin(2 theta), ... in the orbit, rightward and along in
        turn, shape (n, 2 terms)
    """

    __slots__ = ("_eta_last", "_etas", "_missing", "_rows")

    def __init__(self, ratios: Array, series: Array) -> None:
        etas = ETA_STEP * np.arange(len(ratios))
        missing = np.sqrt(np.maximum(0.0, 1.0 - ratios))
        kept = missing <= math.sqrt(1.0 - SPEED_RATIO_MIN)
        self._missing: list[float] = missing[kept].tolist()
        self._etas: list[float] = etas[kept].tolist()
        self._rows: list[list[float]] = series.tolist()
        # So that there is a row after it, however its place among the rows is rounded.
        self._eta_last = ETA_STEP * (len(ratios) - 3)

    def eta(self, speed_ratio: float) -> float:
        """Return eta [rad] for a mean speed over speed; ratios outside of the table are those of
        its nearest end.
        """
        missing, etas = self._missing, self._etas
        if speed_ratio >= 1.0:
            return 0.0
        # Near 1 what is missing goes with the square of eta, so that eta is smooth over its root.
        root = math.sqrt(1.0 - speed_ratio)
        i = min(max(bisect.bisect(missing, root), 1), len(missing) - 1)
        fraction = min(1.0, (root - missing[i - 1]) / (missing[i] - missing[i - 1]))
        return etas[i - 1] + fraction * (etas[i] - etas[i - 1])

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return where the reference is from the orbit's centre, along the mean course and to its
        right.

        Parameters
        ----------
        eta, phase : amplitude and theta [rad]

        Returns
        -------
        along, right : in units of V_r/omega_0
        """
        row = clip(eta, 0.0, self._eta_last) / ETA_STEP
        i = int(row)
        fraction = row - i
        low, high = self._rows[i], self._rows[i + 1]
        along = right = 0.0
        for k in range(0, len(low), 2):
            odd = low[k] + fraction * (high[k] - low[k])
            even = low[k + 1] + fraction * (high[k + 1] - low[k + 1])
            right += odd * math.sin((k + 1) * phase)
            along += even * math.sin((k + 2) * phase)
        return along, right
