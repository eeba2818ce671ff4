"""What exporters for maps and globes take from a flight: where UAV, vessel and plume were on earth,
and when.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np
import pandas as pd

from common.geodesy import LocalFrame
from common.hull import HULL_SHAPES, ShipHull
from common.text import moment, utc_text
from measurement.gases import GASES, UNITS
from reports.errors import ReportError
from reports.run.columns import Array, column
from reports.run.flight_config import flight_config, keepout_shape, outline_of, source_height
from reports.run.run_data import RunData
from reports.run.time_history import vessel_heading

PLUME_LENGTH = 1000.0
"""How much of the plume's axis is shown [m]."""

_RING_POINTS = 48
"""Sides of the polygon that stands for a keep-out circle."""

READINGS = {f"{gas}_reading_{UNITS[gas]}": f"{gas.upper()} reading [{UNITS[gas]}]" for gas in GASES}
"""What a sniffer read: columns of time histories, and how they are labelled. A reading is held
until the next.
"""

NO_PLACE = (0.0, 0.0)
"""Latitude and longitude of flights that no place is given for [deg]: on the equator, where JSBSim
flies them.
"""

NO_TIME = datetime(2000, 1, 1, tzinfo=UTC).timestamp()
"""Start of flights that no time is given for, since 1970 [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """Where something that moves was at each sample.

    Attributes
    ----------
    latitude, longitude : [deg]
    altitude : above mean sea level, unless the flight is ``above_ellipsoid`` [m]
    north, east : velocity over the ground by true north [m/s]
    """

    latitude: Array
    longitude: Array
    altitude: Array
    north: Array
    east: Array

    @property
    def speed(self) -> Array:
        """Return the speed over the ground [m/s]."""
        speed: Array = np.hypot(self.north, self.east)
        return speed

    @property
    def course(self) -> Array:
        """Return the course over the ground from true north, from 0 to 360 [deg]."""
        course: Array = np.degrees(np.arctan2(self.east, self.north)) % 360.0
        return course

    def raised(self, height: float) -> "Body":
        """Return the body with its altitude raised by a height [m]."""
        return replace(self, altitude=self.altitude + height)


@dataclass(frozen=True, slots=True, kw_only=True)
class GeographicFlight:
    """One flight on earth.

    Attributes
    ----------
    flight_id : its name
    placed : whether its place on earth is known; otherwise it is that of ``NO_PLACE``
    start : since 1970 in UTC [s]
    time : of each sample since the start [s]
    uav : the aircraft
    heading, pitch, roll : of the aircraft, heading from true north [deg]
    airspeed, climb_rate : [m/s]
    throttle : [-]
    wind_north, wind_east : velocity of the air by true north, as estimated on board [m/s]
    readings : of the sniffer at each sample, by the name of their column of ``READINGS``; none
        without a sniffer
    history, row : everything that was recorded at each sample, and its row of the summary
    vessel, vessel_heading : the ship, or none, and where its bow points from true north, at rest as
        before [deg]
    plume_end : a point of the plume's axis, ``PLUME_LENGTH`` from the funnel, or none
    source_height : of the funnel above mean sea level, as ``Body.altitude`` [m]
    keepout_radius : r_min, not a number without a vessel [m]
    crossings : its rows of the run's table of crossings
    geoid_height : of mean sea level above the WGS 84 ellipsoid [m]
    ellipsoidal : whether altitudes are above the ellipsoid
    outline : of the hull, where the keep-out area is about it
    """

    flight_id: str
    placed: bool
    start: float
    time: Array
    uav: Body
    heading: Array
    pitch: Array
    roll: Array
    airspeed: Array
    climb_rate: Array
    throttle: Array
    wind_north: Array
    wind_east: Array
    readings: Mapping[str, Array]
    history: pd.DataFrame
    row: Mapping[str, object]
    vessel: Body | None
    vessel_heading: Array
    plume_end: Body | None
    source_height: float
    keepout_radius: float
    crossings: pd.DataFrame
    geoid_height: float = 0.0
    ellipsoidal: bool = False
    outline: ShipHull | None = None

    @property
    def keepout_circle(self) -> float:
        """Return the radius of a circle about the funnel that holds the keep-out area, for formats
        that draw circles alone: r_min, or that and the farthest corner of the hull [m].
        """
        return self.keepout_radius + (self.outline.farthest if self.outline else 0.0)

    @property
    def height_reference(self) -> str:
        """Return in a sentence what altitudes are above; exporters write it into their files."""
        reference = "the WGS 84 ellipsoid" if self.ellipsoidal else "mean sea level"
        sea = f"{self.geoid_height:g} m above" if self.geoid_height else "as"
        return (
            f"Heights are in metres above {reference}; mean sea level is taken {sea} the ellipsoid"
            " (place.geoid_m)."
        )

    def above_ellipsoid(self) -> "GeographicFlight":
        """Return the flight with altitudes above the ellipsoid WGS 84, as some formats need."""
        if self.ellipsoidal:
            return self
        return replace(
            self,
            uav=self.uav.raised(self.geoid_height),
            vessel=self.vessel and self.vessel.raised(self.geoid_height),
            plume_end=self.plume_end and self.plume_end.raised(self.geoid_height),
            source_height=self.source_height + self.geoid_height,
            ellipsoidal=True,
        )

    @property
    def epoch(self) -> str:
        """Return the start in ISO 8601, to a millisecond."""
        return utc_text(self.start, milliseconds=True)

    def utc(self, i: int) -> str:
        """Return the time of a sample in ISO 8601, to a millisecond."""
        return utc_text(self.start + float(self.time[i]), milliseconds=True)

    def every(self, seconds: float) -> list[int]:
        """Return the numbers of samples that are some time [s] apart, the first and the last among
        them.
        """
        step = max(
            1,
            round(
                seconds
                / max(1e-9, float(np.median(np.diff(self.time))) if len(self.time) > 1 else seconds)
            ),
        )
        return sorted({*range(0, len(self.time), step), len(self.time) - 1})

    def keepout_ring(self, i: int) -> list[tuple[float, float]]:
        """Return longitude and latitude [deg] of the edge of the keep-out area at a sample, closed
        and counter-clockwise: a circle about the vessel, or what is as near to its hull.
        """
        if self.vessel is None:
            return []
        frame = LocalFrame(
            math.radians(self.vessel.latitude[i]), math.radians(self.vessel.longitude[i])
        )
        angle = np.linspace(0.0, -2.0 * math.pi, _RING_POINTS + 1)
        north, east = self.keepout_radius * np.cos(angle), self.keepout_radius * np.sin(angle)
        if self.outline is not None:
            ahead, right = self.outline.around(self.keepout_radius, np.append(angle[:-1], 0.0))
            bow = math.radians(float(self.vessel_heading[i]))
            north = math.cos(bow) * ahead - math.sin(bow) * right
            east = math.sin(bow) * ahead + math.cos(bow) * right
        latitude, longitude = frame.to_geodetic(north, east)
        # In one piece, also where it lies over the date line.
        centre = float(self.vessel.longitude[i])
        around = centre + (np.degrees(longitude) - centre + 180.0) % 360.0 - 180.0
        return list(zip(around.tolist(), np.degrees(latitude).tolist(), strict=True))


def recorded_flights(run: RunData) -> Iterator[GeographicFlight]:
    """Yield each flight of a run that has a time history.

    Raises
    ------
    ReportError : none has
    """
    found = False
    for row in run.recorded_rows():
        history = run.history(str(row["flight_id"]))
        if history is not None and len(history):
            found = True
            yield _flight(run, row, history)
    if not found:
        raise ReportError(
            f"'{run.path}' has no time histories of flights, which tracks are made of"
        )


def _flight(run: RunData, row: dict[str, object], history: pd.DataFrame) -> GeographicFlight:
    def of(name: str, default: float = 0.0) -> Array:
        return (
            np.nan_to_num(column(history, name), nan=default)
            if name in history
            else np.full(len(history), default)
        )

    def known(name: str, default: float) -> float:
        value = row.get(name)
        return float(value) if isinstance(value, int | float) and math.isfinite(value) else default

    flight_id = str(row["flight_id"])
    latitude, longitude = (
        known("place_latitude_deg", math.nan),
        known("place_longitude_deg", math.nan),
    )
    placed = math.isfinite(latitude) and math.isfinite(longitude)
    commanded, altitude = of("altitude_command_m"), of("altitude_m")
    if not placed:
        latitude, longitude = NO_PLACE
    frame = LocalFrame(
        math.radians(latitude), math.radians(longitude), float(commanded[0] or altitude[0])
    )
    north, east = of("north_m"), of("east_m")
    uav = _body(frame, north, east, altitude, of("velocity_north_mps"), of("velocity_east_mps"))
    north_of_frame = frame.true_north(np.radians(uav.latitude), np.radians(uav.longitude))
    turned = np.degrees(north_of_frame)
    wind_north, wind_east = _by_true_north(
        north_of_frame, of("wind_north_mps", math.nan), of("wind_east_mps", math.nan)
    )
    heading = column(history, "heading_rad") if "heading_rad" in history else of("course_rad")
    config = flight_config(run, row)
    funnel = source_height(config) if "plume" in config else float(commanded[0])
    radius, axis = known("keepout_radius_m", math.nan), of("plume_axis_rad", math.nan)
    vessel, bow, plume_end = None, np.zeros(len(history)), None
    if math.isfinite(radius):
        v_north, v_east = of("vessel_north_m"), of("vessel_east_m")
        moving = of("vessel_velocity_north_mps"), of("vessel_velocity_east_mps")
        vessel = _body(frame, v_north, v_east, np.zeros(len(history)), *moving)
        bow = vessel_heading(history, float(config.get("vessel", {}).get("course_deg") or 0.0))
        bow = (
            np.degrees(
                bow - frame.true_north(np.radians(vessel.latitude), np.radians(vessel.longitude))
            )
        ) % 360.0
        if np.isfinite(axis).all():
            up = math.radians(known("plume_elevation_deg", 0.0))
            level = PLUME_LENGTH * math.cos(up)
            end_altitude = np.full(len(history), funnel + PLUME_LENGTH * math.sin(up))
            plume_end = _body(
                frame,
                v_north + level * np.cos(axis),
                v_east + level * np.sin(axis),
                end_altitude,
                *moving,
            )
    return GeographicFlight(
        flight_id=flight_id,
        placed=placed,
        start=_start(row.get("start_utc")),
        time=of("time_s"),
        uav=uav,
        heading=(np.degrees(heading) - turned) % 360.0,
        pitch=np.degrees(of("pitch_rad")),
        roll=np.degrees(of("roll_rad")),
        airspeed=of("airspeed_mps"),
        climb_rate=of("climb_rate_mps"),
        throttle=of("throttle"),
        wind_north=wind_north,
        wind_east=wind_east,
        readings={
            name: column(history, name)
            for name in READINGS
            if name in history and history[name].notna().any()
        },
        history=history,
        row=row,
        vessel=vessel,
        vessel_heading=bow,
        plume_end=plume_end,
        source_height=funnel,
        keepout_radius=radius,
        crossings=run.crossings_of(flight_id),
        outline=outline_of(config) if keepout_shape(config) in HULL_SHAPES.values() else None,
        geoid_height=float((config.get("place") or {}).get("geoid_m") or 0.0),
    )


def _body(
    frame: LocalFrame, north: Array, east: Array, altitude: Array, v_north: Array, v_east: Array
) -> Body:
    """Return a body from what it is in a local frame [m, m/s]."""
    latitude, longitude = frame.to_geodetic(north, east)
    true_north, true_east = _by_true_north(frame.true_north(latitude, longitude), v_north, v_east)
    return Body(
        latitude=np.degrees(latitude),
        longitude=np.degrees(longitude),
        altitude=altitude,
        north=true_north,
        east=true_east,
    )


def _by_true_north(turned: Array, north: Array, east: Array) -> tuple[Array, Array]:
    """Return a velocity of a local frame by true north, given the angle between both [rad]."""
    return (
        np.cos(turned) * north + np.sin(turned) * east,
        np.cos(turned) * east - np.sin(turned) * north,
    )


def _start(text: object) -> float:
    begun = moment(text)
    return NO_TIME if begun is None else begun.timestamp()
