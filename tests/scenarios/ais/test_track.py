"""The smooth track through reports, and what is refused of it."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import CATALOG
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.ais.synthetic import SYNTHETIC
from scenarios.world.ais.track import (
    JERK_DENSITY,
    POSITION_SIGMA,
    VELOCITY_SIGMA,
    ais_vessel,
    smooth_motion,
)

HOUR = 3600.0


def vessel(name="synthetic_danish.csv", *, utc=None, duration=HOUR, **changes):
    config = VesselConfig(track=str(CATALOG / "ais" / name), mmsi=SYNTHETIC[name], **changes)
    return ais_vessel(config, altitude=60.0, utc=utc, duration=duration, margin=5.0)


def residuals(of):
    """Return report minus smooth track of each report within the flight: north, east, and their
    rates.
    """
    return np.array(
        [
            np.subtract(report[1:], of.motion(report.time))
            for report in of.reports
            if report.time >= 0.0
        ]
    )


@pytest.mark.parametrize(
    ("name", "scatter"),
    # Errors of the made reports: 2.5 m and 0.8 m of each coordinate, and up to a second of their
    # time at 6 m/s, 1.8 m rms.
    [
        ("synthetic_danish.csv", math.sqrt(2.0) * math.hypot(2.5, 0.8, 1.3)),
        ("synthetic_marine_cadastre.csv", 0.0),
    ],
)
def test_the_track_keeps_to_the_reports_but_for_their_scatter(name, scatter):
    found = residuals(vessel(name))
    assert np.sqrt(np.mean(found[:, :2] ** 2) * 2.0) <= max(scatter, 1.0)
    assert np.hypot(found[:, 0], found[:, 1]).max() <= 5.0 + scatter
    # Speed and course as reported: 0.05 m/s of each component, and rounding of 0.1 kn and 0.1
    # degrees.
    assert np.sqrt(np.mean(found[:, 2:] ** 2)) < 0.08


def test_a_flight_may_begin_at_any_time_of_the_file_and_knows_the_reports_before():
    whole = vessel()
    later = vessel(utc=datetime(2026, 6, 1, 10, 30, tzinfo=UTC), duration=600.0)
    assert later.place.utc - whole.place.utc == pytest.approx(1800.0)
    assert -60.0 <= min(report.time for report in later.reports) <= 0.0
    # The same ship at the same time, seen from another origin; of the reports within 600 s of the
    # flight the track is made.
    apart = np.subtract(later.motion(300.0)[2:], whole.motion(2100.0)[2:])
    assert np.abs(apart).max() < 0.01
    north, east = whole.place.frame.to_local(later.place.latitude, later.place.longitude)
    assert (float(north), float(east)) == pytest.approx(whole.motion(1800.0)[:2], abs=0.05)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"duration": 5000.0},
            [
                "go from 2026-06-01T10:00:00Z (line 2) to 2026-06-01T11:",
                "the longest flight goes",
                "flight.duration_max_s",
            ],
        ),
        (
            {"utc": datetime(2026, 6, 1, 9, 0, tzinfo=UTC)},
            ["goes from 2026-06-01T09:00:00Z", "place.utc"],
        ),
        ({"gap_max_s": 15.0}, [", line ", "there is no report", "vessel.gap_max_s = 15 s"]),
    ],
)
def test_a_file_that_does_not_cover_the_flight_is_refused(changes, words):
    with pytest.raises(InputError) as refusal:
        vessel(**changes)
    for word in ["synthetic_danish.csv", *words]:
        assert word in str(refusal.value)


def test_smoothing_is_the_least_squares_solution_of_its_model():
    generator = np.random.default_rng(5)
    time = np.cumsum(generator.uniform(1.0, 90.0, 12))
    place, velocity = generator.normal(0.0, 300.0, (12, 2)), generator.normal(0.0, 3.0, (12, 2))
    smooth = smooth_motion(time, place, velocity)
    # The mean given all reports, by solving all equations at once: reports, jerk, and what is known
    # of the first state.
    equations, wanted = [], []
    for i in range(12):
        for known, sigma, seen in ((0, POSITION_SIGMA, place[i]), (1, VELOCITY_SIGMA, velocity[i])):
            row = np.zeros(36)
            row[3 * i + known] = 1.0
            equations.append(row / sigma)
            wanted.append(seen / sigma)
        if i:
            t = time[i] - time[i - 1]
            ahead = np.array([[1.0, t, 0.5 * t * t], [0.0, 1.0, t], [0.0, 0.0, 1.0]])
            noise = JERK_DENSITY * np.array(
                [
                    [t**5 / 20, t**4 / 8, t**3 / 6],
                    [t**4 / 8, t**3 / 3, t**2 / 2],
                    [t**3 / 6, t**2 / 2, t],
                ]
            )
            root = np.linalg.inv(np.linalg.cholesky(noise))
            block = np.zeros((3, 36))
            block[:, 3 * i : 3 * i + 3] = root
            block[:, 3 * i - 3 : 3 * i] = -root @ ahead
            equations.extend(block)
            wanted.extend(np.zeros((3, 2)))
        else:
            row = np.zeros(36)
            row[2] = 1.0 / 0.1
            equations.append(row)
            wanted.append(np.zeros(2))
    states, *_ = np.linalg.lstsq(np.array(equations), np.array(wanted), rcond=None)
    # Conditioned by gaps of up to 90 s: 1e-8 of the places.
    np.testing.assert_allclose(smooth(time), states[::3], rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(smooth.derivative()(time), states[1::3], rtol=0.0, atol=1e-5)
