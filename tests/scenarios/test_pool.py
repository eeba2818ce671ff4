import os
import signal
import time

import pytest

from scenarios.pool import fly_all


def double(request):
    return 2 * request


def die_at_three(request):
    if request == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.05)
    return request


def fly(requests, how, *, jobs=2, done=None):
    results = []
    fly_all(requests, how, died=lambda request: ("died", request), done=done or results.append, jobs=jobs)
    return results


@pytest.mark.parametrize("jobs", [1, 2, 8])
def test_every_request_is_flown_once_whatever_the_number_of_processes(jobs):
    assert sorted(fly([1, 2, 3, 4, 5], double, jobs=jobs)) == [2, 4, 6, 8, 10]


def test_nothing_to_fly_is_nothing_flown():
    assert fly([], double) == []


def test_a_process_that_dies_leaves_a_result_for_every_request():
    results = fly([1, 2, 3, 4, 5, 6], die_at_three, jobs=1)
    assert ("died", 3) in results
    assert sorted(entry[1] if isinstance(entry, tuple) else entry for entry in results) == [1, 2, 3, 4, 5, 6]


class Slow(list):
    """Requests that are handed in so slowly that a process is dead by the last."""

    def __iter__(self):
        for request in super().__iter__():
            yield request
            time.sleep(0.3 if request == 3 else 0.0)


def test_a_process_that_dies_while_requests_are_handed_in_leaves_a_result_for_every_one():
    results = fly(Slow([3, 4, 5]), die_at_three, jobs=1)
    assert sorted(results) == [("died", 3), ("died", 4), ("died", 5)]


def test_an_interrupt_hands_over_what_is_done_and_goes_on_up():
    results = []

    def done(result):
        results.append(result)
        if len(results) == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly(list(range(50)), double, jobs=1, done=done)
    # None twice, and the one at which the interrupt came is among them.
    assert len(results) == len(set(results)) >= 1
