"""``make bench``: what the autopilot and the guidance cost on top of JSBSim.

Three loops over the same simulated time, in one process, in turn, again and again: JSBSim with the bare aircraft, JSBSim with
the autopilot, and the full closed loop with guidance and record. The figures are medians over the rounds; ratios are taken within
a round, where the machine's speed is the same. Of the full closed loop, that is of a flight, the time is shown beside its limit,
and beside it what a flight takes besides: planning, the aircraft and its release, figures and time history.
"""

import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import TIME_STEP, Fdm
from benchmarks.engine import report_engine
from benchmarks.sea_guidance import report_sea_guidance
from innerloop.designs.designer import design_autopilot
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.step_responses import level_trim, measure_lag
from innerloop.flight.turn_reversal import measure_turn_reversal
from innerloop.jsbsim.root import write_root
from scenarios.flights import guidance_lag, place_vehicle
from scenarios.metrics.figures import flight_figures
from scenarios.metrics.relative_state import flight_history
from scenarios.planning.planner import plan_flight
from scenarios.schema.load import load_scenario, with_values
from scenarios.simulation.closed_loop import fly
from scenarios.vehicles.six_dof import SixDof

ROUNDS, STUDIES = 15, 3
FLOWN = 400.0
"""Simulated time of each run [s]."""

FLIGHT_MAX, LOOP_MAX = 0.35, 1.3
"""Limits of a flight's time on one core, where a step of JSBSim alone takes 3.3 us [s], and of it over that with autopilot [-]."""

Timed = Callable[[], float]
"""Runs something and returns how long it took [s]."""


def main() -> None:
    """Print the benchmark."""
    with tempfile.TemporaryDirectory() as folder:
        runs, parts = _loops(Path(folder))
        for run in runs.values():
            run()
        times: dict[str, list[float]] = {name: [] for name in runs}
        for _ in range(ROUNDS):
            for name, run in runs.items():
                times[name].append(run())
        besides = {name: statistics.median(part() for _ in range(ROUNDS)) for name, part in parts.items()}
    _report(times)
    named = ", ".join(f"{name} {1e3 * seconds:.1f}" for name, seconds in besides.items())
    print(f"beside its closed loop a flight takes {1e3 * sum(besides.values()):.1f} ms: {named}")
    report_sea_guidance(ROUNDS)
    report_engine(STUDIES)


def _loops(folder: Path) -> tuple[dict[str, Timed], dict[str, Timed]]:
    """Return the loops, and the other parts of a flight."""
    scenario = load_scenario("sweep_nu", ["start.course_deg=0.0"])
    airspeed, altitude = scenario.guidance.airspeed_mps, scenario.plume.source_height_m
    schedule = design_autopilot(X8, altitude).schedule
    root = write_root(schedule, folder)
    level = level_trim(X8, airspeed, altitude)
    bare, autopiloted = Fdm(X8), AutopilotedAircraft(X8, root)
    bank = schedule.envelope.bank
    six_dof = SixDof(
        spec=X8,
        start=level,
        lag=measure_lag(autopiloted, level, bank),
        reversal=measure_turn_reversal(autopiloted, level, bank),
        envelope=schedule.envelope,
    )
    # No flight ends before its time: no number of crossings is enough.
    endless = with_values(scenario, {"flight.duration_max_s": FLOWN, "flight.crossings": 10_000})
    lag = guidance_lag(endless, six_dof)
    planned = partial(plan_flight, endless, flight_id="bench", nu=0.5, seed=1, lag=lag, reversal=six_dof.reversal)
    plan = planned()
    record = fly(plan, place_vehicle(endless, plan, root, six_dof))
    steps = round(FLOWN / TIME_STEP)

    def fly_bare() -> float:
        bare.command(dict(level.inputs))
        bare.hold(level.state(), 240)
        return _timed(lambda: bare.step(steps))

    def fly_autopiloted() -> float:
        autopiloted.release(level.state(), airspeed=airspeed, altitude=altitude)
        return _timed(lambda: autopiloted.fdm.step(steps))

    def fly_guided() -> float:
        vehicle = place_vehicle(endless, plan, root, six_dof)
        return _timed(lambda: fly(plan, vehicle))

    loops: dict[str, Timed] = {"JSBSim": fly_bare, "JSBSim with autopilot": fly_autopiloted, "full closed loop": fly_guided}
    parts: dict[str, Timed] = {
        "planning": lambda: _timed(planned),
        "aircraft and release": lambda: _timed(lambda: place_vehicle(endless, plan, root, six_dof)),
        "figures": lambda: _timed(lambda: flight_figures(plan, record)),
        "time history": lambda: _timed(lambda: flight_history(plan, record).to_parquet(folder / "bench.parquet")),
    }
    return loops, parts


def _timed(run: Callable[[], object]) -> float:
    """Return the time on one core [s], so without that in which the machine did something else."""
    began = time.process_time()
    run()
    return time.process_time() - began


def _report(times: dict[str, list[float]]) -> None:
    raw, autopiloted = times["JSBSim"], times["JSBSim with autopilot"]
    print(f"{FLOWN:g} s of flight, {ROUNDS} interleaved rounds, medians")
    print(f"{'':24}{'us/step':>9}{'s flown/s':>11}{'x JSBSim':>10}{'x autopilot':>13}")
    for name, values in times.items():
        median = statistics.median(values)
        over_raw = statistics.median(a / b for a, b in zip(values, raw, strict=True))
        over_autopilot = statistics.median(a / b for a, b in zip(values, autopiloted, strict=True))
        step = 1e6 * median * TIME_STEP / FLOWN
        print(f"{name:24}{step:9.2f}{FLOWN / median:11.0f}{over_raw:10.2f}{over_autopilot:13.2f}")
    print(f"a flight of {FLOWN:g} s: {median:.3f} s of at most {FLIGHT_MAX:g}, x{over_autopilot:.2f} of at most x{LOOP_MAX:g}")


if __name__ == "__main__":
    main()
