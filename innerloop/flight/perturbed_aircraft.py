"""The aircraft that a search over reversals flies: as modelled, and those with which the design's
margins are checked.
"""

import math
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from aircraft.model import PERTURBATIONS, Perturbation, perturb, remove_ground_contacts
from aircraft.spec import AircraftSpec
from innerloop.analysis.checks import NOMINAL
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.reversal_search import ReversalSearch

CASES = {NOMINAL: Perturbation(), **PERTURBATIONS}
"""The aircraft by name, in the order in which ``perturbed_aircraft`` returns them."""


def perturbed_aircraft(spec: AircraftSpec, root: Path) -> list[AutopilotedAircraft]:
    """Return the aircraft of ``CASES``, under the autopilot of a JSBSim root."""
    return [_flying(spec, root, case) for case in CASES.values()]


def aircraft_as_modelled(spec: AircraftSpec, root: Path) -> AutopilotedAircraft:
    """Return the first of them alone."""
    return _flying(spec, root, CASES[NOMINAL])


def _flying(spec: AircraftSpec, root: Path, case: Perturbation) -> AutopilotedAircraft:
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(root, Path(folder) / "root"))
        perturb(copy / "aircraft" / spec.files.model / f"{spec.files.model}.xml", case)
        remove_ground_contacts(spec, copy)
        return AutopilotedAircraft(spec, copy)


def deviations_by_case(searches: Sequence[ReversalSearch]) -> dict[str, float]:
    """Return the largest deviation of each aircraft that flew a reversal in one of the searches
    [m].
    """
    found = {case: max(search.deviations[i] for search in searches) for i, case in enumerate(CASES)}
    return {case: deviation for case, deviation in found.items() if math.isfinite(deviation)}
