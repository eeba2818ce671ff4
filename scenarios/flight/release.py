"""The vehicle at the start of a flight."""

from typing import Protocol

from aircraft.fdm import Fdm
from aircraft.wind import CALM
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.planning.flight_plan import FlightPlan
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.vehicle import Vehicle
from scenarios.vehicles.vehicle_setup import VehicleSetup


class Viewer(Protocol):
    """Another program that shows an aircraft while its flight is replayed, in real time.

    Its class is called with the address that the user gives, and an installed package announces it
    in the group ``plume_flight_study.viewer``. Its name becomes an option of ``plume-flight run``.
    An address that is none is refused by an ``InputError``.
    """

    def show(self, fdm: Fdm) -> None:
        """Show an aircraft from now on; it is placed next."""
        ...


def failable(plan: FlightPlan) -> bool:
    """Return whether a part of the aircraft may fail in a flight."""
    return plan.world is not None and plan.world.fault.of_aircraft()


def release(
    plan: FlightPlan,
    setup: VehicleSetup,
    viewer: Viewer | None = None,
    *,
    flown: AutopilotedAircraft | None = None,
) -> Vehicle:
    """Return the vehicle at the start of a flight.

    Parameters
    ----------
    plan : the flight
    setup : of the aircraft, or of the kinematic vehicle
    viewer : shows the aircraft, in real time; none if not given
    flown : an aircraft that has flown before, to be used again; a fresh one if not given
    """
    start, world = plan.start, plan.world
    where = {
        "north": start.north,
        "east": start.east,
        "altitude": plan.altitude,
        "course": start.course,
    }
    aircraft = setup.aircraft
    if aircraft is None:
        wind = world.weather.wind if world else CALM
        return KinematicVehicle(
            **where, speed=plan.guidance.speed, time_step=plan.time_step, lag=setup.lag, wind=wind
        )
    flown = flown or AutopilotedAircraft(aircraft.spec, aircraft.model, failable=failable(plan))
    if viewer is not None:
        viewer.show(flown.fdm)
    # Still air needs no weather of its own.
    weather = world.weather if world and plan.sensing else None
    return JsbsimVehicle(
        flown, aircraft.start, aircraft.envelope, **where, time_step=plan.time_step, weather=weather
    )
