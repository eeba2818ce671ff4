"""Flights in processes of their own."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from reports.interrupt import ignore_interrupt

Request = TypeVar("Request")
Result = TypeVar("Result")

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many flights are done and how many there are."""

DIED = "the process that flew it died; run again with --resume and --jobs 1"
"""Why a flight has no result."""


def fly_all(
    requests: Sequence[Request],
    fly: Callable[[Request], Result],
    *,
    died: Callable[[Request], Result],
    done: Callable[[Result], None],
    jobs: int,
) -> None:
    """Fly requests in parallel.

    Parameters
    ----------
    requests : what to fly
    fly : flies one, in a process of its own: it must be possible to pickle it
    died : makes the result of one whose process died
    done : called with each result, as it comes
    jobs : number of processes

    Raises
    ------
    KeyboardInterrupt : after everything that had been done by then was handed over
    """
    pool = ProcessPoolExecutor(max_workers=min(jobs, max(1, len(requests))), initializer=ignore_interrupt)
    futures: dict[Future[Result], Request] = {}
    handed: set[Future[Result]] = set()

    def hand_over(future: Future[Result]) -> None:
        handed.add(future)
        try:
            result = future.result()
        except BrokenProcessPool:
            result = died(futures[future])
        done(result)

    try:
        for request in requests:
            try:
                futures[pool.submit(fly, request)] = request
            except BrokenProcessPool:
                done(died(request))
        for future in as_completed(futures):
            hand_over(future)
    except KeyboardInterrupt:
        pool.shutdown(wait=True, cancel_futures=True)
        for future in futures:
            if future.done() and not future.cancelled() and future not in handed:
                hand_over(future)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
