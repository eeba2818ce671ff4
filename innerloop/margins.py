"""Loop margins of the autopilot on the full linear aircraft: classical at each loop break, and disk margins."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import control
import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP
from innerloop.controller import COMMANDS, CONTROLS, MEASUREMENTS, linear_controller
from innerloop.schedule import Schedule

DELAY = 1.5 * TIME_STEP
"""One step of computing and half a step of hold between measurement and servo [s]."""

SENSOR_BREAKS = ("airspeed", "altitude", "heading_rate")
"""Measurements at which the loop is opened, besides the three controls."""

_FREQUENCIES = np.logspace(-2.0, 2.3, 600)


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """Margins with one loop opened and every other closed.

    Attributes
    ----------
    loop : where the loop is opened
    gain_db : least change of gain, up or down, that brings instability [dB]; infinite where none does
    phase_deg : least change of phase that does [deg]; infinite where none does
    crossover : highest gain crossover [rad/s]; nan where the gain never crosses 1
    disk_gain_db, disk_phase_deg : guaranteed for simultaneous changes of gain and phase [dB, deg]
    """

    loop: str
    gain_db: float
    phase_deg: float
    crossover: float
    disk_gain_db: float
    disk_phase_deg: float


def loop_margins(schedule: Schedule, index: int) -> list[Margin]:
    """Return the margins at design airspeed ``index``: each control, each regulated measurement, then all controls at once.

    The last row has disk margins only: it allows for simultaneous, independent changes in all three controls.
    """
    margins = [_margin(name, open_loop(schedule, index, (name,))) for name in (*CONTROLS, *SENSOR_BREAKS)]
    together = open_loop(schedule, index, CONTROLS)
    gain_db, phase_deg = _disk(together)
    nan = math.nan
    margins.append(
        Margin(loop="all controls", gain_db=nan, phase_deg=nan, crossover=nan, disk_gain_db=gain_db, disk_phase_deg=phase_deg)
    )
    return margins


def open_loop(schedule: Schedule, index: int, breaks: Sequence[str]) -> control.StateSpace:
    """Return the loop transfer function for negative feedback, opened at ``breaks`` and closed elsewhere.

    Parameters
    ----------
    schedule, index : the design and its airspeed
    breaks : names of controls or of measurements
    """
    aircraft, autopilot, delays = _blocks(schedule, index)
    connections: list[list[object]] = []
    inplist: list[str] = []
    outlist: list[str] = []
    for delay, name in zip(delays, CONTROLS, strict=True):
        connections.append([f"aircraft.{name}", f"{delay.name}.{name}"])
        if name in breaks:
            inplist.append(f"{delay.name}.{name}_delayed_in")
            outlist.append(f"-autopilot.{name}")
        else:
            connections.append([f"{delay.name}.{name}_delayed_in", f"autopilot.{name}"])
    for name in MEASUREMENTS:
        if name in breaks:
            inplist.append(f"autopilot.{name}")
            outlist.append(f"-aircraft.{name}")
        else:
            connections.append([f"autopilot.{name}", f"aircraft.{name}"])
    return control.interconnect(
        [aircraft, autopilot, *delays],
        connections=connections,
        inplist=inplist,
        outlist=outlist,
        inputs=[f"{name}_in" for name in breaks],
        outputs=[f"{name}_out" for name in breaks],
        warn_duplicate=False,
        check_unused=False,
    )


def closed_loop(schedule: Schedule, index: int) -> control.StateSpace:
    """Return the closed loop from ``COMMANDS`` to every output of the aircraft and to ``CONTROLS``."""
    aircraft, autopilot, delays = _blocks(schedule, index)
    connections: list[list[object]] = [[f"autopilot.{name}", f"aircraft.{name}"] for name in MEASUREMENTS]
    for delay, name in zip(delays, CONTROLS, strict=True):
        connections += [
            [f"aircraft.{name}", f"{delay.name}.{name}"],
            [f"{delay.name}.{name}_delayed_in", f"autopilot.{name}"],
        ]
    return control.interconnect(
        [aircraft, autopilot, *delays],
        connections=connections,
        inplist=[f"autopilot.{name}" for name in COMMANDS],
        outlist=[*(f"aircraft.{name}" for name in aircraft.output_labels), *(f"autopilot.{name}" for name in CONTROLS)],
        inputs=list(COMMANDS),
        outputs=[*aircraft.output_labels, *(f"{name}_command" for name in CONTROLS)],
        warn_duplicate=False,
        check_unused=False,
    )


def _blocks(schedule: Schedule, index: int) -> tuple[control.StateSpace, control.StateSpace, list[control.StateSpace]]:
    """Return the aircraft, the autopilot, and a delay in front of each control."""
    model = schedule.models[index]
    aircraft = control.ss(model, inputs=model.input_labels, outputs=model.output_labels, name="aircraft")
    delay = control.ss(control.tf(*control.pade(DELAY, 2)))
    delays = [control.ss(delay, inputs=[f"{name}_delayed_in"], outputs=[name], name=f"{name}_delay") for name in CONTROLS]
    return aircraft, linear_controller(schedule, index), delays


def _margin(name: str, loop: control.StateSpace) -> Margin:
    gains, phases, _, _, crossovers, _ = control.stability_margins(loop, returnall=True)
    gain_db = min((abs(20.0 * math.log10(g)) for g in np.atleast_1d(gains) if 0.0 < g < math.inf), default=math.inf)
    phase_deg = min((abs(float(p)) for p in np.atleast_1d(phases)), default=math.inf)
    crossover = max((float(w) for w in np.atleast_1d(crossovers)), default=math.nan)
    disk_gain_db, disk_phase_deg = _disk(loop)
    return Margin(
        loop=name,
        gain_db=gain_db,
        phase_deg=phase_deg,
        crossover=crossover,
        disk_gain_db=disk_gain_db,
        disk_phase_deg=disk_phase_deg,
    )


def _disk(loop: control.StateSpace) -> tuple[float, float]:
    _, gain_db, phase_deg = control.disk_margins(loop, _FREQUENCIES)
    return float(gain_db), float(phase_deg)


def frequency_response(loop: control.StateSpace, frequencies: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
    """Return the complex response of a single loop at ``frequencies`` [rad/s]."""
    response = loop(1j * frequencies)
    return np.asarray(np.squeeze(response), dtype=np.complex128)
