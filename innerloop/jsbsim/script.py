"""Write a JSBSim script that flies an aircraft under its autopilot without Python."""

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

from aircraft.fdm import (
    CRANK,
    INTEGRATORS,
    RUN_UP_STEPS,
    START_ENGINES,
    STOP_CRANKING,
    TIME_STEP,
    Fdm,
    before_hold,
    initial_conditions,
)
from aircraft.spec import Envelope
from aircraft.trim import Trim
from common.physics import heading_rate_for_bank
from innerloop.jsbsim.system import (
    AIRSPEED_COMMAND,
    ALTITUDE_COMMAND,
    BANK_COMMAND,
    HEADING_RATE,
    HEADING_RATE_COMMAND,
    RESET,
    hold_steps,
)
from innerloop.schedule import Schedule

OUTPUT_RATE = 20.0
"""Rate of rows in the script's output file [Hz]."""

_AFTERWARDS = 10.0
"""Flight time after the last command [s]."""

_MOTION = (
    "position/lat-geod-deg",
    "position/long-gc-deg",
    "position/h-sl-meters",
    "autopilot/airspeed-mps",
    "autopilot/climb-rate-mps",
    "attitude/phi-rad",
    "attitude/theta-rad",
    "attitude/psi-rad",
    "aero/alpha-rad",
    "aero/beta-rad",
    HEADING_RATE,
    AIRSPEED_COMMAND,
    ALTITUDE_COMMAND,
    HEADING_RATE_COMMAND,
    BANK_COMMAND,
)


class Command(NamedTuple):
    """A command: time after the release [s], JSBSim property, value [SI], and note in words."""

    time: float
    name: str
    value: float
    note: str


def demonstration(envelope: Envelope, start: Trim) -> tuple[Command, ...]:
    """Return commands that demonstrate the autopilot: turn, climb, change speed, and back.

    The flight begins in the level equilibrium ``start``. Turns have a quarter of the heading rate
    at the largest commanded bank. The altitude changes by the distance flown in half a second. The
    airspeed changes towards the farther end of the envelope, by a tenth or by half the distance to
    that end, whichever is less.
    """
    heading_rate = 0.25 * heading_rate_for_bank(envelope.bank_max, start.airspeed)
    altitude_step = 0.5 * start.airspeed
    below, above = start.airspeed - envelope.airspeed_min, envelope.airspeed_max - start.airspeed
    airspeed_step = math.copysign(min(0.1 * start.airspeed, 0.5 * max(below, above)), above - below)
    higher, faster = start.altitude + altitude_step, start.airspeed + airspeed_step
    turn = f"{math.degrees(heading_rate):.3g} degrees a second"
    climb = f"Change altitude by {altitude_step:+.3g} m."
    accelerate = f"Change airspeed by {airspeed_step:+.3g} m/s."
    return (
        Command(5.0, HEADING_RATE_COMMAND, heading_rate, f"Turn right at {turn}."),
        Command(20.0, HEADING_RATE_COMMAND, 0.0, "Fly straight on."),
        Command(25.0, ALTITUDE_COMMAND, higher, climb),
        Command(40.0, AIRSPEED_COMMAND, faster, accelerate),
        Command(55.0, ALTITUDE_COMMAND, start.altitude, "Come back to the altitude of the start."),
        Command(55.0, AIRSPEED_COMMAND, start.airspeed, "Come back to the airspeed of the start."),
        Command(70.0, HEADING_RATE_COMMAND, -heading_rate, f"Turn left at {turn}."),
        Command(85.0, HEADING_RATE_COMMAND, 0.0, "Fly straight on."),
    )


def write_script(schedule: Schedule, root: Path) -> Path:
    """Write a JSBSim script of ``demonstration`` into a root of ``write_root``; return its path.

    The script releases the aircraft in the same way as ``AutopilotedAircraft.release``, at 0 s of
    its clock, in level flight at the middle design airspeed.
    """
    spec, start = schedule.spec, schedule.level(schedule.middle)
    commands = demonstration(schedule.envelope, start)
    fdm = Fdm(spec, root)
    fdm.place(start.state())
    name = f"{spec.model}_autopilot"
    (root / "aircraft" / spec.model / f"{name}_init.xml").write_text(
        _INITIALISATION.format(name=name), encoding="utf-8"
    )
    held, preparations = _preparations(fdm, schedule.period)
    integrating = [(integrator, fdm.read(integrator)) for integrator in INTEGRATORS]
    release = "Release: let the body and the autopilot's integrators go."
    events = [
        *preparations,
        _event(release, 0, [*integrating, (RESET, 0.0)]),
        *(_event(c.note, round(c.time / TIME_STEP), [(c.name, c.value)]) for c in commands),
    ]
    script = root / "scripts" / f"{name}.xml"
    script.parent.mkdir(exist_ok=True)
    text = _SCRIPT.format(
        title=escape(spec.title, {'"': "&quot;"}),
        name=name,
        model=spec.model,
        start=-held * TIME_STEP,
        end=commands[-1].time + _AFTERWARDS,
        step=TIME_STEP,
        rate=OUTPUT_RATE,
        before=_initial_properties(start, held * TIME_STEP),
        events="\n".join(events),
        columns="\n".join(
            f'    <property caption="{column}">{column}</property>' for column in columns(fdm)
        ),
    )
    script.write_text(text, encoding="utf-8")
    return script


def _preparations(fdm: Fdm, period: int) -> tuple[int, list[str]]:
    """Return the number of time steps in which the body is held, and the events in that time."""
    settle = hold_steps(fdm.spec, period)
    run_up = (2 if fdm.cranked else 1) * RUN_UP_STEPS if fdm.spec.engine_flags else 0
    held = settle + run_up
    still = [(integrator, 0.0) for integrator in INTEGRATORS]
    cranking = CRANK if fdm.cranked else ()
    start = [*START_ENGINES, *cranking, *fdm.spec.configuration, *still]
    begin = "Start the engines, and hold the body still while servos and engines settle."
    events = [_event(begin, -held, start)]
    if fdm.cranked:
        events.append(_event("Let the starter go.", -held + RUN_UP_STEPS, STOP_CRANKING))
    if run_up:
        again = "Gear, fuel and levers again, as they are in flight."
        events.append(_event(again, -settle, fdm.spec.configuration))
    return held, events


def columns(fdm: Fdm) -> list[str]:
    """Return the columns of the script's output file after ``Time``, as JSBSim properties.

    They are motion, commands, controls and engines of the aircraft with its autopilot, ``fdm``.
    """
    names = [
        *_MOTION,
        *(command for i in fdm.spec.inputs for command in i.commands),
        *(s.position for s in fdm.spec.driven_states),
    ]
    # The property set-running is not used: it is 0 for a running electric motor.
    thrusts = (f"propulsion/engine[{engine}]/thrust-lbs" for engine in itertools.count())
    return [*names, *itertools.takewhile(fdm.has, thrusts)]


def _initial_properties(start: Trim, held: float) -> str:
    """Return the properties to set before the initial state, for a body held for ``held`` [s]."""
    values = (
        *initial_conditions(before_hold(start.state(), held)),
        (AIRSPEED_COMMAND, start.airspeed),
        (ALTITUDE_COMMAND, start.altitude),
        (HEADING_RATE_COMMAND, 0.0),
        (RESET, -1.0),
    )
    return "\n".join(f'    <property value="{value!r}">{name}</property>' for name, value in values)


def _event(note: str, step: int, values: Sequence[tuple[str, float]]) -> str:
    """Return an event that sets values ``step`` time steps after the release.

    JSBSim advances its clock before it evaluates events, and the clock accumulates rounding errors.
    The condition therefore stands half a step later, between two steps.
    """
    lines = "\n".join(
        f'      <set name="{name}" value="{float(value)!r}"/>' for name, value in values
    )
    condition = f"simulation/sim-time-sec ge {(step + 0.5) * TIME_STEP!r}"
    return _EVENT.format(note=note, condition=condition, time=step * TIME_STEP, sets=lines)


_INITIALISATION = """<?xml version="1.0"?>
<!-- Written by innerloop.jsbsim.script. JSBSim asks for this file; the script itself sets the
     state, in the order that makes the flight the same to the last digit as one from Python. -->
<initialize name="{name}_init">
</initialize>
"""

_SCRIPT = """<?xml version="1.0"?>
<!-- Written by innerloop.jsbsim.script; write it again rather than editing. -->
<runscript name="{title} under its autopilot">
  <description>
    Flies the {title} under its autopilot, in JSBSim alone. To run it, in the directory that holds
    scripts/ and aircraft/:

      JSBSim --script=scripts/{name}.xml

    or from anywhere, where ROOT is that directory and OUT the one for the result, both as full
    paths:

      JSBSim --root=ROOT --outputpath=OUT --script=scripts/{name}.xml

    Where JSBSim came with its Python package, the program is called jsbsim. The result is
    {name}.csv. Its columns are JSBSim properties with the unit in their names; those without one
    are -1 to 1 or, for throttles, 0 to 1. The clock is 0 s at release.
  </description>

  <use aircraft="{model}" initialize="{name}_init"/>

  <run start="{start!r}" end="{end!r}" dt="{step!r}">
    <!-- In force from the start: level flight, as far east of its place as the earth turns while
         the body is held; commands to stay there; the autopilot's integrators held at 0. -->
{before}
{events}
  </run>

  <output name="{name}.csv" type="CSV" rate="{rate:g}">
{columns}
  </output>
</runscript>
"""

_EVENT = """
    <!-- At {time:g} s: {note} -->
    <event name="{note}">
      <condition>{condition}</condition>
{sets}
      <notify/>
    </event>"""
