"""A trial for tests of what is around the flights: kinematic, in some wind, over in seconds."""


def short_trial(*, flights, duration, histories=200, spread=10.0, rate=20.0):
    """Return a scenario file; ``duration`` in s, ``spread`` of the starts in deg, ``rate`` of the
    guidance in Hz.
    """
    return f"""
extends = "operational"
study = "flights"
title = "short"
fidelity = "kinematic"
flights = {flights}
histories = {histories}
speed_ratio = [0.1, 0.9]
guidance.rate_hz = {rate}
[[draws]]
key = "wind.speed_mps"
uniform = [0.0, 5.0]
[start]
distance_m = [400.0, 420.0]
spread_deg = {spread}
[flight]
crossings = 0
duration_max_s = {duration}
log_rate_hz = {min(rate, 10.0)}
[criteria]
required = "keep_out"
settles = false
"""
