"""Writes example_flight.csv beside it: the log of a simulated flight with the electrochemical
sniffer, in the form of a log of a real flight.

The UAV swings across a plume every 9.5 s, 220 m behind a ship that sails north at 6 m/s. The plume
is a Gaussian of 9 m that meanders by 8 m and 4 m between passes; the ratio of its SO2 to its CO2 is
that of 0.25 % of sulphur.
"""

import math
from pathlib import Path

import numpy as np
import pandas as pd

from measurement.gases import GASES, UNITS, fsc_factor
from measurement.sniffer.sniffer import Sniffer
from measurement.sniffer.spec import sensor_preset

SEED, FSC_PERCENT = 5, 0.25
DURATION_S, STEP_S, INTERVAL_S = 300.0, 0.1, 9.5
WIDTH_M, MEANDER_M, AXIS_PPM = 9.0, (8.0, 4.0), 170.0


def main() -> None:
    """Simulate the flight and write it."""
    generator = np.random.default_rng(SEED)
    time = np.arange(0.0, DURATION_S + STEP_S / 2.0, STEP_S)
    swing = math.pi * time / INTERVAL_S
    across, astern = 55.0 * np.sin(swing), 220.0 + 18.0 * np.cos(2.0 * swing)
    height = 57.0 + np.interp(time, time[::50], generator.normal(0.0, 1.0, len(time[::50])))
    knots = np.arange(0.0, DURATION_S + INTERVAL_S, INTERVAL_S)
    axis = [
        np.interp(time, knots, generator.normal(0.0, meander, len(knots))) for meander in MEANDER_M
    ]
    distance = np.hypot(across - axis[0], height - 57.0 - axis[1])
    co2 = AXIS_PPM * np.exp(-0.5 * (distance / WIDTH_M) ** 2)
    # NO and NO2 of an engine of tier II: 23 ppb of NOx per ppm of CO2, a tenth of it NO2.
    ratio = np.array([FSC_PERCENT / fsc_factor(), 1.0, 20.7, 2.3])
    air = np.array([0.5, 421.0, 0.3, 2.0]) + co2[:, np.newaxis] * ratio
    instrument = sensor_preset("electrochemical").drawn(generator)
    readings = Sniffer(instrument, generator=generator, time_step=STEP_S).advance(air)
    places = {"north_m": 6.0 * time - astern, "east_m": across, "height_m": height}
    table = {"time_s": readings.time}
    table |= {f"{gas}_{UNITS[gas]}": readings.values[:, i].round(1) for i, gas in enumerate(GASES)}
    table |= {
        name: np.interp(readings.time, time, place).round(1) for name, place in places.items()
    }
    for i, gas in ((0, "so2"), (1, "co2")):
        table[f"{gas}_true_{UNITS[gas]}"] = np.interp(readings.time, time, air[:, i]).round(2)
    pd.DataFrame(table).to_csv(
        Path(__file__).parent / "example_flight.csv", index=False, lineterminator="\n"
    )


if __name__ == "__main__":
    main()
