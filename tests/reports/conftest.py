"""A run that several packages of tests share, and reports without their slow parts."""

import pytest

from reports.document.blocks import Section
from reports.document.chart import Chart, Panel


@pytest.fixture(scope="session")
def small_run(tmp_path_factory):
    """The directory of a small kinematic run of two trials, to be read and not changed."""
    # Tests of exports run where less is imported.
    from trial_runs import small_trials

    return small_trials(tmp_path_factory.mktemp("small"))


@pytest.fixture
def without_single_flights(monkeypatch):
    """Have reports made without single flights, and with nothing in page 1's picture: both take
    most of the time.
    """
    monkeypatch.setattr(
        "reports.flights.content.flight_section",
        lambda _, **__: Section(anchor="flights", title="", blocks=[]),
    )
    monkeypatch.setattr(
        "reports.flights.content.telling_and_typical",
        lambda _: Chart(
            name="picture", caption="", panels=[Panel(x_label="", y_label="", lines=[])]
        ),
    )
