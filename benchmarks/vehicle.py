"""The X8 as flights of a scenario need it, for benchmarks."""

from pathlib import Path

from aircraft.fleet.x8 import X8
from innerloop.store import Designed
from scenarios.engine.run_directory import RunDirectory
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup, aircraft_setup, design_of


def x8_setup(scenario: Scenario, folder: Path) -> tuple[Designed, VehicleSetup]:
    """Return the X8's autopilot, and what flights of a scenario need; write its model into
    ``folder``.
    """
    design, refusal = design_of(X8, scenario.source_height)
    if design is None:
        raise SystemExit(f"error: {refusal}")
    return design, aircraft_setup(
        design, scenario, RunDirectory(folder / "run"), settings=[scenario]
    )
