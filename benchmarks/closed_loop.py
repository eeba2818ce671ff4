"""``make bench``: computing time of the autopilot and the guidance, relative to JSBSim.

Three loops over the same simulated time run in one process, in turn, for several rounds: JSBSim
with the bare aircraft, JSBSim with the autopilot, and the full closed loop with guidance and
record. The results are medians over the rounds; ratios are formed within a round, in which the
speed of the machine is the same. The time of the full closed loop is printed beside its limits, and
the time of the other parts of a flight: planning, aircraft and release, figures, time history. Then
come guidance, engine and reports.
"""

import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.fleet.x8 import X8
from benchmarks.engine import REFERENCE_STEP, report_engine
from benchmarks.guidance import report_guidance
from benchmarks.reports import report_reports
from benchmarks.vehicle import x8_setup
from gnc.compiled import compiled_modules
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.flight.closed_loop import fly, release
from scenarios.flight.time_history import flight_history
from scenarios.measures.figures import flight_figures
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import checked, load_document
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup

ROUNDS, STUDIES = 15, 3
"""Rounds of the loops, and of whole studies."""

SIMULATED_TIME = 400.0
"""Simulated time of each loop [s]."""

FLIGHT_MAX, LOOP_MAX = 0.25, 1.7
"""Limits of the time of a flight where a step of JSBSim alone takes ``REFERENCE_STEP`` [s], and of
its ratio to JSBSim [-].
"""

Timed = Callable[[], float]
"""Runs a part and returns its computing time [s]."""


def main() -> None:
    """Print the benchmark."""
    # So many crossings are never reached: the flight ends by its duration.
    words = [
        "vessel.speed_ratio=0.5",
        "start.course_deg=0.0",
        f"flight.duration_max_s={SIMULATED_TIME}",
        "flight.crossings=10000",
    ]
    scenario = checked(load_document("sweep_nu", words), Scenario)
    with tempfile.TemporaryDirectory() as folder:
        setup = x8_setup(scenario, Path(folder))[1]
        runs, parts = _loops(scenario, setup, Path(folder))
        for run in runs.values():
            run()
        times: dict[str, list[float]] = {name: [] for name in runs}
        for _ in range(ROUNDS):
            for name, run in runs.items():
                times[name].append(run())
        other_parts = {
            name: statistics.median(part() for _ in range(ROUNDS)) for name, part in parts.items()
        }
        print(
            "guidance: "
            + (
                "compiled"
                if compiled_modules()
                else "its sources are run; `make fast` compiles them"
            )
        )
        _report(times)
        named = ", ".join(f"{name} {1e3 * seconds:.1f}" for name, seconds in other_parts.items())
        print(f"the other parts of a flight take {1e3 * sum(other_parts.values()):.1f} ms: {named}")
        report_guidance(ROUNDS, setup)
        report_engine(STUDIES, lambda: runs["JSBSim"]() / SIMULATED_TIME)
    report_reports(STUDIES)


def _loops(
    scenario: Scenario, setup: VehicleSetup, folder: Path
) -> tuple[dict[str, Timed], dict[str, Timed]]:
    """Return the loops, and the other parts of a flight."""
    if setup.aircraft is None:
        raise TypeError("the benchmark flies an aircraft; give it one")
    airspeed, altitude = scenario.guidance.airspeed_mps, scenario.source_height
    level = setup.aircraft.start
    bare, autopiloted = Fdm(X8), AutopilotedAircraft(X8, setup.aircraft.model)
    planned = partial(plan_flight, scenario, flight_id="bench", seed=1, setup=setup)
    plan = planned()
    record = fly(plan, release(plan, setup))
    steps = round(SIMULATED_TIME / TIME_STEP)

    def fly_bare() -> float:
        bare.command(dict(level.inputs))
        bare.hold(level.state(), 240)
        return _timed(lambda: bare.step(steps))

    def fly_autopiloted() -> float:
        autopiloted.release(level.state(), airspeed=airspeed, altitude=altitude)
        return _timed(lambda: autopiloted.fdm.step(steps))

    def fly_guided() -> float:
        vehicle = release(plan, setup)
        return _timed(lambda: fly(plan, vehicle))

    loops: dict[str, Timed] = {
        "JSBSim": fly_bare,
        "JSBSim with autopilot": fly_autopiloted,
        "full closed loop": fly_guided,
    }
    parts: dict[str, Timed] = {
        "planning": lambda: _timed(planned),
        "aircraft and release": lambda: _timed(lambda: release(plan, setup)),
        "figures": lambda: _timed(lambda: flight_figures(plan, record)),
        "time history": lambda: _timed(
            lambda: flight_history(plan, record).to_parquet(folder / "bench.parquet")
        ),
    }
    return loops, parts


def _timed(run: Callable[[], object]) -> float:
    """Return the CPU time [s]: other programs on the machine do not count."""
    began = time.process_time()
    run()
    return time.process_time() - began


def _report(times: dict[str, list[float]]) -> None:
    raw, autopiloted = times["JSBSim"], times["JSBSim with autopilot"]
    print(f"{SIMULATED_TIME:g} s of simulated time, medians of {ROUNDS} interleaved rounds")
    print(f"{'':24}{'us/step':>9}{'sim s/s':>11}{'x JSBSim':>10}{'x autopilot':>13}")
    for name, values in times.items():
        median = statistics.median(values)
        over_raw = statistics.median(a / b for a, b in zip(values, raw, strict=True))
        over_autopilot = statistics.median(a / b for a, b in zip(values, autopiloted, strict=True))
        step = 1e6 * median * TIME_STEP / SIMULATED_TIME
        print(
            f"{name:24}{step:9.2f}{SIMULATED_TIME / median:11.0f}{over_raw:10.2f}{over_autopilot:13.2f}"
        )
    scaled = REFERENCE_STEP * over_raw * SIMULATED_TIME / TIME_STEP
    print(
        f"a flight of {SIMULATED_TIME:g} s: {median:.3f} s, {over_raw:.2f} times JSBSim alone"
        f" (limit {LOOP_MAX:g});"
        f" {scaled:.3f} s where a step of JSBSim takes {1e6 * REFERENCE_STEP:g} us (limit"
        f" {FLIGHT_MAX:g} s)"
    )


if __name__ == "__main__":
    main()
