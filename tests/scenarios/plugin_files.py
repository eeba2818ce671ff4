"""Packages of one file, each with one part: what someone would write who adds it."""

LAW = '''
"""Pursuit of a point ahead of the reference."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Pursuit:
    pursuit_gain_per_s: float = 1.2
    lead_s: float = 1.0

    def heading_rate(self, reference, own, air):
        lead = self.lead_s * reference.speed
        sight = math.atan2(
            reference.east - own.east + lead * math.sin(reference.course),
            reference.north - own.north + lead * math.cos(reference.course),
        )
        off = math.remainder(sight - own.course, math.tau)
        return self.pursuit_gain_per_s * off + reference.heading_rate
'''

PLUME = '''
"""A plume that trails 10 degrees to starboard of the vessel's wake."""

import math


class Slanted:
    def __init__(self, plume, vessel, wind, duration, *, by_wind):
        self._vessel = vessel

    def axis(self, time):
        return self._vessel.course(time) + math.radians(190.0)
'''

TRACK = '''
"""A vessel that weaves by 10 degrees about its course."""

import math


class Weaving:
    manoeuvres_end = math.nan

    def __init__(self, vessel, speed, duration):
        self._speed, self._swing, self._rate = speed, math.radians(10.0), 0.02

    def course(self, time):
        return self._swing * math.sin(self._rate * time)

    def motion(self, time):
        # To first order in the swing, so that place and velocity agree.
        v, east = self._speed, self._speed * self._swing
        place = v * time, east / self._rate * (1.0 - math.cos(self._rate * time))
        return *place, v, east * math.sin(self._rate * time)
'''

INSTRUMENT = '''
"""A sulphur dioxide sensor: more of it near the plume's axis."""

import math


class Sniffer:
    COLUMNS = ("so2_ppb",)

    def __init__(self, scenario, world, generator):
        self._world, self._generator = world, generator

    def read(self, time, motion, sample):
        vessel_north, vessel_east, _, _ = self._world.vessel.motion(time)
        axis = self._world.plume.axis(time)
        across = (motion[1] - vessel_east) * math.cos(axis) - (motion[0] - vessel_north) * math.sin(axis)
        return (100.0 * math.exp(-((across / 20.0) ** 2)) + self._generator.normal(),)
'''

AIRCRAFT = '''
"""An X8 that cruises at 19.1 m/s."""

from dataclasses import replace

from aircraft.fleet.x8 import X8

SLOW_X8 = replace(X8, name="slow_x8", title="Slow X8", envelope=replace(X8.envelope, airspeed=19.1))
'''

FILES = {
    "law.py": LAW,
    "plume.py": PLUME,
    "track.py": TRACK,
    "instrument.py": INSTRUMENT,
    "aeroplane.py": AIRCRAFT,
}

PARTS = {
    "guidance.law": "law.py:Pursuit",
    "plume.model": "plume.py:Slanted",
    "vessel.track": "track.py:Weaving",
    "payload": "instrument.py:Sniffer",
    "aircraft": "aeroplane.py:SLOW_X8",
}
"""The key that takes each part, and its name."""

SHORT = """
title = "parts of others"
fidelity = "kinematic"
sweep.nu = [0.3, 0.5]
guidance.rate_hz = 5.0
flight.log_rate_hz = 5.0
flight.crossings = 2
criteria.crossing_interval_error = 0.2
start.spread_deg = 10.0
"""


def write_scenario(folder, lines, text=None):
    """Write a sweep with some lines more, and beside it the parts, or ``own.py`` with ``text``;
    return the scenario's path.
    """
    for file, content in ({"own.py": text} if text else FILES).items():
        (folder / file).write_text(content, encoding="utf-8")
    path = folder / "own.toml"
    path.write_text(SHORT + lines, encoding="utf-8")
    return str(path)


def line_of(key, name):
    """Return the lines of a scenario file that name a part, and declare what it does."""
    if key == "vessel.track":
        return f'{key} = "{name}"\nfollowing.vessel_acceleration_mps2 = 0.05\n'
    return f'{key} = ["{name}"]\n' if key == "payload" else f'{key} = "{name}"\n'
