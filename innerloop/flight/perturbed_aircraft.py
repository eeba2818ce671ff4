"""The aircraft that a search over reversals flies: as modelled, and those with which the design's margins are checked."""

import shutil
import tempfile
from pathlib import Path

from aircraft.spec import AircraftSpec
from innerloop.analysis.checks import NOMINAL
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.perturbed import Perturbation, perturb

CASES = {
    NOMINAL: Perturbation(),
    "control effectiveness +20 %": Perturbation(effectiveness=1.2),
    "control effectiveness -20 %": Perturbation(effectiveness=0.8),
    "mass +20 %": Perturbation(mass=1.2),
    "mass -20 %": Perturbation(mass=0.8),
    "inertia +20 %": Perturbation(inertia=1.2),
    "inertia -20 %": Perturbation(inertia=0.8),
}
"""Each perturbation by name, as of ``innerloop.analysis.perturbations``."""


def perturbed_aircraft(spec: AircraftSpec, root: Path) -> list[AutopilotedAircraft]:
    """Return the aircraft of ``CASES``, under the autopilot of a JSBSim root."""
    aircraft = []
    for case in CASES.values():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(shutil.copytree(root, Path(folder) / "root"))
            perturb(copy / "aircraft" / spec.files.model / f"{spec.files.model}.xml", case)
            aircraft.append(AutopilotedAircraft(spec, copy))
    return aircraft
