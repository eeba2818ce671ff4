"""Reports of the vessel's motion, as they arrive on board: every few seconds, noisy, late, or not at all."""

import math

import numpy as np

from gnc.estimation.vessel_filter import VesselReport
from scenarios.schema.sea_config import Reports
from scenarios.world.vessel import VesselTrack


def heard_reports(
    reports: Reports,
    track: VesselTrack,
    *,
    duration: float,
    silence: tuple[float, float],
    generator: np.random.Generator,
) -> list[tuple[float, VesselReport]]:
    """Return the reports that are heard, with the time at which each is [s], in order of hearing.

    The first one, at time 0, always is: a flight begins with a vessel that is known.

    Parameters
    ----------
    reports : how they come; exact knowledge needs none of this
    track : the vessel's
    duration : of the flight [s]
    silence : nothing is heard between these times [s]
    generator : of the random numbers
    """
    heard = []
    time = 0.0
    while time <= duration:
        late = float(generator.uniform(0.0, reports.latency_max_s)) if time > 0.0 else 0.0
        missed = bool(generator.random() < reports.missing)
        errors = generator.standard_normal(4)
        north, east, v_north, v_east = track.motion(time)
        report = VesselReport(
            time=time,
            north=north + reports.position_sigma_m * float(errors[0]),
            east=east + reports.position_sigma_m * float(errors[1]),
            velocity_north=v_north + reports.velocity_sigma_mps * float(errors[2]),
            velocity_east=v_east + reports.velocity_sigma_mps * float(errors[3]),
        )
        if time == 0.0 or not (missed or silence[0] <= time + late < silence[1]):
            heard.append((time + late, report))
        time += float(generator.uniform(*reports.interval_s))
    return sorted(heard, key=lambda entry: entry[0])


def never() -> tuple[float, float]:
    """Return a silence that never comes [s]."""
    return math.inf, math.inf
