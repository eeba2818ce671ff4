"""The two files of AIS reports that come with the project, which no ship sent.

``python -m scenarios.world.ais.synthetic DIR`` writes both. The ships turn by 90 degrees and slow
down; their reports are as late, as wrong and as incomplete as those of a receiver on the coast.
"""

import math
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from common.geodesy import LocalFrame
from common.physics import METRES_PER_SECOND_PER_KNOT
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.vessel import ManoeuvringVessel

SYNTHETIC = {"synthetic_danish.csv": 219999001, "synthetic_marine_cadastre.csv": 366999002}
"""Names of the files, and the MMSI of the ship in each: numbers of Denmark and of the United States
that no ship has.
"""

_DURATION = 4200.0
_START = datetime(2026, 6, 1, 10, 0, tzinfo=UTC).timestamp()

_WANDERING, _WANDERING_TIME, _WHITE = 2.5, 60.0, 0.8
"""Error of satellite navigation: a wandering part with its time constant, and a white one, one
sigma of a coordinate [m, s, m].
"""

_DANISH = (
    "# Timestamp,Type of mobile,MMSI,Latitude,Longitude,Navigational"
    " status,ROT,SOG,COG,Heading,IMO,Callsign,Name,Ship type,Cargo type,Width,Length,Type of"
    " position fixing device,Draught,Destination,ETA,Data source type,A,B,C,D"
)
_MARINE_CADASTRE = (
    "mmsi,base_date_time,longitude,latitude,sog,cog,heading,vessel_name,imo,call_sign,"
    "vessel_type,status,length,width,draft,cargo,transceiver"
)


def danish_file() -> str:
    """Return reports of a ship in the Kattegat: every 10 s, every 3 s while it turns, a tenth of
    them lost, and unusable rows.
    """
    ship = _ship(speed_kn=12.0, course_deg=20.0, turn_deg=90.0)
    times = _report_times(ship, slow=10.0, fast=10.0 / 3.0, lost=0.1)
    rows = [
        f"{datetime.fromtimestamp(time, UTC):%d/%m/%Y %H:%M:%S},Class"
        f" A,{SYNTHETIC['synthetic_danish.csv']},{latitude:.6f},{longitude:.6f},Under way using"
        f" engine,,{speed:.1f},{course:.1f},,Unknown,,MADE SHIP,Cargo,,,,GPS,,,,AIS,,,,"
        for time, latitude, longitude, speed, course in _reports(
            ship, times, place=(57.2, 11.3), seed=1
        )
    ]
    # What real files have as well: a row twice, one out of order, values that say "not available",
    # and another vessel.
    rows.insert(120, rows[119])
    rows.insert(200, rows[150])
    rows.insert(240, _with(rows[240], {7: "102.3", 8: "360.0"}))
    rows.insert(280, _with(rows[280], {3: "91.000000", 4: "181.000000"}))
    rows.insert(320, _with(rows[320], {3: "12.345678"}))
    rows.insert(1, _with(rows[1], {1: "Base Station", 2: "2199900", 7: "", 8: ""}))
    return "\n".join([_DANISH, *rows]) + "\n"


def marine_cadastre_file() -> str:
    """Return reports of a ship off Oregon, about one a minute, in the Marine Cadastre's layout."""
    ship = _ship(speed_kn=11.0, course_deg=185.0, turn_deg=-90.0)
    times = _report_times(ship, slow=60.0, fast=60.0, lost=0.0)
    rows = [
        f"{SYNTHETIC['synthetic_marine_cadastre.csv']},"
        f"{datetime.fromtimestamp(time, UTC):%Y-%m-%d %H:%M:%S},{longitude:.5f},{latitude:.5f},"
        f"{speed:.1f},{course:.1f},511,MADE SHIP,,,70,0,,,,70,A"
        for time, latitude, longitude, speed, course in _reports(
            ship, times, place=(44.6, -124.6), seed=2
        )
    ]
    return "\n".join([_MARINE_CADASTRE, *rows]) + "\n"


def _ship(*, speed_kn: float, course_deg: float, turn_deg: float) -> ManoeuvringVessel:
    """Return a ship that turns after 20 minutes, in three, and slows to 7 kn after 40."""
    config = VesselConfig.model_validate(
        {
            "course_deg": course_deg,
            "manoeuvres": [
                {"at_s": 1200.0, "turn_deg": turn_deg, "turn_rate_deg_s": 0.5},
                {
                    "at_s": 2400.0,
                    "speed_mps": 7.0 * METRES_PER_SECOND_PER_KNOT,
                    "acceleration_mps2": 0.03,
                },
            ],
        }
    )
    return ManoeuvringVessel(config, speed_kn * METRES_PER_SECOND_PER_KNOT, _DURATION)


def _report_times(ship: ManoeuvringVessel, *, slow: float, fast: float, lost: float) -> list[float]:
    generator = np.random.default_rng(11)
    times, time = [0.0], 0.0
    while time < _DURATION - slow:
        turning = abs(ship.course(time + 5.0) - ship.course(max(0.0, time - 5.0))) > math.radians(
            1.0
        )
        time += (fast if turning else slow) + float(generator.uniform(-0.5, 0.5))
        if generator.random() >= lost:
            times.append(time)
    return times


def _reports(
    ship: ManoeuvringVessel, times: list[float], *, place: tuple[float, float], seed: int
) -> list[tuple[float, float, float, float, float]]:
    """Return time since 1970 in whole seconds, latitude, longitude [deg], speed [kt] and course
    [deg] of each report.
    """
    generator = np.random.default_rng(seed)
    frame = LocalFrame(*map(math.radians, place))
    wandering, before = _WANDERING * generator.standard_normal(2), 0.0
    reports = []
    for time in times:
        kept = math.exp(-(time - before) / _WANDERING_TIME)
        wandering = kept * wandering + _WANDERING * math.sqrt(
            1.0 - kept**2
        ) * generator.standard_normal(2)
        north, east, v_north, v_east = ship.motion(time)
        off_north, off_east = wandering + _WHITE * generator.standard_normal(2)
        latitude, longitude = (
            float(angle) for angle in frame.to_geodetic(north + off_north, east + off_east)
        )
        v_north, v_east = (float(v + 0.05 * generator.standard_normal()) for v in (v_north, v_east))
        course = math.atan2(v_east, v_north) - float(frame.true_north(latitude, longitude))
        speed = math.hypot(v_north, v_east) / METRES_PER_SECOND_PER_KNOT
        reported = round(math.degrees(course) % 360.0, 1) % 360.0
        reports.append(
            (
                float(math.floor(_START + time)),
                math.degrees(latitude),
                math.degrees(longitude),
                speed,
                reported,
            )
        )
        before = time
    return reports


def _with(row: str, changes: dict[int, str]) -> str:
    cells = row.split(",")
    for i, cell in changes.items():
        cells[i] = cell
    return ",".join(cells)


def main(directory: Path) -> None:
    """Write both files into a directory."""
    for name, text in zip(SYNTHETIC, (danish_file(), marine_cadastre_file()), strict=True):
        (directory / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
