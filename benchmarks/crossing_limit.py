"""The shortest crossing interval of any periodic path with two crossings a period, by direct
optimal control.

``python -m benchmarks.crossing_limit`` solves the problem with CasADi and IPOPT (of the ``dev``
extra), prints the table of docs/fastest_oscillation.md, and writes the limits that reports draw,
``scenarios/planning/crossing_limits.json``, with ``--write``, and the figure of the page
with ``--figure FILE``.

A path is one of a point of constant speed whose bank, and whose roll rate, are limited. Seen from
the vessel it is closed. It may turn to both sides as it likes; nothing is said of symmetry or of
when it rolls. Two kinds of closed paths are solved for: those whose course comes back to itself,
and those whose course has gone round once. Keeping out of the disc takes nothing from the rate: a
closed path can be moved astern as a whole.
"""

import argparse
import itertools
import json
import math
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from common.physics import bank_for_heading_rate
from gnc.errors import InfeasibleError
from gnc.reference.reference import REFERENCE_SHAPES
from scenarios.planning.limits import omega_max
from scenarios.planning.theory import CROSSING_LIMITS
from scenarios.scenario.sections.guidance import GuidanceConfig

if TYPE_CHECKING:
    import casadi as ca

RATIOS = tuple(round(0.05 * i, 2) for i in range(20))
"""Speed ratios of the limit line [-]."""

ROUND_MAX = 0.5
"""Largest speed ratio at which paths that go round are solved for: beyond, they take more than
twice as long [-].
"""

PIECES = 200
"""Pieces of a period, over each of which the roll rate is constant [-]."""

STARTS = (0.4, 0.1, 1.2, 2.0)
"""Phases at which first guesses begin, until the solver converges from one [rad]: none is
symmetric.
"""

SHAPES = {"sinusoid": "the paper's sinusoid", "fastest": "fastest oscillation", "loiter": "loiter"}
"""Shapes of the project, and their names in the figure."""

COLOURS = {"sinusoid": "#8a8a8a", "fastest": "#0072B2", "loiter": "#E69F00"}


def shortest_period(nu: float, turns: int, *, bank: float, roll_rate: float) -> float:
    """Return the shortest period of a closed path beside a vessel, times omega_max [-].

    Parameters
    ----------
    nu : speed ratio [-]
    turns : by which the course has gone round after a period, 0 or 1
    bank : largest [rad]
    roll_rate : largest, over omega_max [-]

    Raises
    ------
    RuntimeError : the solver did not converge from any start
    """
    for start in STARTS:
        try:
            return _solved(nu, turns, bank=bank, roll_rate=roll_rate, start=start)
        except RuntimeError as error:
            last = error
    raise RuntimeError(
        f"no shortest period at nu = {nu:g} with {turns} turns, from {len(STARTS)} starts: {last}"
    )


def _solved(nu: float, turns: int, *, bank: float, roll_rate: float, start: float) -> float:
    """Return the period that the solver finds from a first guess; parameters are those of
    ``shortest_period``.
    """
    import casadi as ca

    problem = ca.Opti()
    states, rolls, period = (
        problem.variable(4, PIECES + 1),
        problem.variable(1, PIECES),
        problem.variable(),
    )

    def rates(state: "ca.MX", roll: "ca.MX") -> "ca.MX":
        return ca.vertcat(
            ca.cos(state[2]) - nu, ca.sin(state[2]), ca.tan(state[3]) / math.tan(bank), roll
        )

    step = period / PIECES
    for k in range(PIECES):
        now, roll = states[:, k], rolls[0, k]
        first = rates(now, roll)
        second = rates(now + 0.5 * step * first, roll)
        third = rates(now + 0.5 * step * second, roll)
        fourth = rates(now + step * third, roll)
        problem.subject_to(
            states[:, k + 1] == now + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        )
    problem.subject_to(problem.bounded(-bank, states[3, :], bank))
    problem.subject_to(problem.bounded(-roll_rate, rolls, roll_rate))
    problem.subject_to(states[:2, 0] == 0.0)
    problem.subject_to(states[:2, PIECES] == 0.0)
    problem.subject_to(states[2, PIECES] == states[2, 0] + 2.0 * math.pi * turns)
    problem.subject_to(states[3, PIECES] == states[3, 0])
    problem.subject_to(problem.bounded(0.5, period, 100.0))
    problem.minimize(period)
    course, length = _guess(nu, turns, start)
    problem.set_initial(period, length)
    problem.set_initial(states[2, :], course)
    turning = np.gradient(course) * PIECES / length
    problem.set_initial(
        states[3, :], np.clip(np.arctan(turning * math.tan(bank)), -0.9 * bank, 0.9 * bank)
    )
    places = np.cumsum(np.stack([np.cos(course) - nu, np.sin(course)]), axis=1) * length / PIECES
    problem.set_initial(states[:2, :], places - places[:, :1])
    problem.solver(
        "ipopt",
        {"print_time": False},
        {"print_level": 0, "sb": "yes", "max_iter": 2000, "tol": 1e-9},
    )
    return float(problem.solve().value(period))


def _guess(nu: float, turns: int, start: float) -> tuple[np.ndarray, float]:
    """Return a course that is a sinusoid, or goes round evenly, and the period."""
    part = np.linspace(0.0, 1.0, PIECES + 1)
    if turns:
        return 2.0 * np.pi * part + start, 2.0 * math.pi / (1.0 - nu)
    amplitude = 2.0 * math.sqrt(1.0 - nu) + 0.3
    return amplitude * np.cos(2.0 * np.pi * part + start), 4.0 * amplitude


def limits(guidance: GuidanceConfig) -> dict[str, object]:
    """Return the limits of an aircraft's bank and roll rate over the speed ratio, as they are
    written.
    """
    rate = omega_max(guidance)
    bank = math.radians(guidance.bank_deg)
    ratio = math.radians(guidance.roll_rate_max_deg_s) / rate
    found: dict[str, list[float | None]] = {"oscillating": [], "going_round": []}
    for nu, (turns, name) in itertools.product(RATIOS, enumerate(found)):
        solved = nu <= ROUND_MAX or turns == 0
        found[name].append(
            round(0.5 * shortest_period(nu, turns, bank=bank, roll_rate=ratio), 5)
            if solved
            else None
        )
    return {
        "what": (
            "shortest crossing interval times omega_max, two crossings a period, by speed"
            " ratio; null where not solved for"
        ),
        "source": (
            f"python -m benchmarks.crossing_limit --write; CasADi {version('casadi')} with"
            f" IPOPT, {PIECES} pieces a period"
        ),
        "bank_deg": guidance.bank_deg,
        "roll_rate_over_omega_max": round(ratio, 6),
        "nu": list(RATIOS),
        **found,
    }


def designed(guidance: GuidanceConfig, shape: str, nu: float, *, reserve: float = 0.0) -> float:
    """Return the crossing interval of a shape [s]; not a number where it has none."""
    try:
        orbit = REFERENCE_SHAPES.get(shape)().design(
            nu=nu,
            speed=guidance.airspeed_mps,
            heading_rate_max=omega_max(guidance),
            reserve=reserve,
            vessel_heading_rate=0.0,
            roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
        )
    except InfeasibleError:
        return math.nan
    return orbit.crossing_interval


def _figure(guidance: GuidanceConfig, found: dict[str, Any], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    (interval, bank), (course, orbit) = figure.subplots(2, 2)
    ratios = np.linspace(0.0, 0.97, 98)
    for shape, label in SHAPES.items():
        interval.plot(
            ratios,
            [designed(guidance, shape, nu) for nu in ratios.tolist()],
            color=COLOURS[shape],
            label=label,
        )
        made = REFERENCE_SHAPES.get(shape)()
        flown = made.design(
            nu=0.25, speed=guidance.airspeed_mps, heading_rate_max=omega_max(guidance), reserve=0.0, vessel_heading_rate=0.0,
            roll_rate_max=math.radians(guidance.roll_rate_max_deg_s),
        )  # fmt: skip
        times = np.linspace(0.0, flown.period, 400)
        phases = (flown.omega_0 * times).tolist()
        rates = [flown.heading_rate(phase) for phase in phases]
        bank.plot(
            times,
            [math.degrees(bank_for_heading_rate(rate, flown.speed)) for rate in rates],
            color=COLOURS[shape],
        )
        course.plot(
            times, [math.degrees(flown.course(phase)) for phase in phases], color=COLOURS[shape]
        )
        along, right = flown.offset(times)
        orbit.plot(right, along, color=COLOURS[shape])
    unit = omega_max(guidance)
    for name, mark in (("oscillating", "o"), ("going_round", "s")):
        shown = [
            (nu, value / unit)
            for nu, value in zip(found["nu"], found[name], strict=True)
            if value is not None
        ]
        label = f"optimal control, {name.replace('_', ' ')}"
        interval.plot(
            *zip(*shown, strict=True), mark, color="#222222", fillstyle="none", label=label
        )
    interval.set(xlabel="Speed ratio [-]", ylabel="Crossing interval [s]", ylim=(0.0, 20.0))
    interval.legend(fontsize=8)
    bank.set(xlabel="Time [s]", ylabel="Bank [deg]", title="nu = 0.25")
    course.set(xlabel="Time [s]", ylabel="Course off the vessel's [deg]")
    orbit.set(xlabel="To the right [m]", ylabel="Along the vessel's course [m]", aspect="equal")
    for axes in (interval, bank, course, orbit):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the table, and write what is asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--write", action="store_true", help=f"solve anew, and write {CROSSING_LIMITS.name}"
    )
    parser.add_argument("--figure", type=Path, help="file of the figure, as PNG")
    asked = parser.parse_args()
    guidance = GuidanceConfig()
    if asked.write:
        CROSSING_LIMITS.write_text(json.dumps(limits(guidance), indent=1) + "\n", encoding="utf-8")
    found = json.loads(CROSSING_LIMITS.read_text(encoding="utf-8"))
    print(
        "| nu | optimal control, oscillating | fastest | optimal control, going round | loiter"
        " | sinusoid |"
    )
    print("|---|---|---|---|---|---|")
    for i, nu in enumerate(found["nu"]):
        solved = [found[name][i] for name in ("oscillating", "going_round")]
        best = [
            f"{value / omega_max(guidance):.3f}" if value is not None else "" for value in solved
        ]
        shapes = [
            f"{designed(guidance, shape, nu):.3f}" for shape in ("fastest", "loiter", "sinusoid")
        ]
        print(f"| {nu:g} | {best[0]} | {shapes[0]} | {best[1]} | {shapes[1]} | {shapes[2]} |")
    if asked.figure:
        _figure(guidance, found, asked.figure)


if __name__ == "__main__":
    main()
