"""What the tests of the actuation bounds share."""

from gnc_cases import SPEED

from gnc.analysis.bounds import convergence_time, fastest_within

# omega_max of the tables of docs/actuation_bounds.md; paper-notes give 0.503.
LIMIT = 0.505


def fastest(reserve, *, distance_from=500.0, limit=LIMIT):
    return fastest_within(
        speed=SPEED,
        heading_rate_max=limit,
        reference_heading_rate_max=(1.0 - reserve) * limit,
        distance_from=distance_from,
        distance_to=5.0,
        gain=1.5,
    )


def time_of(parameters, steering_max, *, distance_from=500.0):
    return convergence_time(
        parameters, speed=SPEED, distance_from=distance_from, distance_to=5.0, gain=1.5, steering_max=steering_max
    )
