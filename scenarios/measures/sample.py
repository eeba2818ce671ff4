"""Numbers of a sample."""

import numpy as np
import numpy.typing as npt


def rms(values: npt.NDArray[np.float64]) -> float:
    """Return the root of the mean square of ``values``, in their unit; not a number if there are
    none.
    """
    return float(np.sqrt(np.mean(values**2)))
