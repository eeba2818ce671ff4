"""Logs of zero and span gas, by another integration than that of ``measurement``."""

from datetime import UTC, datetime

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from measurement.log.calibration import calibrate

START = datetime(2026, 6, 1, 9, 0, tzinfo=UTC)


def zero_and_span(
    path,
    *,
    seed=0,
    gas="so2",
    span=200.0,
    gain=0.95,
    drift_per_h=0.0,
    t90=8.0,
    delay=1.5,
    noise=2.5,
    leak=0.0,
    tail=0.0,
):
    """Write a log of zero and span gas, five minutes each; zero gas reads 3."""
    generator, step, seconds = np.random.default_rng(seed), 0.02, 1800.0
    time, fine = np.arange(seconds), np.arange(0.0, seconds, step)

    def supplied(t):
        return np.where((t % 600.0) < 300.0, 0.0, span)

    def lag(signal, constant):
        kept = np.exp(-step / constant)
        return lfilter([1.0 - kept], [1.0, -kept], signal)

    inlet = (1.0 - leak) * supplied(np.maximum(fine - delay, 0.0))
    seen = (1.0 - tail) * lag(inlet, t90 / np.log(10.0)) + tail * lag(inlet, 60.0)
    read = np.interp(time, fine, seen)
    read = read * (gain + drift_per_h * (time - seconds / 2.0) / 3600.0) + 3.0
    read += noise * generator.standard_normal(len(time))
    table = {"time_s": time, f"{gas}_ppb": read.round(2), f"{gas}_supplied_ppb": supplied(time)}
    pd.DataFrame(table).to_csv(path, index=False)
    return path


def calibrated(path, at=START, instrument="electrochemical", **log):
    """Return the calibration of such a log."""
    return calibrate(zero_and_span(path, **log), instrument=instrument, serial="7", time_utc=at)
