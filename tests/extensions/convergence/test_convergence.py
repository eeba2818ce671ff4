import multiprocessing
import signal
import time

import pytest

from extensions.convergence.motion import Vehicle
from extensions.convergence.references import REFERENCES
from extensions.convergence.study import (
    COLUMNS,
    ConvergenceWork,
    convergence_blocks,
    convergence_table,
    counterexamples,
)
from gnc.paper import look_ahead
from scenarios.engine.processes import InProcessExecutor, LocalExecutor
from scenarios.engine.task import Limits, Task

pytestmark = pytest.mark.slow

# The paper's vehicle (reference/paper-notes.md) and the guidance of the catalogue's scenarios.
SPEED, HEADING_RATE_MAX, BAND = 19.42, 0.503, 5.0
LOOK_AHEAD = look_ahead(0.005, 60.0)
VEHICLE = Vehicle(
    speed=SPEED,
    look_ahead=LOOK_AHEAD,
    gain=1.5,
    steering_max=0.4,
    k_1=0.001,
    heading_rate_max=HEADING_RATE_MAX,
)
STUDY = {
    "trajectories": 30,
    "seed": 3,
    "distance_max": 500.0,
    "vehicle": VEHICLE,
    "settling_band": BAND,
    "time_max": 20_000.0,
    "laws": ("lyapunov", "cascade"),
}


def in_two_processes(work):
    return LocalExecutor(work, jobs=2, limits=Limits())


def results(factory=InProcessExecutor, **changes):
    """Yield the result of each block as it comes."""
    blocks = convergence_blocks(**(STUDY | changes))
    with factory(ConvergenceWork(blocks=tuple(blocks))) as executor:
        yield from executor.fly(Task(number=i) for i in range(len(blocks)))


def study(factory=InProcessExecutor, **changes):
    rows = [row for result in results(factory, **changes) for row in result.tables["summary.csv"]]
    return convergence_table(rows, (STUDY | changes)["laws"])


SMALL = 36


@pytest.fixture(scope="module")
def small():
    return study(trajectories=SMALL)


def test_every_trajectory_of_a_small_study_converges(small):
    # Section IV: asymptotically stable from anywhere under (24) and (30), as long as the reference
    # turns.
    assert len(small) == 2 * SMALL
    assert set(small["outcome"]) == {"converged"}
    assert counterexamples(small).empty
    assert (small["distance_final_m"] < 0.02).all()
    assert small["settling_time_s"].notna().all()


def test_rows_are_in_order_and_have_the_columns_of_the_table(small):
    assert tuple(small.columns) == tuple(COLUMNS)
    assert small["trajectory"].tolist() == [i for i in range(SMALL) for _ in range(2)]
    assert small["law"].tolist() == ["lyapunov", "cascade"] * SMALL
    assert small["reference"].tolist() == [
        kind for _ in range(SMALL // 3) for kind in REFERENCES for _ in range(2)
    ]
    # Both laws start from the same states.
    starts = small[
        [
            "start_north_m",
            "start_east_m",
            "start_course_rad",
            "reference_course_rad",
            "reference_terms",
        ]
    ]
    assert starts[::2].reset_index(drop=True).equals(starts[1::2].reset_index(drop=True))
    # The laws keep phi in different variables: rounding.
    assert small["start_phi_rad"][::2].to_numpy() == pytest.approx(
        small["start_phi_rad"][1::2].to_numpy(), abs=1e-14
    )


def test_the_same_seed_gives_the_same_rows_bit_for_bit_in_this_process_and_in_two_others():
    # From close by, for time's sake; the cut law flies where it takes no longer.
    few = {
        "trajectories": 3,
        "distance_max": 20.0,
        "laws": ("lyapunov", "cascade", "cascade_cut"),
        "seed": 11,
    }
    one = study(**few)
    assert one.equals(study(in_two_processes, **few))
    # And a law flies the same without the others.
    alone = study(**(few | {"laws": ("cascade",)}))
    assert alone.equals(one[one["law"] == "cascade"].reset_index(drop=True))
    assert not alone.equals(study(**(few | {"laws": ("cascade",), "seed": 1})))


def test_an_interrupted_study_ends_its_processes_at_once():
    before = set(multiprocessing.active_children())

    def interrupt(*_):
        # What Ctrl-C raises; the processes themselves are not told, as with kill -INT of the parent
        # alone. Not before both of them run: Python ignores what is raised while it starts one.
        if len(set(multiprocessing.active_children()) - before) == 2:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            raise KeyboardInterrupt

    # Half a minute of work, interrupted half a second after its processes are there at the latest.
    flying = results(
        trajectories=60,
        distance_max=5000.0,
        laws=("lyapunov", "cascade", "cascade_cut"),
        factory=in_two_processes,
    )
    earlier = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.5, 0.5)
    began = time.perf_counter()
    try:
        with pytest.raises(KeyboardInterrupt):
            list(flying)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, earlier)
    assert time.perf_counter() - began < 5.0
    assert set(multiprocessing.active_children()) <= before


def test_a_trajectory_that_has_too_little_time_is_a_counterexample(monkeypatch):
    monkeypatch.setattr("extensions.convergence.study.TIME_FACTOR", 0.1)
    rows = study(time_max=1.0, laws=("cascade",))
    missed = counterexamples(rows)
    assert len(missed) > 0
    assert set(missed["outcome"]) == {"time_up"}
    assert missed["message"].str.contains("raise time_max").all()
    assert len(missed) + (rows["outcome"] == "converged").sum() == 30
