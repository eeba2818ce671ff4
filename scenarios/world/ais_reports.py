"""Reports of the vessel's motion, as they arrive on board: every few seconds, noisy, late, or not
at all.
"""

import math

import numpy as np

from gnc.estimation.vessel import VesselReport
from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.world.ais.track import AisVessel
from scenarios.world.vessel import VesselTruth


def received_reports(
    reports: VesselReportsConfig,
    vessel: VesselTruth,
    *,
    duration: float,
    outage: tuple[float, float],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return the reports that are received, with the time at which each is [s], in the order in
    which they are received.

    The first one, at time 0, always is: a flight begins with a vessel that is known.

    Parameters
    ----------
    reports : how they come; exact knowledge needs none of this
    vessel : its motion
    duration : of the flight [s]
    outage : nothing is received between these times [s]
    generator : of the random numbers
    """
    if isinstance(vessel, AisVessel):
        return _received_from_file(reports, vessel, outage=outage, generator=generator)
    received = []
    time = 0.0
    while time <= duration:
        late = float(generator.uniform(0.0, reports.latency_max_s)) if time > 0.0 else 0.0
        missed = bool(generator.random() < reports.missing)
        errors = generator.standard_normal(4)
        north, east, v_north, v_east = vessel.motion(time)
        report = VesselReport(
            time=time,
            north=north + reports.position_sigma_m * float(errors[0]),
            east=east + reports.position_sigma_m * float(errors[1]),
            velocity_north=v_north + reports.velocity_sigma_mps * float(errors[2]),
            velocity_east=v_east + reports.velocity_sigma_mps * float(errors[3]),
        )
        if time == 0.0 or not (missed or outage[0] <= time + late < outage[1]):
            received.append((time + late, report))
        time += float(generator.uniform(*reports.interval_s))
    return sorted(received, key=lambda entry: entry[0])


def _received_from_file(
    reports: VesselReportsConfig,
    vessel: AisVessel,
    *,
    outage: tuple[float, float],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return the file's own reports as they are received: late or missing where the scenario says
    so, but for those before.
    """
    received = []
    for report in vessel.reports:
        late = float(generator.uniform(0.0, reports.latency_max_s))
        missed = bool(generator.random() < reports.missing)
        if report.time <= 0.0:
            received.append((report.time, report))
        elif not (missed or outage[0] <= report.time + late < outage[1]):
            received.append((report.time + late, report))
    return sorted(received, key=lambda entry: entry[0])


def no_outage() -> tuple[float, float]:
    """Return an outage that never begins [s]."""
    return math.inf, math.inf
