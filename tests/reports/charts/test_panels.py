"""Markers that a panel has no room for, and what inputs of a list are called."""

import numpy as np
import pytest

from reports.document.panels import histogram
from reports.document.tables import in_symbols
from reports.monte_carlo.names import input_label


@pytest.mark.parametrize(
    ("key", "label"),
    [
        ("vessel.manoeuvres.0.at_s", "Vessel manoeuvre 1 time [s]"),
        ("vessel.manoeuvres.1.turn_deg", "Vessel manoeuvre 2 turn [deg]"),
        ("wind.speed_mps", "Wind speed [m/s]"),
        ("sensors.heat", "Sensors heat [-]"),
    ],
)
def test_an_entry_of_a_list_counts_from_one(key, label):
    assert input_label(key) == label


def test_symbols_of_messages_and_documents_are_those_of_figures():
    assert (
        in_symbols("off pi/omega_0, at nu = 1.11, above omega_max = 0.50")
        == "off π/ω₀, at ν = 1.11, above ω_max = 0.50"
    )
    # Keys of a file stay what they are.
    assert in_symbols("omega_0_rad_s, sweep.nu=[0.3]") == "omega_0_rad_s, sweep.nu=[0.3]"


def test_two_figures_of_three_flights_are_not_enough_for_a_histogram():
    three = np.array([1.0, 2.0, 3.0])
    assert histogram([(three, "largest", "black"), (three, "rms", "blue")], "Error [m]") is None
    assert (
        histogram([(np.arange(5.0), "largest", "black"), (three, "rms", "blue")], "Error [m]")
        is not None
    )
