"""Compare responses of the linear models with responses flown in JSBSim.

The aircraft with its autopilot flies steps of the commands. The bare aircraft flies doublets of
single controls, which verify its linear model.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import control
import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.linearise import LinearModel
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE
from innerloop.law import COMMANDS, ControlLaw, linear_controller
from innerloop.margins import closed_loop
from innerloop.schedule import LEVEL_GAINS, Schedule

Array = npt.NDArray[np.float64]

CHANNELS: dict[str, tuple[str, float]] = {
    "airspeed": ("velocities/vt-fps", METRES_PER_FOOT),
    "altitude": ("position/h-sl-ft", METRES_PER_FOOT),
    "heading_rate": (HEADING_RATE, 1.0),
    "roll": ("attitude/phi-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "elevator_command": ("autopilot/elevator-command", 1.0),
    "aileron_command": ("autopilot/aileron-command", 1.0),
    "throttle_command": ("autopilot/throttle-command", 1.0),
}
"""Recorded quantities of a step response by name: JSBSim property, and SI value of its unit."""

OUTPUTS: dict[str, tuple[str, float]] = {
    "airspeed": ("velocities/vt-fps", METRES_PER_FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "p": ("velocities/p-rad_sec", 1.0),
    "q": ("velocities/q-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "roll": ("attitude/phi-rad", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
}
"""States that are compared after a doublet: JSBSim property, and SI value of its unit."""

_MOVED_BY = {
    "elevator": ("alpha", "q", "pitch"),
    "aileron": ("p", "roll"),
    "rudder": ("beta", "r"),
    "throttle": ("airspeed",),
}
"""States compared for each control: relative errors of states that barely move mean little."""

_DOUBLET_RECORDED = 6.0
"""Time over which a doublet's response is compared [s]."""

_DOUBLET_HALF = 1.0
"""Duration of either half of a doublet [s]."""

_DOUBLET_SIZE = 0.01
"""Deflection in either half of a doublet [-]."""

_SUBSTEPS = 8
"""Steps per time step in a doublet [-]: JSBSim's integration is of first order."""

_SETTLED = 1e-9
"""Change of acceleration per substep below which servos and engines count as settled.

With an engine lag of one second, an error of 1e-6 remains; a doublet causes at least 1e-2.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Response to a step of one command.

    Attributes
    ----------
    command : name of the command, such as ``heading_rate``
    size : size of the step [SI]
    time : time after the step, shape (n,) [s]
    channels : deviations from trim by name of ``CHANNELS``, shape (n,) each [SI]
    """

    command: str
    size: float
    time: Array
    channels: dict[str, Array]

    def rise_time(self) -> float:
        """Return the time from 10 % to 90 % of the step [s]; NaN if 90 % is never reached."""
        fraction = self.channels[self.command] / self.size
        if not (fraction >= 0.9).any():
            return math.nan
        return float(self.time[np.argmax(fraction >= 0.9)] - self.time[np.argmax(fraction >= 0.1)])

    def overshoot(self) -> float:
        """Return the overshoot as a fraction of the step [-]."""
        return max(0.0, float(np.max(self.channels[self.command] / self.size)) - 1.0)

    def largest(self, channel: str) -> float:
        """Return the largest absolute deviation of a channel [SI]."""
        return float(np.max(np.abs(self.channels[channel])))


def predicted_step(
    schedule: Schedule, index: int, command: str, size: float, duration: float
) -> Response:
    """Return the linear closed loop's response to a step of a command.

    Parameters
    ----------
    schedule, index : the design, and the index of its airspeed
    command, size, duration : name of the command, its step [SI], and the recorded time [s]
    """
    autopilot = linear_controller(ControlLaw(schedule), schedule.level(index))
    loop = closed_loop(schedule.models[index][LEVEL_GAINS], autopilot, schedule.delay)
    time = np.arange(0.0, duration, TIME_STEP)
    answer = control.step_response(
        loop, time, input=COMMANDS.index(f"{command}_command"), squeeze=False
    )
    labels = list(loop.output_labels)
    return Response(
        command=command,
        size=size,
        time=time,
        channels={name: size * answer.outputs[labels.index(name), 0] for name in CHANNELS},
    )


def model_step(schedule: Schedule, size: float, duration: float) -> Response:
    """Return the heading-rate model's response to a step of heading rate [rad/s]."""
    frequency, damping = schedule.weights.model_frequency, schedule.weights.model_damping
    time = np.arange(0.0, duration, TIME_STEP)
    model = control.tf([frequency**2], [1.0, 2.0 * damping * frequency, frequency**2])
    answer = control.step_response(model, time).outputs
    return Response(
        command="heading_rate", size=size, time=time, channels={"heading_rate": size * answer}
    )


def flown_step(
    aircraft: AutopilotedAircraft, start: Trim, command: str, size: float, duration: float
) -> Response:
    """Return the response flown in JSBSim to a step from an equilibrium; see ``predicted_step``."""
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    if command == "airspeed":
        aircraft.command_airspeed(start.airspeed + size)
    elif command == "altitude":
        aircraft.command_altitude(start.altitude + size)
    else:
        aircraft.command_heading_rate(size)
    time = TIME_STEP * np.arange(round(duration / TIME_STEP), dtype=np.float64)
    channels = _deviations(aircraft.fdm, CHANNELS, len(time), lambda _: None)
    return Response(command=command, size=size, time=time, channels=channels)


def measure_lag(aircraft: AutopilotedAircraft, start: Trim, bank: float) -> float:
    """Return the lag of the flown heading rate behind a slow sinusoidal command [s].

    The amplitude is half the heading rate of a turn at ``bank`` [rad]. The angular frequency equals
    that heading rate, close to the frequencies of the guidance. The phase is fitted over the third
    and fourth periods.
    """
    frequency = heading_rate_for_bank(bank, start.airspeed)
    amplitude = 0.5 * frequency
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    node = aircraft.fdm.node(HEADING_RATE)
    period = round(2.0 * math.pi / frequency / TIME_STEP)
    time = TIME_STEP * np.arange(4 * period)
    flown = np.empty(4 * period)
    for i, t in enumerate(time):
        aircraft.command_heading_rate(amplitude * math.sin(frequency * float(t)))
        aircraft.fdm.run()
        flown[i] = node.get_double_value()
    last = slice(2 * period, None)
    phasor = np.sum(flown[last] * np.exp(-1j * frequency * time[last]))
    commanded = np.sum(np.sin(frequency * time[last]) * np.exp(-1j * frequency * time[last]))
    return float(-np.angle(phasor / commanded) / frequency)


def verify_model(fdm: Fdm, model: LinearModel, level: Trim) -> list[dict[str, Any]]:
    """Return the largest error of predicted doublet responses, over the largest flown excursion.

    Each record has the control ``input``, the state ``output`` and the ``error`` [-], which is None
    if the state did not move. ``model`` is the linear model of ``fdm`` about the equilibrium
    ``level``. A new simulation with a finer time step flies the doublets.
    """
    fine = Fdm(fdm.spec, time_step=fdm.time_step / _SUBSTEPS)
    time = fine.time_step * np.arange(round(_DOUBLET_RECORDED / fine.time_step), dtype=np.float64)
    second_half = np.where(time < 2.0 * _DOUBLET_HALF, -_DOUBLET_SIZE, 0.0)
    doublet = np.where(time < _DOUBLET_HALF, _DOUBLET_SIZE, second_half)
    system = control.ss(model.A, model.B, model.C, model.D, inputs=model.input_labels)
    records = []
    for control_input in fdm.spec.inputs:
        name = control_input.name
        flown = _flown_with(fine, level, name, doublet)
        response = control.forced_response(system[:, name], time, doublet)
        for output in _MOVED_BY.get(name, ()):
            predicted = response.outputs[model.output_labels.index(output)]
            excursion = float(np.max(np.abs(flown[output])))
            error = float(np.max(np.abs(predicted - flown[output])))
            records.append(
                {"input": name, "output": output, "error": error / excursion if excursion else None}
            )
    return records


def _flown_with(fdm: Fdm, level: Trim, name: str, deflections: Array) -> dict[str, Array]:
    """Return the deviations of ``OUTPUTS`` from equilibrium, for a control's deflections [-]."""
    fdm.command(dict(level.inputs))
    fdm.allow_engine_restart()
    fdm.place(level.state())
    with fdm.frozen():
        fdm.settle(_SETTLED, round(fdm.spec.settle_time / fdm.time_step))
    at_rest = level.inputs[name]

    def deflect(step: int) -> None:
        fdm.command({name: at_rest + float(deflections[step])})

    return _deviations(fdm, OUTPUTS, len(deflections), deflect)


def _deviations(
    fdm: Fdm,
    quantities: Mapping[str, tuple[str, float]],
    steps: int,
    before_step: Callable[[int], None],
) -> dict[str, Array]:
    """Fly ``steps`` time steps; return the deviations of quantities from their first values [SI].

    ``before_step`` is called with each step's number, after the values have been read.
    """
    reads = [fdm.node(name).get_double_value for name, _ in quantities.values()]
    rows = []
    for step in range(steps):
        rows.append([read() for read in reads])
        before_step(step)
        fdm.run()
    values = np.array(rows) * [scale for _, scale in quantities.values()]
    return {name: v - v[0] for name, v in zip(quantities, values.T, strict=True)}
