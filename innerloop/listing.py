"""List which aircraft can be flown, and why the others cannot."""

import math
import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from aircraft.fleet.find import find_spec
from aircraft.spec import AircraftError
from common.interrupt import follow_parent
from innerloop.margins import NOMINAL
from innerloop.store import designed, is_cached


@dataclass(frozen=True, slots=True, kw_only=True)
class Discovered:
    """An aircraft by its name on the command line, and whether it can be flown.

    Attributes
    ----------
    flies : whether an autopilot can be designed; None if that has not been tried
    text : envelope and margins, or the reason why it cannot be flown
    """

    name: str
    flies: bool | None
    text: str


def look_up(name: str, altitude: float) -> Discovered:
    """Return the cached result for an aircraft at ``altitude`` [m], without a new design."""
    try:
        known = is_cached(find_spec(name), altitude)
    except AircraftError:
        # ``examine`` reports the same error.
        known = True
    if known:
        return examine(name, altitude)
    return Discovered(name=name, flies=None, text=f"not designed before for {altitude:g} m")


def discover(names: Sequence[str], altitude: float, jobs: int) -> Iterator[Discovered]:
    """Yield aircraft in the order of ``names``, each as soon as its design is known.

    Autopilots are designed at ``altitude`` [m] in ``jobs`` processes, so that an aircraft that ends
    JSBSim does not end the list.
    """
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(max_workers=jobs, mp_context=context, initializer=follow_parent)
    try:
        futures = {name: pool.submit(examine, name, altitude) for name in names}
        for name, future in futures.items():
            try:
                yield future.result()
            except BrokenProcessPool:
                yield _alone(name, altitude)
    finally:
        # An interrupted list does not wait for running designs, which can take a minute each.
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()


def _alone(name: str, altitude: float) -> Discovered:
    """Examine an aircraft in a new process, after a process of the pool has died."""
    with ProcessPoolExecutor(
        max_workers=1, mp_context=multiprocessing.get_context("spawn"), initializer=follow_parent
    ) as pool:
        try:
            return pool.submit(examine, name, altitude).result()
        except BrokenProcessPool:
            return Discovered(name=name, flies=False, text="JSBSim ends its whole process")


def examine(name: str, altitude: float) -> Discovered:
    """Design an aircraft's autopilot at ``altitude`` [m]; return whether it can be flown."""
    try:
        design = designed(find_spec(name), altitude).design
    except AircraftError as error:
        return Discovered(name=name, flies=False, text=_reason(name, str(error)))
    except Exception as error:  # noqa: BLE001 - one aircraft's failure must not end the list
        return Discovered(name=name, flies=False, text=f"{type(error).__name__}: {error}")
    envelope = design.schedule.envelope
    nominal = [check for check in design.checks if check.case == NOMINAL]
    gain = min(check.worst_gain.gain_db for check in nominal)
    phase = min(check.worst_phase.phase_deg for check in nominal)
    text = (
        f"{envelope.airspeed_min:.0f} to {envelope.airspeed_max:.0f} m/s,"
        f" {math.degrees(envelope.bank):.0f} deg of bank,"
        f" margins {math.floor(10.0 * gain) / 10.0:.1f} dB and {math.floor(phase):.0f} deg"
    )
    return Discovered(name=name, flies=True, text=text)


def _reason(name: str, message: str) -> str:
    """Return the message without the aircraft's name, which the list shows in front of it."""
    aircraft = f"aircraft '{Path(name).name}'"
    for prefix in (" cannot be flown: ", " cannot fly the study: ", " ", ": "):
        message = message.removeprefix(aircraft + prefix)
    return message
