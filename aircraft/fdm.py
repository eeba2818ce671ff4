"""One aircraft in JSBSim, in SI and radians, with typed and checked access to properties."""

import contextlib
import ctypes
import math
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import IO

import jsbsim

from aircraft.model import copy_model, remove_ground_contacts
from aircraft.spec import PROPERTY, AircraftError, AircraftSpec
from aircraft.state import RigidBodyState, Vector, with_wind
from common.physics import METRES_PER_FOOT

TIME_STEP = 1.0 / 120.0
"""Integration step of JSBSim [s]; the autopilot computes at every first, second or third step."""

EARTH_RATE = 7.292115e-5
"""Rotation rate of the earth, as in JSBSim's default planet [rad/s]."""

CLOCK = "simulation/sim-time-sec"
"""Property of the time since the last placing of the aircraft [s]."""

INTEGRATORS = tuple(
    f"simulation/integrator/{kind}/{motion}"
    for kind in ("rate", "position")
    for motion in ("rotational", "translational")
)
"""Properties that choose the integrators of the rigid body; 0 in all four holds the body still."""

START_ENGINES = (("propulsion/set-running", -1.0),)
"""Property that starts every engine at once, if JSBSim can do so for the engine's type."""

CRANK = (("propulsion/magneto_cmd", 3.0), ("propulsion/starter_cmd", 1.0))
"""Properties that start an engine as a pilot does: both magnetos and the starter."""

STOP_CRANKING = (("propulsion/starter_cmd", 0.0),)

RUN_UP_STEPS = 1200
"""Time steps of an engine's run-up; cranking takes as many before it."""

_INITIAL_STATE = (
    "ic/lat-geod-rad",
    "ic/long-gc-rad",
    "ic/h-sl-ft",
    "ic/phi-rad",
    "ic/theta-rad",
    "ic/psi-true-rad",
    "ic/u-fps",
    "ic/v-fps",
    "ic/w-fps",
    "ic/p-rad_sec",
    "ic/q-rad_sec",
    "ic/r-rad_sec",
)
"""JSBSim's initial conditions, in the order of setting them: each may change the others."""

_ACCELERATIONS = (
    *(f"accelerations/{component}dot-ft_sec2" for component in "uvw"),
    *(f"accelerations/{component}dot-rad_sec2" for component in "pqr"),
)
"""Rates of change of the body's velocity and angular rates [ft/s^2, rad/s^2]."""

_WIND = ("atmosphere/wind-north-fps", "atmosphere/wind-east-fps", "atmosphere/wind-down-fps")
"""Velocity of the air [ft/s]."""

_NORTH_WIND_MIN = 1e-6
"""Least wind to the north [ft/s]: in still air JSBSim does not align turbulence with the wind."""

_RESET_ONLY = 2
"""Mode of JSBSim's reset that does not run the initial conditions."""

_SETTLE_STRIDE = 4
"""Time steps between two checks whether accelerations still change."""

_SLOW_AFTER = 120
"""Time steps after which engines that still change count as slow."""

_SLOW_STEP_RATIO = 8
"""Step length for slow engines over the time step [-].

The longer step is still short: a piston engine takes a second to change its speed.
"""

_NAMED = re.compile(r'<\w+\s[^>]*?name\s*=\s*"([^"]+)"')
"""Named elements of a model's file: its functions and the components of its controls."""

_REASON_MOST = 300
"""Largest number of characters of JSBSim's output that a message quotes."""


class Fdm:
    """One aircraft in JSBSim.

    Properties are read and written in JSBSim's own units; an unknown name is refused. Everything
    else is in SI and radians.

    Parameters
    ----------
    spec : the aircraft
    root : JSBSim root to load the aircraft from, unchanged, such as one with an autopilot; by
        default a copy of the aircraft's model without autopilot, outputs, servo play and ground
        contacts
    time_step : integration step [s]

    Attributes
    ----------
    run : advances one time step
    cranked : whether an engine had to be started with its starter

    Raises
    ------
    AircraftError : the model's files are missing or JSBSim refuses them
    """

    def __init__(
        self, spec: AircraftSpec, root: Path | None = None, time_step: float = TIME_STEP
    ) -> None:
        self.spec = spec
        self.time_step = time_step
        if root is None:
            with tempfile.TemporaryDirectory() as copy:
                copy_model(spec.files, Path(copy), play=False)
                remove_ground_contacts(spec, Path(copy))
                self._exec = self._load(Path(copy))
        else:
            self._exec = self._load(root)
        self._exec.disable_output()
        self._properties = self._exec.get_property_manager()
        self._nodes: dict[str, jsbsim.FGPropertyNode] = {}
        self._initial = [self.writable_node(name) for name in _INITIAL_STATE]
        self._wind = [self.writable_node(name) for name in _WIND]
        self._accelerations = [self.node(name).get_double_value for name in _ACCELERATIONS]
        self._engines_started = False
        self.cranked = False
        # Bound to JSBSim's own method, because it is the innermost call of every flight.
        self.run: Callable[[], object] = self._exec.run

    def _load(self, root: Path) -> jsbsim.FGFDMExec:
        name, model = self.spec.name, self.spec.model
        model_file = root / "aircraft" / model / f"{model}.xml"
        if not model_file.is_file():
            raise AircraftError(
                f"aircraft '{name}': no model file {model_file}; check the JSBSim root directory"
            )
        raised = ""
        with captured() as printed:
            jsbsim.FGJSBBase().debug_lvl = 0  # type: ignore[no-untyped-call]
            executive = jsbsim.FGFDMExec(str(root))
            executive.set_debug_level(0)
            executive.set_dt(self.time_step)
            try:
                loaded = executive.load_model(model)
            except jsbsim.BaseError as error:
                loaded, raised = False, str(error)
        if not loaded:
            reason = _reason([*printed, raised], root)
            raise AircraftError(f"aircraft '{name}': JSBSim refused its model: {reason}")
        return executive

    # Properties

    def has(self, name: str) -> bool:
        """Whether there is a property of this name."""
        return self._find(name) is not None

    def node(self, name: str) -> jsbsim.FGPropertyNode:
        """Node of an existing property, for repeated access; JSBSim would create a missing one."""
        node = self._find(name)
        if node is None:
            raise AircraftError(
                f"aircraft '{self.spec.name}' has no JSBSim property '{name}'; check its spelling"
            )
        return node

    def not_finite(self) -> list[str]:
        """Names of properties whose value is not finite.

        The model's own functions and components come first, in the order of its file, then engines.
        """
        names = [line.split(" ")[0] for line in self._exec.query_property_catalog("").splitlines()]
        nodes = {name: self._find(name) for name in names}
        found = [
            name
            for name, node in nodes.items()
            if node and not math.isfinite(node.get_double_value())
        ]
        own = _NAMED.findall(self.spec.files.file.read_text(encoding="utf-8", errors="replace"))
        place = {name: number for number, name in enumerate(own)}
        last = len(place) + 1
        return sorted(
            found,
            key=lambda name: place.get(name, last - name.startswith("propulsion/engine")),
        )

    def _find(self, name: str) -> jsbsim.FGPropertyNode | None:
        if name in self._nodes:
            return self._nodes[name]
        # JSBSim's property tree ends the whole process at an invalid name.
        if not PROPERTY.fullmatch(name):
            return None
        node = self._properties.get_node(name)
        if not node:
            return None
        self._nodes[name] = node
        return node

    def writable_node(self, name: str) -> jsbsim.FGPropertyNode:
        """Node of an existing property that can be written."""
        node = self.node(name)
        if not node.get_attribute(jsbsim.Attribute.WRITE):
            raise AircraftError(
                f"JSBSim property '{name}' is read-only; a write to it would be ignored"
            )
        return node

    def read(self, name: str) -> float:
        """Value of a property in JSBSim's unit."""
        return float(self.node(name).get_double_value())

    def write(self, name: str, value: float) -> None:
        """Set a property in JSBSim's unit."""
        self.writable_node(name).set_double_value(value)

    # Placing

    def place(self, state: RigidBodyState, wind: tuple[float, float] | None = None) -> None:
        """Put the aircraft into ``state``, in the configuration of its spec.

        Engines are started at the first placing and keep running afterwards.

        Parameters
        ----------
        state : relative to the air
        wind : velocity of the air, north and east [m/s]; None for still air
        """
        self._initialise(state, wind)
        if not self._engines_started and self._start_engines():
            self._initialise(state, wind)

    def hold(
        self, state: RigidBodyState, steps: int, wind: tuple[float, float] | None = None
    ) -> None:
        """Place the aircraft, hold it for ``steps`` time steps, and release it in ``state``.

        Parameters
        ----------
        state : relative to the air
        steps : enough for servos and engines to come to rest
        wind : velocity of the air, north and east [m/s]; None for still air
        """
        self.allow_engine_restart()
        self.place(before_hold(state, steps * self.time_step), wind)
        with self.frozen():
            self.step(steps)

    def reset(self) -> None:
        """Reset JSBSim's models, such as turbulence and engines; place the aircraft next."""
        self._exec.reset_to_initial_conditions(_RESET_ONLY)
        self._engines_started = False

    def allow_engine_restart(self) -> None:
        """Let the next placing start engines that have stalled for lack of throttle."""
        self._engines_started = self._engines_started and self._engines_run()

    def _initialise(self, state: RigidBodyState, wind: tuple[float, float] | None) -> None:
        over_ground = with_wind(state, wind) if wind else state
        for node, (_, value) in zip(self._initial, initial_conditions(over_ground), strict=True):
            node.set_double_value(value)
        try:
            # Silencing takes time, and JSBSim prints only while engines are still to be started.
            with contextlib.nullcontext() if self._engines_started else silenced():
                placed = self._exec.run_ic()
        except jsbsim.BaseError as error:
            reason = " ".join(str(error).split(") ", 1)[-1].split())
            raise AircraftError(
                f"aircraft '{self.spec.name}' does not run in JSBSim alone: {reason}"
            ) from None
        if not placed:
            raise AircraftError(
                f"aircraft '{self.spec.name}': JSBSim refused the initial state {state}"
            )
        for name, value in self.spec.configuration:
            self.write(name, value)
        if wind:
            # Running the initial conditions has set their wind, which is 0.
            self.set_wind(*wind)

    def _start_engines(self) -> bool:
        """Start and run up every engine with the body held still; return whether time has passed.

        An engine that JSBSim cannot start at once is cranked as a pilot does. Engines run up at
        full throttle: from idle, a governed propeller can stay windmilling at its fine stop.
        """
        self._engines_started = True
        for name, value in START_ENGINES:
            self.write(name, value)
        if not self.spec.engine_flags:
            return False
        throttles = {name: self.read(name) for name in self.spec.input("throttle").commands}
        with self.frozen():
            for name in throttles:
                self.write(name, 1.0)
            self.cranked = not self._engines_run()
            if self.cranked:
                for name, value in CRANK:
                    self.write(name, value)
                self.step(RUN_UP_STEPS)
                for name, value in STOP_CRANKING:
                    self.write(name, value)
            self.step(RUN_UP_STEPS)
        for name, value in throttles.items():
            self.write(name, value)
        if not self._engines_run():
            seconds = RUN_UP_STEPS * self.time_step
            raise AircraftError(
                f"aircraft '{self.spec.name}': an engine does not run after {seconds:g} s of"
                f" cranking and {seconds:g} s more"
            )
        return True

    def _engines_run(self) -> bool:
        return all(self.read(name) > 0.5 for name in self.spec.engine_flags)

    # Flying

    def command(self, inputs: dict[str, float]) -> None:
        """Set control inputs by name, without limits [-]."""
        for name, value in inputs.items():
            control_input = self.spec.input(name)
            command = control_input.command(value)
            for commanded in control_input.commands:
                self.write(commanded, command)

    def set_wind(self, north: float, east: float) -> None:
        """Set the velocity of the air, north and east [m/s]."""
        north, east = north / METRES_PER_FOOT, east / METRES_PER_FOOT
        values = (north if abs(north) > _NORTH_WIND_MIN else _NORTH_WIND_MIN, east, 0.0)
        for node, value in zip(self._wind, values, strict=True):
            node.set_double_value(value)

    def step(self, count: int = 1) -> None:
        """Advance ``count`` time steps."""
        for _ in range(count):
            self.run()

    def stream(self, output: str) -> None:
        """Stream the aircraft's motion to another program, and fly in real time from now on.

        The flight stays the same to the last bit. Place the aircraft next: JSBSim's outputs start
        when it runs its initial conditions.

        Parameters
        ----------
        output : JSBSim's XML element ``<output>``, with the address and the contents

        Raises
        ------
        AircraftError : JSBSim rejects the output
        """
        with tempfile.TemporaryDirectory() as folder, silenced():
            path = Path(folder) / "output.xml"
            path.write_text(output, encoding="utf-8")
            accepted = self._exec.set_output_directive(str(path))
            self._exec.enable_output()
        if not accepted:
            raise AircraftError(f"JSBSim rejects the output {output}; check its address")
        self.run = paced(self._exec.run, self.time_step)

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """Hold the rigid body still in this context; servos, propellers and forces go on."""
        before = {name: self.read(name) for name in INTEGRATORS}
        for name in INTEGRATORS:
            self.write(name, 0.0)
        try:
            yield
        finally:
            for name, value in before.items():
                self.write(name, value)

    def settle(self, tolerance: float = 1e-9, steps_max: int = 4800) -> bool:
        """Step until all accelerations are steady, inside ``frozen``; return whether they are.

        After one second the steps get longer, because a piston engine's speed settles slowly.

        Parameters
        ----------
        tolerance : largest change of an acceleration in a step [m/s^2, rad/s^2]
        steps_max : number of steps after which the accelerations count as unsteady
        """
        if self._comes_to_rest(tolerance, min(_SLOW_AFTER, steps_max)):
            return True
        # The state of rest does not depend on the step length. Whether it has been reached is
        # judged with the time step of the flight.
        long_steps = max(0, steps_max - _SLOW_AFTER) // _SLOW_STEP_RATIO
        self._exec.set_dt(_SLOW_STEP_RATIO * self.time_step)
        try:
            self._comes_to_rest(tolerance, long_steps)
        finally:
            self._exec.set_dt(self.time_step)
        return self._comes_to_rest(tolerance, steps_max - _SLOW_AFTER - long_steps)

    def _comes_to_rest(self, tolerance: float, steps_max: int) -> bool:
        run = self.run
        limit = _SETTLE_STRIDE * tolerance
        before = [math.nan] * len(_ACCELERATIONS)
        for _ in range(0, steps_max, _SETTLE_STRIDE):
            for _ in range(_SETTLE_STRIDE):
                run()
            after = [read() for read in self._accelerations]
            for a, b in zip(after, before, strict=True):
                if not abs(a - b) <= limit * max(1.0, abs(a)):
                    break
            else:
                return True
            before = after
        return False

    def acceleration_body(self) -> Vector:
        """Rates of change of the body velocity components after the last step [m/s^2]."""
        u_dot, v_dot, w_dot = (read() * METRES_PER_FOOT for read in self._accelerations[:3])
        return u_dot, v_dot, w_dot

    def angular_acceleration(self) -> Vector:
        """Rates of change of p, q and r after the last step [rad/s^2]."""
        p_dot, q_dot, r_dot = (read() for read in self._accelerations[3:])
        return p_dot, q_dot, r_dot


def initial_conditions(state: RigidBodyState) -> list[tuple[str, float]]:
    """JSBSim's properties of an initial state, with values in JSBSim's units.

    The order matters to the last digit: JSBSim combines each value with the earlier ones.
    """
    u, v, w = (speed / METRES_PER_FOOT for speed in state.velocity_body)
    values = (
        state.latitude,
        state.longitude,
        state.altitude / METRES_PER_FOOT,
        state.roll,
        state.pitch,
        state.yaw,
        u,
        v,
        w,
        *state.rates_body,
    )
    return list(zip(_INITIAL_STATE, values, strict=True))


def before_hold(state: RigidBodyState, duration: float) -> RigidBodyState:
    """State that becomes ``state`` after the body is held still for ``duration`` [s].

    A held body stays fixed in inertial space while the earth turns under it. It is therefore placed
    further east by the distance that it will drift west.
    """
    return replace(state, longitude=state.longitude + EARTH_RATE * duration)


def paced(run: Callable[[], object], time_step: float) -> Callable[[], object]:
    """``run``, a simulation's step of ``time_step`` [s], slowed down to real time.

    A simulation that falls behind catches up as fast as it can.
    """
    began, steps = time.monotonic(), 0

    def run_and_wait() -> object:
        nonlocal steps
        result = run()
        steps += 1
        ahead = steps * time_step - (time.monotonic() - began)
        if ahead > 0.0:
            time.sleep(ahead)
        return result

    return run_and_wait


@contextlib.contextmanager
def silenced() -> Iterator[None]:
    """Discard what JSBSim prints to standard output and error, also if these are files."""
    with Path(os.devnull).open("w", encoding="utf-8") as sink, _printed_into(sink):
        yield


@contextlib.contextmanager
def captured() -> Iterator[list[str]]:
    """Same as ``silenced``; the printed lines are in the list after the end of the context."""
    lines: list[str] = []
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as sink:
        try:
            with _printed_into(sink):
                yield lines
        finally:
            sink.seek(0)
            lines.extend(sink.read().splitlines())


@contextlib.contextmanager
def _printed_into(sink: IO[str]) -> Iterator[None]:
    """Redirect standard output and error, of Python and of the process, into a file."""
    _flush()
    saved = {stream: os.dup(stream) for stream in (1, 2)}
    try:
        for stream in saved:
            os.dup2(sink.fileno(), stream)
        try:
            with contextlib.redirect_stdout(sink), contextlib.redirect_stderr(sink):
                yield
        finally:
            sink.flush()
            # Files and pipes are buffered: text left in a buffer would be printed after the
            # context.
            _flush()
    finally:
        for stream, copy in saved.items():
            os.dup2(copy, stream)
            os.close(copy)


def _reason(lines: list[str], root: Path) -> str:
    """One line that says why JSBSim refuses a model, made from its printed lines.

    Colours are removed, and so is the folder, which may be that of a copy.
    """
    said = [re.sub(r"\x1b\[[0-9;]*m", "", line).strip() for line in lines]
    said = [line for line in said if line and not line.startswith("JSBSim Flight Dynamics Model")]
    text = " ".join(dict.fromkeys(" ".join(said).replace(f"{root}/", "").split("\n")))
    text = " ".join(text.split())
    return text[:_REASON_MOST].rstrip(" .;") or "it gives no reason"


def _flush() -> None:
    """Flush the output buffers of Python and C."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)
