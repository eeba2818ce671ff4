"""A typed view of JSBSim in SI."""

import contextlib
import math
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import jsbsim

from aircraft.errors import AircraftError
from aircraft.simulation.ground_contacts import leave_out_ground_contacts
from aircraft.simulation.model_copy import copy_model
from aircraft.simulation.pace import paced
from aircraft.simulation.properties import (
    ACCELERATION,
    ANGULAR_ACCELERATION,
    CRANK,
    INITIAL_STATE,
    INTEGRATORS,
    NORTH_WIND_MIN,
    RESET_ONLY,
    RUN_UP_STEPS,
    START_ENGINES,
    STOP_CRANKING,
    WIND,
    before_hold,
    component_names,
    initial_conditions,
)
from aircraft.simulation.property_tree import PropertyTree
from aircraft.simulation.silence import silenced
from aircraft.simulation.state import RigidBodyState, with_wind
from aircraft.spec import AircraftSpec
from common.physics.units import METRES_PER_FOOT

TIME_STEP = 1.0 / 120.0
"""Integration step of JSBSim [s]; the autopilot inside it computes every one, two or three of them.
"""

_SETTLE_STRIDE = 4

_PATIENCE, _HASTE = 120, 8
"""Time steps after which what has not come to rest counts as slow, and by how much longer steps it
is sped up [-]: they are still short against the second that a piston engine takes to change its
speed."""

_FLIGHTGEAR = '<output name="{host}" type="FLIGHTGEAR" port="{port}" protocol="UDP" rate="30"/>'
"""JSBSim's output of FlightGear's own packets."""


class Fdm(PropertyTree):
    """One aircraft in JSBSim.

    Parameters
    ----------
    spec : the aircraft
    root : JSBSim root to load it from unchanged, e.g. one with an autopilot written into it; by
        default a copy of the aircraft's own model without autopilot, outputs, servo play and ground
        contacts
    time_step : integration step [s]

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
                leave_out_ground_contacts(spec, Path(copy))
                self._exec = self._load(Path(copy))
        else:
            self._exec = self._load(root)
        self._exec.disable_output()
        super().__init__(spec.name, self._exec.get_property_manager())
        self._initial = [self.writable_node(name) for name in INITIAL_STATE]
        self._wind = [self.writable_node(name) for name in WIND]
        self._accelerations = [
            self.node(name)
            for name in (
                *component_names(ACCELERATION, "uvw"),
                *component_names(ANGULAR_ACCELERATION, "pqr"),
            )
        ]
        self._engines_run = self.cranked = False
        """Whether engines were started at all, and whether one of them had to be with its starter.
        """
        self.run: Callable[[], object] = self._exec.run
        """Advance one time step. Bound directly to JSBSim: the innermost call of every flight."""

    def _load(self, root: Path) -> jsbsim.FGFDMExec:
        name, model = self.spec.name, self.spec.model
        model_file = root / "aircraft" / model / f"{model}.xml"
        if not model_file.is_file():
            raise AircraftError(
                f"aircraft '{name}': no model file {model_file}; check the JSBSim root directory"
            )
        with silenced():
            jsbsim.FGJSBBase().debug_lvl = 0  # type: ignore[no-untyped-call]
            executive = jsbsim.FGFDMExec(str(root))
            executive.set_debug_level(0)
            executive.set_dt(self.time_step)
            try:
                loaded = executive.load_model(model)
            except jsbsim.BaseError:
                loaded = False
        if not loaded:
            raise AircraftError(
                f"aircraft '{name}': JSBSim refused its model '{model}'; run JSBSim on it to see why"
            )
        return executive

    def show(self, host: str, port: int) -> None:
        """Send the aircraft to FlightGear by JSBSim's own output from now on, and run no faster
        than the clock.

        The flight itself is the same to the last bit. Place the aircraft next: JSBSim's outputs
        begin with its initial conditions.
        """
        with tempfile.TemporaryDirectory() as folder, silenced():
            path = Path(folder) / "flightgear.xml"
            path.write_text(_FLIGHTGEAR.format(host=host, port=port), encoding="utf-8")
            accepted = self._exec.set_output_directive(str(path))
            self._exec.enable_output()
        if not accepted:
            raise AircraftError(
                f"JSBSim does not send to FlightGear at {host}:{port}; check the address"
            )
        self.run = paced(self._exec.run, self.time_step)

    def place(self, state: RigidBodyState, wind: tuple[float, float] | None = None) -> None:
        """Put the aircraft into ``state``, configured as its spec says. Engines keep running; the
        first time they are started.

        Parameters
        ----------
        state : against the air
        wind : velocity of the air, north and east [m/s]; None for still air
        """
        self._initialise(state, wind)
        if not self._engines_run and self._start_engines():
            self._initialise(state, wind)

    def renew(self) -> None:
        """Reset every model of JSBSim, such as turbulence, gusts and engines, as it was loaded;
        place it next.
        """
        self._exec.reset_to_initial_conditions(RESET_ONLY)
        self._engines_run = False

    def revive(self) -> None:
        """Let stopped engines start when the aircraft is placed next: too little throttle can stall
        them.
        """
        self._engines_run = self._engines_run and self._running()

    def _initialise(self, state: RigidBodyState, wind: tuple[float, float] | None) -> None:
        over_ground = with_wind(state, wind) if wind else state
        for node, (_, value) in zip(self._initial, initial_conditions(over_ground), strict=True):
            node.set_double_value(value)
        try:
            with contextlib.nullcontext() if self._engines_run else silenced():
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
            # Running its initial conditions, JSBSim sets their wind, which is 0.
            self.blow(*wind)

    def blow(self, north: float, east: float) -> None:
        """Let the wind blow north and east [m/s] from now on."""
        north, east = north / METRES_PER_FOOT, east / METRES_PER_FOOT
        values = (north if abs(north) > NORTH_WIND_MIN else NORTH_WIND_MIN, east, 0.0)
        for node, value in zip(self._wind, values, strict=True):
            node.set_double_value(value)

    def _start_engines(self) -> bool:
        """Start every engine, at once or as a pilot does, and run them up, the body held; return
        whether that took any time.

        A governed propeller that comes from idle can stay at its fine stop, windmilling; from full
        throttle it governs.
        """
        self._engines_run = True
        for name, value in START_ENGINES:
            self.write(name, value)
        if not self.spec.engine_flags:
            return False
        throttles = {name: self.read(name) for name in self.spec.input("throttle").commands}
        with self.frozen():
            for name in throttles:
                self.write(name, 1.0)
            self.cranked = not self._running()
            if self.cranked:
                for name, value in CRANK:
                    self.write(name, value)
                self.step(RUN_UP_STEPS)
                for name, value in STOP_CRANKING:
                    self.write(name, value)
            self.step(RUN_UP_STEPS)
        for name, value in throttles.items():
            self.write(name, value)
        if not self._running():
            seconds = RUN_UP_STEPS * self.time_step
            raise AircraftError(
                f"aircraft '{self.spec.name}': an engine does not run after {seconds:g} s of cranking and as much without"
            )
        return True

    def _running(self) -> bool:
        return all(self.read(name) > 0.5 for name in self.spec.engine_flags)

    def command(self, inputs: dict[str, float]) -> None:
        """Set control inputs by name [-], unclipped."""
        for name, value in inputs.items():
            control_input = self.spec.input(name)
            command = control_input.command(value)
            for commanded in control_input.commands:
                self.write(commanded, command)

    def step(self, count: int = 1) -> None:
        """Advance ``count`` time steps."""
        for _ in range(count):
            self.run()

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """Hold the rigid body where it is while servos, propellers and forces go on, for trim and
        linearisation.
        """
        before = {name: self.read(name) for name in INTEGRATORS}
        for name in INTEGRATORS:
            self.write(name, 0.0)
        try:
            yield
        finally:
            for name, value in before.items():
                self.write(name, value)

    def hold(
        self, state: RigidBodyState, steps: int, wind: tuple[float, float] | None = None
    ) -> None:
        """Place the aircraft and hold it for ``steps`` time steps, so that it is released in
        ``state`` with all else at rest.

        Parameters
        ----------
        state : against the air
        steps : enough for servos and engines to come to rest
        wind : velocity of the air, north and east [m/s]; None for still air
        """
        self.revive()
        self.place(before_hold(state, steps * self.time_step), wind)
        with self.frozen():
            self.step(steps)

    def settle(self, tolerance: float = 1e-9, steps_max: int = 4800) -> bool:
        """Step, inside ``frozen``, until no acceleration [m/s^2, rad/s^2] moves by more than
        ``tolerance`` a step.

        What takes longer than a second, such as the speed of a piston engine, is sped up by longer
        steps.

        Returns
        -------
        bool : whether that was reached within ``steps_max`` steps
        """
        if self._comes_to_rest(tolerance, min(_PATIENCE, steps_max)):
            return True
        # Where a slow engine comes to rest does not depend on the length of its steps. Whether it
        # has, those of flight decide.
        hasty = max(0, steps_max - _PATIENCE) // _HASTE
        self._exec.set_dt(_HASTE * self.time_step)
        try:
            self._comes_to_rest(tolerance, hasty)
        finally:
            self._exec.set_dt(self.time_step)
        return self._comes_to_rest(tolerance, steps_max - _PATIENCE - hasty)

    def _comes_to_rest(self, tolerance: float, steps_max: int) -> bool:
        run, reads, limit = (
            self.run,
            [node.get_double_value for node in self._accelerations],
            _SETTLE_STRIDE * tolerance,
        )
        before = [math.nan] * len(reads)
        for _ in range(0, steps_max, _SETTLE_STRIDE):
            for _ in range(_SETTLE_STRIDE):
                run()
            after = [read() for read in reads]
            for a, b in zip(after, before, strict=True):
                if not abs(a - b) <= limit * max(1.0, abs(a)):
                    break
            else:
                return True
            before = after
        return False

    def velocity_body(self) -> tuple[float, float, float]:
        """Return forward, right and down velocity against the air [m/s]."""
        return self._vector("velocities/{}-aero-fps", "uvw", METRES_PER_FOOT)

    def acceleration_body(self) -> tuple[float, float, float]:
        """Return the rates of the body velocity components [m/s^2], as they stand after the last
        step.
        """
        return self._vector(ACCELERATION, "uvw", METRES_PER_FOOT)

    def rates_body(self) -> tuple[float, float, float]:
        """Return roll, pitch and yaw rate [rad/s]."""
        return self._vector("velocities/{}-rad_sec", "pqr", 1.0)

    def angular_acceleration(self) -> tuple[float, float, float]:
        """Return the rates of p, q and r [rad/s^2], as they stand after the last step."""
        return self._vector(ANGULAR_ACCELERATION, "pqr", 1.0)

    def _vector(self, pattern: str, components: str, scale: float) -> tuple[float, float, float]:
        x, y, z = (self.read(name) * scale for name in component_names(pattern, components))
        return x, y, z
