"""A typed view of JSBSim in SI that refuses property names JSBSim does not have."""

import contextlib
import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import jsbsim

from aircraft.errors import AircraftError, ReadOnlyPropertyError, UnknownPropertyError
from aircraft.spec import AircraftSpec
from aircraft.state import RigidBodyState
from aircraft.units import METRES_PER_FOOT

TIME_STEP = 1.0 / 120.0
"""Integration step of JSBSim and of the autopilot inside it [s]."""

EARTH_RATE = 7.292115e-5
"""Rotation rate of the earth, as in JSBSim's default planet [rad/s]."""

_PROPERTY_NAME = re.compile(r"[A-Za-z_][\w.\-]*(\[\d+\])?(/[A-Za-z_][\w.\-]*(\[\d+\])?)*")

INTEGRATORS = tuple(
    f"simulation/integrator/{kind}/{motion}" for kind in ("rate", "position") for motion in ("rotational", "translational")
)
"""Properties that choose how the rigid body is integrated; 0 in all four holds it still."""


class Fdm:
    """One aircraft in JSBSim.

    Parameters
    ----------
    spec : the aircraft
    root : JSBSim root to load it from instead of the aircraft's own, e.g. one with an autopilot written into it
    time_step : integration step [s]

    Raises
    ------
    AircraftError : the model's files are missing or JSBSim refuses them
    """

    def __init__(self, spec: AircraftSpec, root: Path | None = None, time_step: float = TIME_STEP) -> None:
        self.spec = spec
        self.time_step = time_step
        root = root or spec.root
        model_file = root / "aircraft" / spec.model / f"{spec.model}.xml"
        if not model_file.is_file():
            raise AircraftError(f"aircraft '{spec.name}': no model file {model_file}; check the JSBSim root directory")
        with _silence():
            jsbsim.FGJSBBase().debug_lvl = 0  # type: ignore[no-untyped-call]
            self._exec = jsbsim.FGFDMExec(str(root))
            self._exec.set_debug_level(0)
            self._exec.set_dt(time_step)
            try:
                loaded = self._exec.load_model(spec.model)
            except jsbsim.BaseError:
                loaded = False
        if not loaded:
            raise AircraftError(f"aircraft '{spec.name}': JSBSim refused {model_file}; run JSBSim on it to see why")
        self._exec.disable_output()
        self._properties = self._exec.get_property_manager()
        self._motion = {name: self.read(name) for name in INTEGRATORS}
        self.run = self._exec.run
        """Advance one time step. Bound directly to JSBSim: the innermost call of every flight."""

    def node(self, name: str) -> jsbsim.FGPropertyNode:
        """Return the node of an existing property, for repeated access at the least cost."""
        # A name that is not one ends the whole process in JSBSim's property tree.
        node = self._properties.get_node(name) if _PROPERTY_NAME.fullmatch(name) else None
        if node is None:
            raise UnknownPropertyError(f"aircraft '{self.spec.name}' has no JSBSim property '{name}'; check its spelling")
        return node

    def writable_node(self, name: str) -> jsbsim.FGPropertyNode:
        """Return the node of an existing property that takes writes."""
        node = self.node(name)
        if not node.get_attribute(jsbsim.Attribute.WRITE):
            raise ReadOnlyPropertyError(f"JSBSim property '{name}' is read-only; a write to it would be ignored")
        return node

    def read(self, name: str) -> float:
        """Return a property in JSBSim's own unit."""
        return float(self.node(name).get_double_value())

    def write(self, name: str, value: float) -> None:
        """Set a property in JSBSim's own unit."""
        self.writable_node(name).set_double_value(value)

    def place(self, state: RigidBodyState) -> None:
        """Put the aircraft into ``state``, engines running. JSBSim then spins propellers up from rest: let them ``settle``."""
        for name, value in initial_conditions(state):
            self.write(name, value)
        if not self._exec.run_ic():
            raise AircraftError(f"aircraft '{self.spec.name}': JSBSim refused the initial state {state}")
        self.write("propulsion/set-running", -1.0)

    def command(self, inputs: dict[str, float]) -> None:
        """Set control inputs by name [-], unclipped."""
        for name, value in inputs.items():
            self.write(self.spec.input(name).command, value)

    def step(self, count: int = 1) -> None:
        """Advance ``count`` time steps."""
        for _ in range(count):
            self.run()

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """Hold the rigid body where it is while servos, propellers and forces go on, for trim and linearisation."""
        for name in INTEGRATORS:
            self.write(name, 0.0)
        try:
            yield
        finally:
            for name, value in self._motion.items():
                self.write(name, value)

    def hold(self, state: RigidBodyState, steps: int) -> None:
        """Place the aircraft and hold it for ``steps`` time steps, so that it is released in ``state`` with all else at rest."""
        self.place(before_hold(state, steps * self.time_step))
        with self.frozen():
            self.step(steps)

    def settle(self, tolerance: float = 1e-9, steps_max: int = 1200) -> bool:
        """Step, inside ``frozen``, until every driven state moves by less than ``tolerance`` of its size a step.

        Returns
        -------
        bool : whether that was reached within ``steps_max`` steps
        """
        nodes = [self.node(state.position) for state in self.spec.driven_states]
        before = [node.get_double_value() for node in nodes]
        for _ in range(steps_max):
            self.run()
            after = [node.get_double_value() for node in nodes]
            if all(abs(a - b) <= tolerance * max(1.0, abs(a)) for a, b in zip(after, before, strict=True)):
                return True
            before = after
        return False

    def velocity_body(self) -> tuple[float, float, float]:
        """Return forward, right and down velocity against the air [m/s]."""
        return self._vector("velocities/{}-aero-fps", "uvw", METRES_PER_FOOT)

    def acceleration_body(self) -> tuple[float, float, float]:
        """Return the rates of the body velocity components [m/s^2], as they stand after the last step."""
        return self._vector("accelerations/{}dot-ft_sec2", "uvw", METRES_PER_FOOT)

    def rates_body(self) -> tuple[float, float, float]:
        """Return roll, pitch and yaw rate [rad/s]."""
        return self._vector("velocities/{}-rad_sec", "pqr", 1.0)

    def angular_acceleration(self) -> tuple[float, float, float]:
        """Return the rates of p, q and r [rad/s^2], as they stand after the last step."""
        return self._vector("accelerations/{}dot-rad_sec2", "pqr", 1.0)

    def _vector(self, pattern: str, components: str, scale: float) -> tuple[float, float, float]:
        x, y, z = (self.read(pattern.format(component)) * scale for component in components)
        return x, y, z


def initial_conditions(state: RigidBodyState) -> list[tuple[str, float]]:
    """Return the properties, and their values in JSBSim's units, that set an initial state.

    The order matters to the last digit: JSBSim works each one into those before it.
    """
    u, v, w = (speed / METRES_PER_FOOT for speed in state.velocity_body)
    p, q, r = state.rates_body
    return [
        ("ic/lat-geod-rad", state.latitude),
        ("ic/long-gc-rad", state.longitude),
        ("ic/h-sl-ft", state.altitude / METRES_PER_FOOT),
        ("ic/phi-rad", state.roll),
        ("ic/theta-rad", state.pitch),
        ("ic/psi-true-rad", state.yaw),
        ("ic/u-fps", u),
        ("ic/v-fps", v),
        ("ic/w-fps", w),
        ("ic/p-rad_sec", p),
        ("ic/q-rad_sec", q),
        ("ic/r-rad_sec", r),
    ]


def before_hold(state: RigidBodyState, duration: float) -> RigidBodyState:
    """Return where to place a body that is to be in ``state`` after it was held for ``duration`` [s].

    A body that is held stands still among the stars while the earth turns under it, so it is placed as far east as it will drift
    west.
    """
    return replace(state, longitude=state.longitude + EARTH_RATE * duration)


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep the C++ start-up banner of JSBSim off standard output."""
    saved = os.dup(1)
    try:
        with Path(os.devnull).open("w", encoding="utf-8") as sink:
            os.dup2(sink.fileno(), 1)
            yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
