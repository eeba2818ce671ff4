"""The sections of a scenario file on ships other than the measured one."""

from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, field_validator, model_validator

from common.files import is_data_file
from measurement.emission import fuel_preset
from measurement.gases import FUEL_SULPHUR_MOST
from scenarios.scenario.sections.needs import OPERATIONAL, SNIFFER, Need
from scenarios.scenario.sections.section import Angle, Positive, Section
from scenarios.scenario.sections.world import ManoeuvreConfig, known_ship

TRAFFIC_MAX = 200
"""Most ships of a scenario besides the one that is measured [-]."""


class TrafficEmissionConfig(Section):
    """What comes out of its funnel. The sniffer on board reads it as well where the UAV meets it;
    the estimate of the measured ship's sulphur leaves out readings that it may be in.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (SNIFFER,)

    ship: Annotated[str | dict[str, Any], BeforeValidator(known_ship)]
    """The ship that emits it, one of measurement/ships.toml, or a table of one's own with the keys
    of these; its funnel is as high as says this.
    """
    fuel: str = "mgo"
    """Fuel of the ship, one of measurement/fuels.toml."""
    sulphur_percent: Annotated[float | None, Field(ge=0.0, le=FUEL_SULPHUR_MOST)] = None
    """Sulphur content of the fuel by mass; the usual one of that fuel if not given [% m/m]."""
    load: Annotated[float | None, Field(gt=0.0, le=1.0)] = None
    """Load of the engine, a fraction as 0.85; if not given, that at the ship's speed at the start
    [-].
    """

    @field_validator("fuel")
    @classmethod
    def _known_fuel(cls, fuel: str) -> str:
        fuel_preset(fuel)
        return fuel


class TrafficConfig(Section):
    """A ship other than the measured one, or all ships of a file of AIS reports. The keep-out
    guard keeps off every one of them.

    Of a ``vessel.track`` from a file, all other ships of that file are traffic as well.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    name: str | None = None
    """Its name in messages, tables and maps; if not given, traffic_1, traffic_2 and so on, and of a
    file MMSI and number.
    """
    track: str = "manoeuvres"
    """Its track: by speed, course and manoeuvres, or a file of AIS reports (.csv, .nmea, .txt)."""
    mmsi: Annotated[int | None, Field(ge=0, le=999_999_999)] = None
    """MMSI of a ship of that file; all of its ships if not given [-]."""
    place_m: tuple[float, float] | None = None
    """Its place at the start, ahead and to the right of the measured ship [m]."""
    latitude_deg: Annotated[float | None, Field(ge=-90.0, le=90.0)] = None
    """Geodetic latitude of its place at the start, in place of place_m [deg]."""
    longitude_deg: Annotated[float | None, Field(ge=-180.0, le=180.0)] = None
    """Longitude of its place at the start, in place of place_m [deg]."""
    speed_mps: Annotated[float, Field(ge=0.0, le=60.0)] = 8.0
    """Speed over the ground, before any manoeuvre [m/s]."""
    course_deg: Angle = 0.0
    """Course, clockwise from north [deg]."""
    manoeuvres: tuple[ManoeuvreConfig, ...] = ()
    """Its manoeuvres, in the order of their times."""
    radius_m: Annotated[Positive | None, Field(le=10_000.0)] = None
    """Radius that is kept from it; keepout.other_radius_m if not given [m]."""
    emission: TrafficEmissionConfig | None = None
    """What comes out of its funnel; nothing if not given."""

    @field_validator("name")
    @classmethod
    def _a_word(cls, name: str | None) -> str | None:
        if name is not None and not (name.strip() and name.isprintable()):
            raise ValueError(f"name is {name!r}; give one word at least")
        return name

    @field_validator("track")
    @classmethod
    def _of_data(cls, track: str) -> str:
        if track != "manoeuvres" and not (Path(track).suffix and is_data_file(track)):
            raise ValueError(
                f"track is '{track}'; give the name of a file of AIS reports, which ends in .csv,"
                " .nmea or .txt, or leave it out"
            )
        return track

    @model_validator(mode="after")
    def _placed(self) -> "TrafficConfig":
        given = self.model_fields_set
        if self.from_file:
            own = ("place_m", "latitude_deg", "longitude_deg", "speed_mps", "course_deg")
            if twice := next((key for key in (*own, "manoeuvres") if key in given), None):
                raise ValueError(
                    f"{twice} is given beside track, a file that says where it goes; leave one of"
                    " them out"
                )
            return self
        if self.mmsi is not None:
            raise ValueError(
                f"mmsi is {self.mmsi}, and there is no file: set track to a file of AIS reports"
            )
        degrees = (self.latitude_deg is not None) + (self.longitude_deg is not None)
        if degrees == 1 or (degrees == 2) == (self.place_m is not None):
            raise ValueError(
                "a ship needs one place at the start: give place_m, or latitude_deg and"
                " longitude_deg"
            )
        times = [m.at_s for m in self.manoeuvres]
        if times != sorted(times):
            raise ValueError(f"manoeuvres begin at {times} s; put them in their order")
        return self

    @property
    def from_file(self) -> bool:
        """Whether its track is that of a file of AIS reports."""
        return is_data_file(self.track)
