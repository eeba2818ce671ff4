"""What the tests of reachable sets share: vessels that do the worst they may, and their reports
with errors, late or lost.
"""

import math
from dataclasses import dataclass, field

from gnc.estimation.vessel import VesselLimits, VesselReport

LIMITS = VesselLimits(
    acceleration=0.25,
    speed_max=15.0,
    position_sigma=5.0,
    velocity_sigma=0.15,
    deviations=5.0,
    horizon=9.0,
)


@dataclass
class Vessel:
    """A vessel in double integrals of its acceleration, which is cut where it would exceed its
    largest speed.
    """

    north: float = 0.0
    east: float = 0.0
    velocity_north: float = 0.0
    velocity_east: float = 0.0
    limits: VesselLimits = LIMITS

    def accelerate(self, north, east, duration):
        """Move on under a demanded acceleration [m/s^2], of which it does what its limits leave,
        exactly.
        """
        limits, before = self.limits, complex(self.velocity_north, self.velocity_east)
        share = min(1.0, limits.acceleration / max(math.hypot(north, east), 1e-300))
        after = before + share * complex(north, east) * duration
        if abs(after) > limits.speed_max:
            # To the largest speed in that direction, if that is within its acceleration; else it
            # goes straight on.
            after *= limits.speed_max / abs(after) * (1.0 - 1e-12)
            if abs(after - before) > limits.acceleration * duration:
                after = before
        self.north += 0.5 * (before.real + after.real) * duration
        self.east += 0.5 * (before.imag + after.imag) * duration
        self.velocity_north, self.velocity_east = after.real, after.imag


def report_of(vessel, time, *, split=0.0, place=0.0, drift=0.0):
    """Return a report whose errors are the largest that are allowed for.

    Errors of place and velocity within (e_p/sigma_p)^2 + (e_v/sigma_v)^2 <= k^2 add up to no more
    than k hypot(sigma_p, sigma_v s) after s seconds (Cauchy and Schwarz). ``split`` is the angle
    between all of the error in place, 0, and all of it in velocity, pi/2 [rad]; place and drift are
    the direction of either [rad].
    """
    limits = vessel.limits
    error = limits.deviations * limits.position_sigma * math.cos(split)
    slip = limits.deviations * limits.velocity_sigma * math.sin(split)
    return VesselReport(
        time,
        vessel.north + error * math.cos(place),
        vessel.east + error * math.sin(place),
        vessel.velocity_north + slip * math.cos(drift),
        vessel.velocity_east + slip * math.sin(drift),
    )


def radio(generator, *, interval, latency, missing, silences, duration):
    """Return times of reports and of their arrival [s], in the order of arrival: some late, some
    lost, none in a silence.
    """
    time, sent = 0.0, [(0.0, 0.0)]
    while time < duration:
        time += float(generator.uniform(*interval))
        arrives = time + float(generator.uniform(0.0, latency))
        if generator.uniform() >= missing and not any(
            begin <= time < end for begin, end in silences
        ):
            sent.append((time, arrives))
    return sorted(sent, key=lambda entry: entry[1])


@dataclass
class Mailbox:
    """Reports that are under way to somebody."""

    waiting: list = field(default_factory=list)

    def send(self, arrives, report):
        self.waiting.append((arrives, report))

    def deliver(self, time):
        """Return the reports that have arrived by ``time`` [s]."""
        arrived = [report for arrives, report in self.waiting if arrives <= time]
        self.waiting = [entry for entry in self.waiting if entry[0] > time]
        return arrived
