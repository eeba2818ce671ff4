"""Files of AIS reports of a busy lane, which no ship sent: ships in a row each way, and ships that
cross, with the errors, gaps and intervals of real reports.
"""

import math
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from common.geodesy import LocalFrame
from common.physics import METRES_PER_SECOND_PER_KNOT

MEASURED = 219999001
START = datetime(2026, 6, 1, 10, 0, tzinfo=UTC).timestamp()
PLACE = (math.radians(57.2), math.radians(11.3))

WANDERING, WANDERING_TIME, WHITE = 2.5, 60.0, 0.8
"""Error of satellite navigation [m, s, m], as in ``scenarios.world.ais.synthetic``."""


class LaneShip(NamedTuple):
    """A steady ship: MMSI, place at time 0 north and east [m], speed [m/s] and course [deg]."""

    mmsi: int
    north: float
    east: float
    speed: float
    course: float

    def at(self, time):
        angle = math.radians(self.course)
        way = self.speed * time
        return self.north + way * math.cos(angle), self.east + way * math.sin(angle)


def lane(seed, *, spacing=1500.0, each_way=5, apart=900.0, crossing=5, speed=7.0, duration=600.0):
    """Return ships of a lane to the north with the measured one, of one to the south beside it, and
    of some that cross both while the measured ship passes.
    """
    generator = np.random.default_rng(seed)
    ships = [LaneShip(MEASURED, 0.0, 0.0, speed, 0.0)]
    number = MEASURED
    for place in (i * spacing for i in range(-each_way, each_way + 1) if i):
        number += 1
        ships.append(LaneShip(number, place, float(generator.uniform(-40.0, 40.0)), speed, 0.0))
    for place in (i * spacing for i in range(-each_way, 3 * each_way)):
        number += 1
        shifted = place + float(generator.uniform(-0.5, 0.5)) * spacing
        ships.append(LaneShip(number, shifted, -apart, speed + 1.0, 180.0))
    for i in range(crossing):
        number += 1
        time = (i + 0.7) * duration / crossing
        course = float(generator.choice([70.0, 90.0, 110.0, 250.0, 270.0, 290.0]))
        fast = float(generator.uniform(6.0, 11.0))
        # It crosses the measured ship's lane astern of it, beyond its plume or near it, or ahead.
        along = float(generator.choice([-900.0, -650.0, -500.0, 600.0, 900.0]))
        there = speed * time + along
        angle = math.radians(course)
        place = there - fast * time * math.cos(angle), -fast * time * math.sin(angle)
        ships.append(LaneShip(number, *place, fast, course))
    return ships


def file_of(ships, *, seed=0, begin=-120.0, end=900.0, interval=10.0, lost=0.1):
    """Return a table of the reports of ships, in the project's own layout, in the order of time."""
    generator = np.random.default_rng(seed)
    frame = LocalFrame(*PLACE)
    rows = []
    for ship in ships:
        time = begin + float(generator.uniform(0.0, interval))
        wandering = WANDERING * generator.standard_normal(2)
        while time < end:
            kept = math.exp(-interval / WANDERING_TIME)
            kick = WANDERING * math.sqrt(1.0 - kept**2) * generator.standard_normal(2)
            wandering = kept * wandering + kick
            if generator.random() >= lost:
                rows.append((time, _row(ship, time, wandering, frame, generator)))
            time += interval + float(generator.uniform(-0.5, 0.5))
    rows.sort()
    return "\n".join(["time_utc,mmsi,lat_deg,lon_deg,sog_kn,cog_deg", *(row for _, row in rows)])


def _row(ship, time, wandering, frame, generator):
    north, east = ship.at(time)
    off = wandering + WHITE * generator.standard_normal(2)
    latitude, longitude = (
        float(angle) for angle in frame.to_geodetic(north + off[0], east + off[1])
    )
    angle = math.radians(ship.course)
    v_north, v_east = (
        ship.speed * of + 0.05 * float(generator.standard_normal())
        for of in (math.cos(angle), math.sin(angle))
    )
    course = math.atan2(v_east, v_north) - float(frame.true_north(latitude, longitude))
    stamp = datetime.fromtimestamp(START + time, UTC).isoformat(timespec="milliseconds")
    return (
        f"{stamp},{ship.mmsi},{math.degrees(latitude):.7f},{math.degrees(longitude):.7f},"
        f"{math.hypot(v_north, v_east) / METRES_PER_SECOND_PER_KNOT:.2f},"
        f"{math.degrees(course) % 360.0:.1f}"
    )
