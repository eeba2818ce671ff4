"""How gusts move the aircraft off its reference: the guidance, linear about a turn, closed around
the linear aircraft.

In axes along and across the reference's course, which turn at omega_r, the error e from aircraft to
reference obeys e_along' = -dV + omega_r e_right and e_right' = -V dchi - omega_r e_along. The loop
is closed frequency by frequency, with the hold of the commands and the step by which the last one
is late.
"""

import numpy as np
import numpy.typing as npt

from gnc.airspeed import SpeedHold
from gnc.tracker import TrackingParameters
from innerloop.gusts import GUSTS, gust_loop
from innerloop.law import COMMANDS
from innerloop.schedule import Schedule
from scenarios.planning.margin.steering_gains import STEERED_BY, steering_gains

RESPONSES = ("along", "right", "pace")
"""Rows of ``tracking_response``: the error [m], and what the aircraft's own speed gives to keep
pace, which is the commanded airspeed as far as it is followed [m/s]."""

_READ = ("course_rate", "speed", "airspeed", "heading_rate")

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


def tracking_response(
    schedule: Schedule,
    index: int,
    bank_index: int,
    guidance: TrackingParameters,
    hold: SpeedHold,
    speed: float,
    frequencies: Array,
) -> Complex:
    """Return the response of ``RESPONSES`` to ``GUSTS`` over frequency, shape (frequencies, 3, 6).

    Parameters
    ----------
    schedule, index, bank_index : the autopilot and where it flies, as of ``gust_loop``
    guidance : whose steering it flies, its commands corrected by ``air_turn``
    hold : by which it keeps pace
    speed : V_r [m/s]
    frequencies : [rad/s], above 0
    """
    loop = gust_loop(schedule, index, bank_index)
    labels = list(loop.output_labels)
    whole = np.moveaxis(loop(1j * frequencies, squeeze=False), -1, 0)[
        :, [labels.index(name) for name in _READ]
    ]
    gusts = whole[:, :, len(COMMANDS) :]
    commands = whole[
        :, :, [COMMANDS.index("airspeed_command"), COMMANDS.index("heading_rate_command")]
    ]
    turn = schedule.gain_trim(index, bank_index).yaw_rate
    steering = dict(zip(STEERED_BY, steering_gains(guidance, turn, speed), strict=True))
    s = 1j * frequencies
    hold_of_step = np.exp(-0.5 * s * guidance.time_step) * np.sinc(
        0.5 * frequencies * guidance.time_step / np.pi
    )

    # Four equations for the error along and right and for the commanded airspeed and turn: left @
    # unknowns = right @ gusts.
    held, per_course = hold_of_step[:, None], (speed / s)[:, None]
    left, right = (
        np.zeros((len(s), 4, 4), dtype=complex),
        np.zeros((len(s), 4, len(GUSTS)), dtype=complex),
    )
    left[:, 0, 0], left[:, 0, 1] = s, -turn
    left[:, 0, 2:], right[:, 0] = commands[:, 1], -gusts[:, 1]
    left[:, 1, 0], left[:, 1, 1] = turn, s
    left[:, 1, 2:], right[:, 1] = per_course * commands[:, 0], -per_course * gusts[:, 0]
    left[:, 2, 0] = -hold_of_step * hold.gain
    left[:, 2, 2:], right[:, 2] = (
        -held * (commands[:, 2] - commands[:, 1]),
        held * (gusts[:, 2] - gusts[:, 1]),
    )
    left[:, 2, 2] += 1.0
    read = np.column_stack(
        [steering["course"] / s, *(np.full(len(s), steering[name]) for name in _READ[1:])]
    )
    left[:, 3, 0], left[:, 3, 1] = (
        -hold_of_step * steering["along"],
        -hold_of_step * steering["right"],
    )
    left[:, 3, 2:] = -held * np.einsum("fi,fij->fj", read, commands)
    left[:, 3, 3] += 1.0 - steering["last"] * np.exp(-s * guidance.time_step)
    right[:, 3] = held * np.einsum("fi,fij->fj", read, gusts)
    found = np.linalg.solve(left, right)
    return np.concatenate([found[:, :2], commands[:, 1, :1, None] * found[:, 2:3]], axis=1)
