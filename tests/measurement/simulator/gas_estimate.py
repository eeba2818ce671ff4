"""The simulated logs of gases in the form of ``measurement``, and their estimate."""

from datetime import date
from typing import Any

import numpy as np

from measurement.engine import Engine
from measurement.estimate.gas import GasEstimate, estimate_gas, nox_of, placed
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from measurement.species import SPECIES
from tests.measurement.simulator.gases import GasLog

AIR = (20.0, 1013.25)
"""State of the air that particles are counted in, as stated."""


def engine_of(given: dict[str, Any]) -> Engine:
    """Return an engine by what is known of it."""
    return Engine(**given | {"keel_laid": date.fromisoformat(given["keel_laid"])})


def estimate_log(kind: str, log: GasLog) -> GasEstimate:
    """Return the estimate of a simulated log."""
    values = np.full((len(log.time), len(GASES)), np.nan)
    channels = []
    for gas, column in log.values.items():
        if gas in GASES:
            values[:, GASES.index(gas)] = column
            channels.append(Channel(gas=gas, **log.stated[gas]))
    spec = SnifferSpec(name="test", title="test", rate_hz=1.0, channels=tuple(channels))
    readings = Readings(log.time, values)
    if kind == "nox":
        gas_readings = nox_of(readings, spec)
        assert gas_readings is not None
    else:
        channel = Channel(gas="so2", **log.stated[kind])
        gas_readings = placed(SPECIES[kind], channel, log.values[kind], readings, spec)
    engine = engine_of(log.engine) if log.engine else None
    return estimate_gas(gas_readings, air=AIR, engine=engine)
