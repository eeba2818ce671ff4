"""Step responses, predicted by the linear design and flown in JSBSim, and their measures."""

import math
from dataclasses import dataclass

import control
import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.trim import Trim
from common.physics.coordinated_turn import heading_rate_for_bank
from common.physics.units import METRES_PER_FOOT
from innerloop.analysis.closed_loop import closed_loop
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.properties import HEADING_RATE
from innerloop.law.control_law import COMMANDS, ControlLaw
from innerloop.law.linear_controller import linear_controller
from innerloop.synthesis.schedule import LEVEL_GAINS, Schedule

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
"""Recorded quantities, by their name in the closed loop: JSBSim property and SI value of its unit.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Response to a step of one command.

    Attributes
    ----------
    command : name of the command, e.g. ``heading_rate``
    size : of the step [SI]
    time : shape (n,) [s], from the step
    channels : shape (n,) each, deviations from trim by name of ``CHANNELS`` [SI]
    """

    command: str
    size: float
    time: Array
    channels: dict[str, Array]

    def rise_time(self) -> float:
        """Return the time from 10 % to 90 % of the step [s]; nan if 90 % is never reached."""
        fraction = self.channels[self.command] / self.size
        if not (fraction >= 0.9).any():
            return math.nan
        return float(self.time[np.argmax(fraction >= 0.9)] - self.time[np.argmax(fraction >= 0.1)])

    def overshoot(self) -> float:
        """Return how far the response goes past the step, as a fraction of it."""
        return max(0.0, float(np.max(self.channels[self.command] / self.size)) - 1.0)

    def largest(self, channel: str) -> float:
        """Return the largest absolute deviation of a channel [SI]."""
        return float(np.max(np.abs(self.channels[channel])))


def predicted_step(
    schedule: Schedule, index: int, command: str, size: float, duration: float
) -> Response:
    """Return the linear design's response to a step of ``size`` [SI] at design airspeed ``index``."""
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
    """Return the response to a step of heading rate [rad/s] of the model that the aircraft follows."""
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
    """Return the response in JSBSim to a step of ``size`` [SI] from the equilibrium ``start``."""
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    if command == "airspeed":
        aircraft.command_airspeed(start.airspeed + size)
    elif command == "altitude":
        aircraft.command_altitude(start.altitude + size)
    else:
        aircraft.command_heading_rate(size)
    time, values = _record(aircraft.fdm, duration)
    return Response(
        command=command,
        size=size,
        time=time,
        channels={name: v - v[0] for name, v in zip(CHANNELS, values.T, strict=True)},
    )


def measure_lag(aircraft: AutopilotedAircraft, start: Trim, bank: float) -> float:
    """Return how long the flown heading rate lags its command [s]: the phase of a sinusoid, fitted
    over two periods after two.

    Half the heading rate of a turn at ``bank`` [rad] is the sinusoid's amplitude, and its frequency
    is that heading rate itself, near which those of the guidance lie.
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


def _record(fdm: Fdm, duration: float) -> tuple[Array, Array]:
    run, reads = fdm.run, [fdm.node(name).get_double_value for name, _ in CHANNELS.values()]
    count = round(duration / TIME_STEP)
    values = []
    for _ in range(count):
        values.append([read() for read in reads])
        run()
    return TIME_STEP * np.arange(count, dtype=np.float64), np.array(values) * [
        scale for _, scale in CHANNELS.values()
    ]
