"""Reports on flights of which a part is asked for."""

import pytest

from reports.document.blocks import Section
from reports.document.chart import Chart, Panel


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
