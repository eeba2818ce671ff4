"""Low-altitude turbulence of MIL-F-8785C as filters that shape white noise: the disturbance of the
linear closed loop.

Intensities and scale lengths are those of ``aircraft.weather``; the filters are the
factors of its Dryden spectra, section 3.7.1.2, with the rotations as JSBSim has them (Yeager, NASA
CR-1998-206937): p is independent, q and r are the slopes along the path of w and v, seen by a wing
of some span. JSBSim's ``atmosphere/turb-type`` 4 is this, in Tustin's steps.
"""

import math

import control
import numpy as np

from innerloop.analysis.gust_response import GUSTS
from innerloop.analysis.gust_statistics import GustStatistics


def dryden_filters(
    turbulence: GustStatistics, *, airspeed: float, span: float
) -> control.StateSpace:
    """Return the filters from four white noises of intensity 1 (of u, v, w and p) to ``GUSTS``.

    The standard deviation of each output is that of the gust, so that the covariance is the
    Lyapunov equation's solution.

    Parameters
    ----------
    turbulence : its intensities and scale lengths
    airspeed : at which it is flown through [m/s]
    span : of the wing, which averages rotations [m]
    """
    along = turbulence.horizontal_length / airspeed
    down = turbulence.vertical_length / airspeed
    reach = math.sqrt(turbulence.vertical_length * span)
    rolling = reach / 2.6 / airspeed
    u = _lag(turbulence.horizontal * math.sqrt(2.0 * along), along)
    v, w = _transverse(turbulence.horizontal, along), _transverse(turbulence.vertical, down)
    p = _lag(1.9 * turbulence.vertical / reach * math.sqrt(2.0 * rolling), rolling)
    q, r = (
        control.tf([1.0 / airspeed, 0.0], [share * span / (math.pi * airspeed), 1.0])
        for share in (4.0, 3.0)
    )
    blocks = [
        _named(u, "noise_u", "u"),
        _named(v, "noise_v", "v"),
        _named(w, "noise_w", "w"),
        _named(p, "noise_p", "p"),
    ]
    blocks += [_named(q, "w", "q"), _named(r, "v", "r")]
    signals = [name for block in blocks for name in (*block.input_labels, *block.output_labels)]
    together = control.interconnect(
        blocks,
        inputs=[name for name in dict.fromkeys(signals) if name.startswith("noise")],
        outputs=list("uvwpqr"),
        name="turbulence",
    )
    together.update_names(outputs=list(GUSTS))
    return together


def _lag(gain: float, time: float) -> control.TransferFunction:
    return control.tf([gain], [time, 1.0])


def _transverse(deviation: float, time: float) -> control.TransferFunction:
    """Return the filter of a gust across the path: sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2."""
    gain = deviation * math.sqrt(time)
    return control.tf([gain * math.sqrt(3.0) * time, gain], np.polymul([time, 1.0], [time, 1.0]))


def _named(system: control.TransferFunction, source: str, name: str) -> control.StateSpace:
    return control.ss(control.tf2ss(system), inputs=[source], outputs=[name], name=f"{name}_filter")
