"""What a scenario file may say of a ship's exhaust. Without a ship there is none."""

from typing import Annotated

from pydantic import Field, field_validator

from measurement.emission.fuel import SULPHUR_MAX_PERCENT, fuel_preset
from measurement.emission.ship import ship_preset
from scenarios.schema.section import Section


class EmissionConfig(Section):
    """What comes out of the funnel."""

    ship: str | None = None
    """The ship whose engine and funnel it has, one of measurement/emission/ships.toml; none without exhaust."""
    fuel: str = "mgo"
    """Its fuel, one of measurement/emission/fuels.toml."""
    sulphur_percent: Annotated[float, Field(ge=0.0, le=SULPHUR_MAX_PERCENT)] | None = None
    """Sulphur in the fuel by mass; the fuel's usual if not given [%]."""
    load: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    """Load of the engine; what the speed takes if not given, which is what the guidance expects [-]."""

    @field_validator("ship")
    @classmethod
    def _known_ship(cls, ship: str | None) -> str | None:
        if ship is not None:
            ship_preset(ship)
        return ship

    @field_validator("fuel")
    @classmethod
    def _known_fuel(cls, fuel: str) -> str:
        fuel_preset(fuel)
        return fuel
