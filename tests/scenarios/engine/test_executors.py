import pytest
from engine_cases import Squares

from scenarios.engine import runner
from scenarios.engine.processes import LocalExecutor
from scenarios.engine.runner import DASK, LOCAL, ExecutorFactory
from scenarios.errors import InputError


def test_processes_of_this_machine_are_hired_where_nothing_else_is_said(tmp_path):
    assert isinstance(ExecutorFactory()(Squares(marks=tmp_path)), LocalExecutor)
    assert ExecutorFactory().executor == LOCAL
    assert ExecutorFactory().jobs == 1


def test_a_scheduler_that_would_not_be_asked_is_refused():
    with pytest.raises(
        InputError,
        match=r"--scheduler is tcp://10\.0\.0\.1:8786 with --executor local; add --executor dask",
    ):
        ExecutorFactory(scheduler="tcp://10.0.0.1:8786")


@pytest.mark.parametrize("scheduler", [None, "tcp://10.0.0.1:8786"])
def test_dask_where_it_is_not_installed_is_refused_with_what_to_install(monkeypatch, scheduler):
    monkeypatch.setattr(runner, "find_spec", lambda _: None)
    with pytest.raises(
        InputError,
        match=r"--executor is dask, which .* pip install -c constraints.txt -e '\.\[dask\]'",
    ) as refused:
        ExecutorFactory(executor=DASK, scheduler=scheduler)
    assert "\n" not in str(refused.value)
