"""The sections of a scenario file on the world: vessel, plume, wind, turbulence, keep-out area.
Anything that is absent is ideal.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, create_model, field_validator, model_validator

from common.files import is_data_file
from common.hull import STACK_FROM_BOW, ShipHull
from common.registry import is_file_part
from common.tables import FOUND, TableFormat, table_format
from measurement.emission import fuel_preset, ship_of, stack_height_of
from measurement.gases import FUEL_SULPHUR_MOST
from measurement.plume.spread import PlumeSettings
from measurement.species import SPECIES
from scenarios.scenario.extension_points import PLUME_MODELS, VESSEL_TRACKS
from scenarios.scenario.sections.needs import (
    BLOWS,
    EXHAUST,
    OPERATIONAL,
    OWN_TRACK,
    SNIFFER,
    VESSEL,
    Need,
    channel_of_gas,
    when,
)
from scenarios.scenario.sections.part_section import PartSection
from scenarios.scenario.sections.section import Angle, NonNegative, Positive, Section

SOURCE_HEIGHT_MIN = 10.0
"""Least height of a funnel's mouth above the sea [m]."""

GAP_MAX = 180.0
"""Longest gap between reports of a file that is bridged, unless it is set [s]."""

Shape = Literal["sphere", "cylinder"]
"""Shapes of the keep-out area."""


class ManoeuvreConfig(Section):
    """A change of the vessel's course or speed, at a steady rate."""

    at_s: NonNegative
    """Time at which the manoeuvre begins [s]."""
    turn_deg: Angle = 0.0
    """Change of course, positive to starboard [deg]."""
    turn_rate_deg_s: Annotated[float, Field(gt=0.0, le=5.0)] = 0.5
    """Rate of the turn [deg/s]."""
    speed_mps: Annotated[float, Field(ge=0.0, le=30.0)] | None = None
    """Speed over the ground at its end; unchanged if not given [m/s]."""
    acceleration_mps2: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    """Rate of the change of speed [m/s2]."""


_HULL_GIVEN = Need(
    lambda s: s.vessel.length_m is not None or s.vessel.from_file,
    "a hull: set vessel.length_m and vessel.beam_m",
)
_REPORTED = Need(
    lambda s: not s.vessel_known,
    "a vessel that reports the place of its antenna: set reports.interval_s",
)
_FILE = Need(
    lambda s: s.vessel.from_file,
    "a track from a file: set vessel.track to a file of AIS reports",
)
_NO_RATIO = Need(
    lambda s: (
        not {"nu", "vessel.speed_ratio"} & s.sweep.root.keys() and s.vessel.speed_ratio is None
    ),
    "a vessel whose speed is not given by sweep.nu or vessel.speed_ratio: leave one of them out",
)


def _first_known(places: Sequence[float | None]) -> float:
    """Return the first place that is known; at least one is."""
    return next(place for place in places if place is not None)


class VesselConfig(Section):
    """The ship."""

    NEEDS: ClassVar[tuple[Need, ...]] = (VESSEL,)

    speed_mps: Annotated[float, Field(ge=0.0, le=300.0), OWN_TRACK, _NO_RATIO] = 8.0
    """Speed over the ground, before any manoeuvre [m/s]."""
    speed_ratio: Annotated[float | None, Field(ge=0.0, le=10.0), OWN_TRACK] = None
    """Speed over the ground over the UAV's airspeed, nu in calm air [-]; replaces speed_mps if
    given.
    """
    course_deg: Annotated[Angle, OWN_TRACK] = 0.0
    """Course, clockwise from north [deg]."""
    track: Annotated[str, OPERATIONAL] = "manoeuvres"
    """Track of the vessel: by its speed, course and manoeuvres, from a file of AIS reports (.csv,
    .nmea, .txt), or FILE.py:NAME.
    """
    mmsi: Annotated[int | None, Field(ge=0, le=999_999_999), _FILE] = None
    """MMSI of the vessel in a file of AIS reports; not needed if the file has only one vessel [-].
    """
    gap_max_s: Annotated[Positive, _FILE] = GAP_MAX
    """Longest gap between reports of a file over which the track is interpolated [s]."""
    length_m: Annotated[float, Field(ge=5.0, le=600.0)] | None = None
    """Length of the hull, whose outline is the rectangle of length and beam; without it the ship is
    a point. Of a track from a file, what its reports say if not given [m]."""
    beam_m: Annotated[float, Field(ge=1.0, le=150.0)] | None = None
    """Beam of the hull, with length_m [m]."""
    stack_from_bow_m: Annotated[NonNegative | None, _HULL_GIVEN] = None
    """Place of the funnel from the bow. If not given: at the antenna, or, where that is not known
    either, at 0.8 of the length [m]."""
    stack_from_port_m: Annotated[NonNegative | None, _HULL_GIVEN] = None
    """Place of the funnel from the port side. If not given: half the beam [m]."""
    antenna_from_bow_m: Annotated[NonNegative | None, _HULL_GIVEN, _REPORTED] = None
    """Place of the antenna whose position is reported from the bow, A of AIS message 5. If not
    given: as reports of a file say, where stack_from_bow_m is given; else at the funnel [m]."""
    antenna_from_port_m: Annotated[NonNegative | None, _HULL_GIVEN, _REPORTED] = None
    """Place of that antenna from the port side, C of AIS message 5. If not given: as the other
    one, or half the beam [m]."""
    manoeuvres: Annotated[tuple[ManoeuvreConfig, ...], OWN_TRACK, OPERATIONAL] = ()
    """Manoeuvres of the vessel, in the order of their times."""

    @field_validator("track")
    @classmethod
    def _of_data(cls, track: str) -> str:
        file = Path(track).suffix and not (is_file_part(track) or is_data_file(track))
        if file and track not in VESSEL_TRACKS:
            raise ValueError(
                f"track is '{track}'; the name of a file of AIS reports ends in .csv, .nmea or .txt"
            )
        return track

    @model_validator(mode="after")
    def _in_turn(self) -> "VesselConfig":
        times = [m.at_s for m in self.manoeuvres]
        if times != sorted(times):
            raise ValueError(f"manoeuvres begin at {times} s; put them in their order")
        return self

    @model_validator(mode="after")
    def _on_the_hull(self) -> "VesselConfig":
        places = {
            name: getattr(self, name)
            for name in (
                "stack_from_bow_m",
                "stack_from_port_m",
                "antenna_from_bow_m",
                "antenna_from_port_m",
            )
            if getattr(self, name) is not None
        }
        if self.length_m is None or self.beam_m is None:
            sizes = {name: getattr(self, name) for name in ("length_m", "beam_m")}
            given = [name for name, size in {**sizes, **places}.items() if size is not None]
            missing = [name for name, size in sizes.items() if size is None]
            if given and not self.from_file:
                raise ValueError(
                    f"{given[0]} is given without {' and '.join(missing)}; a hull has a length_m"
                    " and a beam_m: give both"
                )
            return self
        if self.beam_m > self.length_m:
            raise ValueError(
                f"beam_m is {self.beam_m:g} m; it must not exceed length_m, {self.length_m:g} m"
            )
        for name, place in places.items():
            size = "length_m" if "bow" in name else "beam_m"
            if place > getattr(self, size):
                raise ValueError(
                    f"{name} is {place:g} m, outside of the hull; it must not exceed {size},"
                    f" {getattr(self, size):g} m"
                )
        return self

    @property
    def hull(self) -> ShipHull | None:
        """The hull, where it is known: funnel and antenna are at one place if only one of them
        is.
        """
        if self.length_m is None or self.beam_m is None:
            return None
        middle, usual = 0.5 * self.beam_m, STACK_FROM_BOW * self.length_m
        along = [self.stack_from_bow_m, self.antenna_from_bow_m, usual]
        across = [self.stack_from_port_m, self.antenna_from_port_m, middle]
        stack = _first_known(along), _first_known(across)
        antenna = (
            _first_known([self.antenna_from_bow_m, stack[0]]),
            _first_known([self.antenna_from_port_m, stack[1]]),
        )
        return ShipHull(length=self.length_m, beam=self.beam_m, stack=stack, antenna=antenna)

    @property
    def from_file(self) -> bool:
        """Whether its track is that of a file of AIS reports."""
        return is_data_file(self.track)


class PlaceConfig(Section):
    """Where on earth a flight begins, and when; a track from a file has a place of its own."""

    NEEDS: ClassVar[tuple[Need, ...]] = (VESSEL,)

    latitude_deg: Annotated[float | None, Field(ge=-90.0, le=90.0), OWN_TRACK] = None
    """Geodetic latitude of the vessel at the start [deg]."""
    longitude_deg: Annotated[float | None, Field(ge=-180.0, le=180.0), OWN_TRACK] = None
    """Longitude of the vessel at the start, east of Greenwich [deg]."""
    geoid_m: Annotated[float, Field(ge=-110.0, le=90.0)] = 0.0
    """Height of mean sea level above the WGS 84 ellipsoid there, for exports [m]."""
    utc: datetime | None = None
    """Time of the start, as in 2026-06-01T12:00:00Z; for a track from a file, that of the first
    report if not given.
    """

    @field_validator("utc", mode="before")
    @classmethod
    def _no_number(cls, utc: object) -> object:
        if isinstance(utc, int | float) or (isinstance(utc, str) and utc.strip().isdecimal()):
            raise ValueError(
                f"value is {utc}, a number; give date and time, as in 2026-06-01T12:00:00Z"
            )
        return utc

    @field_validator("utc")
    @classmethod
    def _with_a_zone(cls, utc: datetime | None) -> datetime | None:
        if utc is not None and not 1970 <= utc.year < 2200:
            raise ValueError(f"value is {utc.isoformat()}; give a time from 1970 to 2199")
        if utc is not None and utc.tzinfo is None:
            raise ValueError(
                f"value is {utc.isoformat()}, without a zone; give a time in UTC, as in"
                f" {utc.isoformat()}Z"
            )
        return utc

    @model_validator(mode="after")
    def _whole(self) -> "PlaceConfig":
        if (self.latitude_deg is None) != (self.longitude_deg is None):
            raise ValueError(
                "one of place.latitude_deg and place.longitude_deg is given; give both, or neither"
            )
        return self


def _has_smoke(setting: str) -> Callable[[Any], object]:
    """Return whether the project's smoke has a setting; another plume model may use the name for
    something else.
    """
    return lambda s: (
        s.plume.model != "fluctuating" or getattr(s.plume, setting, getattr(PlumeSettings, setting))
    )


_SMOKE = Need(
    lambda s: s.plume.model != "fluctuating" or s.emission.ship is not None,
    "smoke: set emission.ship",
)
_REALISED = Need(
    lambda s: s.plume.model != "fluctuating" or not _has_smoke("mean")(s),
    "a realisation of smoke: leave plume.mean out",
)
_MEANDERS = Need(_has_smoke("meander"), "smoke that meanders: leave plume.meander out")
_STRUCTURED = Need(
    _has_smoke("structure_intensity"),
    "fluctuations within smoke: set plume.structure_intensity",
)
_NO_SMOKE = Need(
    lambda s: s.plume.model != "fluctuating" or s.emission.ship is None,
    "an axis without smoke; smoke rises by its own heat: leave it out",
)
_GIVEN_ANGLE = Need(
    lambda s: not s.plume_by_wind,
    "a plume at an angle from the bow: set plume.direction to 'given'",
)


class PlumeConfig(PartSection):
    """The smoke plume: its axis, a half-line from the funnel, and what its model adds."""

    NAMED_IN: ClassVar[str] = "plume.model"
    PART_NEEDS: ClassVar[Mapping[str, tuple[Need, ...]]] = {
        **dict.fromkeys((of.name for of in fields(PlumeSettings)), (_SMOKE,)),
        "meander": (_SMOKE, _REALISED),
        "meander_length_across": (_SMOKE, _REALISED, _MEANDERS),
        "meander_length_up": (_SMOKE, _REALISED, _MEANDERS),
        "structure_intensity": (_SMOKE, _REALISED),
        "structure_length": (_SMOKE, _REALISED, _STRUCTURED),
    }

    model: Annotated[str, VESSEL] = "straight"
    """straight: an axis without smoke; fluctuating: smoke that disperses, meanders and bends; or
    FILE.py:NAME.
    """
    direction: Annotated[Literal["apparent_wind", "given"] | None, VESSEL] = None
    """Behind the vessel's motion through the air, or, as in the paper, at heading_deg from the bow.

    If not given: as in the paper in still air where the vessel is steady and known, else by the
    apparent wind.
    """
    heading_deg: Annotated[Angle, VESSEL, _GIVEN_ANGLE] = 180.0
    """Direction chi_P, clockwise from the vessel's bow [deg]; 180 is straight astern."""
    elevation_deg: Annotated[float, Field(ge=0.0, le=60.0), VESSEL, _NO_SMOKE] = 0.0
    """Elevation alpha_P above the horizon [deg]."""
    source_height_m: Annotated[float, Field(ge=SOURCE_HEIGHT_MIN, le=500.0)] | None = None
    """Height of the funnel's mouth above the sea, where the axis starts; at most 200 for exhaust of
    the model fluctuating. If not given, that of the funnel of emission.ship, or 60 without a ship
    [m]."""

    @property
    def source_height(self) -> float:
        """Return the height where the axis starts, as the section has it; a plume model is given
        its flight's own [m].
        """
        return stack_height_of(self.source_height_m, None)

    def parts(self) -> dict[str, Any]:
        """Return the plume model by its name."""
        return {self.model: PLUME_MODELS.get(self.model)}


def known_ship(given: Any) -> Any:
    """Refuse the name of an unknown ship, and an unusable table."""
    if not isinstance(given, str | dict | None):
        raise ValueError(
            f"value is {given!r}; give the name of a ship, or a table with its engine and funnel"
        )
    if given is not None:
        ship_of(given)
    return given


GAS_KEYS = {
    "ch4": "methane_slip_percent",
    "bc": "black_carbon_g_kg",
    "pn": "particle_number_1e15_kg",
}
"""Keys of what a ship emits of some gases of ``measurement.species``, in the unit of their
figures.
"""


class EmissionConfig(Section):
    """What comes out of the funnel."""

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    ship: Annotated[str | dict[str, Any] | None, BeforeValidator(known_ship)] = None
    """The ship that emits the exhaust, one of measurement/ships.toml, or a table of one's
    own with the keys of these; no exhaust if not given."""
    fuel: Annotated[str, EXHAUST] = "mgo"
    """Fuel of the ship, one of measurement/fuels.toml."""
    sulphur_percent: Annotated[float | None, Field(ge=0.0, le=FUEL_SULPHUR_MOST), EXHAUST] = None
    """Sulphur content of the fuel by mass; the usual one of that fuel if not given [% m/m]."""
    load: Annotated[float | None, Field(gt=0.0, le=1.0), EXHAUST] = None
    """Load of the engine, a fraction as 0.85; if not given, that at the vessel's speed, which the
    guidance expects [-].
    """
    methane_slip_percent: Annotated[
        float, Field(ge=0.0, le=SPECIES["ch4"].most), EXHAUST, channel_of_gas("ch4")
    ] = 0.0
    """Methane that leaves unburnt, by mass of the fuel, whose CO2 is less by its carbon [% m/m]."""
    black_carbon_g_kg: Annotated[
        float, Field(ge=0.0, le=SPECIES["bc"].most), EXHAUST, channel_of_gas("bc")
    ] = 0.0
    """Black carbon per fuel [g/kg]."""
    particle_number_1e15_kg: Annotated[
        float, Field(ge=0.0, le=SPECIES["pn"].most), EXHAUST, channel_of_gas("pn")
    ] = 0.0
    """Number of particles per fuel [10^15/kg]."""

    @field_validator("fuel")
    @classmethod
    def _known_fuel(cls, fuel: str) -> str:
        fuel_preset(fuel)
        return fuel

    @property
    def emitted(self) -> dict[str, float]:
        """What is emitted of the gases of ``GAS_KEYS``, in the unit of their figures."""
        return {gas: getattr(self, key) for gas, key in GAS_KEYS.items()}

    @property
    def methane(self) -> float:
        """Methane that leaves unburnt, by mass of the fuel [-]."""
        return self.methane_slip_percent / 100.0


if TYPE_CHECKING:
    _MeasuredFrom = Section
else:
    # The key's name is a word of Python.
    _MeasuredFrom = create_model(
        "_MeasuredFrom",
        __base__=Section,
        __module__=__name__,
        **{
            "from": (
                Annotated[Literal["stack", "hull"], _HULL_GIVEN],
                Field(
                    "stack",
                    description="What the distance is measured from: the funnel (stack), or the"
                    " outline of the hull at the height of the funnel's mouth (hull), of which"
                    " vessel.length_m and vessel.beam_m are the sides.",
                ),
            )
        },
    )


class KeepoutConfig(_MeasuredFrom):
    """What the UAV must not enter: a sphere about the funnel's mouth, or an upright cylinder
    through it; or all that is as near to the outline of the hull.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (VESSEL,)

    shape: Shape = "sphere"
    """A sphere, as in the paper, which is narrower above and below; or a cylinder, as wide at every
    height.
    """
    radius_m: Annotated[float, Field(ge=10.0, le=10_000.0)] = 200.0
    """r_min, radius of the keep-out area [m]."""
    other_radius_m: Annotated[
        Annotated[float, Field(ge=10.0, le=10_000.0)] | None,
        Need(
            lambda s: s.has_traffic,
            "ships besides the one that is measured: give traffic, or a vessel.track from a file",
        ),
    ] = None
    """Radius of an upright cylinder about every other ship, which is kept out of as well; radius_m
    if not given [m].
    """

    @property
    def from_hull(self) -> bool:
        """Whether distances are measured from the hull's outline."""
        return bool(getattr(self, "from") == "hull")


_NO_TABLE = Need(
    lambda s: s.wind.table is None,
    "a wind that is not read from a table: leave out this key, or wind.table",
)
_PROFILE = when("wind.roughness_m", user="a wind with a profile over height")


class WindConfig(Section):
    """The mean wind: constant, or from a table; the same at every height, or with a profile. And
    the air in which exhaust rises.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    speed_mps: Annotated[float, Field(ge=0.0, le=40.0), _NO_TABLE] = 0.0
    """Wind speed [m/s]."""
    from_deg: Annotated[Angle, _NO_TABLE, BLOWS] = 0.0
    """Direction that the wind comes from, clockwise from north [deg]."""
    temperature_c: Annotated[float, Field(ge=-40.0, le=50.0), EXHAUST] = 15.0
    """Temperature of the air in which exhaust rises [degC]."""
    stability_per_s: Annotated[float, Field(ge=0.0, le=0.1), EXHAUST] = 0.0
    """Brunt-Vaisala frequency of the air in which exhaust rises; 0 for neutral air [1/s]."""
    table: str | None = None
    """A file with the wind over time, height or both: a table (.csv), or netCDF as from ERA5 (.nc).
    """
    roughness_m: Annotated[float | None, Field(ge=1e-8, le=1.0), BLOWS] = None
    """Roughness length of a logarithmic profile over height, about 0.0002 over the sea; no profile
    if not given [m].
    """
    height_m: Annotated[float, Field(ge=2.0, le=500.0), BLOWS, _PROFILE] = 10.0
    """Height above the sea of the given wind, for a logarithmic profile [m]."""

    @field_validator("table")
    @classmethod
    def _of_data(cls, table: str | None) -> str | None:
        if table is not None and not is_data_file(table):
            raise ValueError(f"table is '{table}'; give a file .csv or .nc")
        return table

    @property
    def blows(self) -> bool:
        """Whether there is any."""
        return self.speed_mps > 0.0 or self.table is not None


_NO_TABLES = (".nmea", ".nc")
"""Ends of the names of files that are no tables, but sentences or netCDF."""


def _tables(s: Any) -> list[str]:
    """Return the files of a scenario that may be tables, judged by their names."""
    files = [s.vessel.track if s.vessel.from_file else "", s.wind.table or ""]
    return [name for name in files if name and not name.lower().endswith(_NO_TABLES)]


_TABLE = Need(_tables, "a table: set vessel.track or wind.table to the file of one")
_TWO_TABLES = Need(
    lambda s: len(_tables(s)) > 1,
    "two tables, of which it names one: set vessel.track and wind.table to files of tables",
)

TableKey = Literal["vessel.track", "wind.table"]
"""Keys whose files may be tables."""


class TableConfig(Section):
    """How the tables of AIS reports and of wind are written. Keys that are left out are found
    automatically.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (_TABLE,)

    file: Annotated[TableKey | None, _TWO_TABLES] = None
    """The table that the other keys are of, where there are two; both if not given."""
    separator: str | None = None
    """Separator of columns: one mark, or whitespace."""
    decimal: str | None = None
    """Mark of decimals: a point or a comma."""
    encoding: str | None = None
    """Encoding of the text, by a name that Python knows, as utf-8 or latin-1."""
    time_format: str | None = None
    """Format of dates and times, as in Python's strptime: '%d.%m.%Y %H:%M:%S'."""
    time_unit: str | None = None
    """Unit of times in numbers: s, ms or us."""

    @model_validator(mode="after")
    def _possible(self) -> "TableConfig":
        try:
            self._format()
        except ValueError as error:
            # The section's name comes before it anyway.
            raise ValueError(str(error).removeprefix("table.")) from None
        return self

    def _format(self) -> TableFormat:
        return table_format(self.model_dump(exclude={"file"}, exclude_none=True))

    def of(self, key: TableKey, name: str) -> TableFormat:
        """Return the given format of a file; it is empty for a file that is not a table.

        Parameters
        ----------
        key, name : the key that has the file, and the file's name
        """
        if self.file not in (None, key) or name.lower().endswith(_NO_TABLES):
            return FOUND
        return self._format()


_VARIES = when("air.background", user="a background that varies")


class AirConfig(Section):
    """The air that a sniffer reads beside the exhaust: clean, but for a CO2 that may vary."""

    NEEDS: ClassVar[tuple[Need, ...]] = (SNIFFER,)

    background: Literal["none", "haze", "sine", "steps"] = "none"
    """How the CO2 of the air varies along a flight: not at all; as an Ornstein-Uhlenbeck process
    (haze); as a sine of any phase; or by steps at random times.
    """
    background_ppm: Annotated[NonNegative, _VARIES] = 2.0
    """Standard deviation of haze, amplitude of a sine, or standard deviation of a step [ppm]."""
    background_s: Annotated[float, Field(ge=1.0, le=10_000.0), _VARIES] = 30.0
    """Correlation time of haze, period of a sine, or mean time between steps [s]."""


class TurbulenceConfig(Section):
    """Turbulence of MIL-F-8785C, and discrete gusts."""

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    level: Literal["none", "light", "moderate", "severe"] = "none"
    """Severity of the turbulence; light, moderate and severe are 15, 30 and 45 knots of wind at 20
    feet.
    """
    gusts: Annotated[int, Field(ge=0, le=100)] = 0
    """Number of 1-cosine gusts, at random times and from random directions [-]."""
    gust_speed_mps: NonNegative = 0.0
    """Peak speed of the gusts [m/s]."""
    gust_length_s: Annotated[Positive, when("turbulence.gusts", user="gusts")] = 4.0
    """Time in which a gust rises, and in which it falls [s]."""

    @model_validator(mode="after")
    def _gusts(self) -> "TurbulenceConfig":
        if (self.gusts > 0) != (self.gust_speed_mps > 0.0):
            raise ValueError(
                f"gusts is {self.gusts} with a gust_speed_mps of {self.gust_speed_mps:g}; give"
                " turbulence.gusts and turbulence.gust_speed_mps, or neither"
            )
        return self

    @property
    def calm(self) -> bool:
        """Whether there is neither turbulence nor a gust."""
        return self.level == "none" and not self.gusts
