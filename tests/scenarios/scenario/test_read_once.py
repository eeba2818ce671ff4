"""A setting is read and checked once, however many points an experiment has."""

from collections import Counter

import pytest

from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study
from scenarios.scenario.sections import section


@pytest.fixture
def read(monkeypatch):
    """Count how often each section is read from what is written, by the name of its class."""
    counted, real = Counter(), section.reject_truth_values

    def count(given, made):
        counted[type(made).__name__] += 1
        real(given, made)

    monkeypatch.setattr(section, "reject_truth_values", count)
    return counted


def test_points_read_the_sections_alone_in_which_they_differ(read):
    experiment = Experiment("sweep_nu", load_study("sweep_nu"))
    # 20 speed ratios, and five comparisons at two of them, of guidance alone.
    assert len(experiment.points) == 30
    assert (read["KeepoutConfig"], read["ComparisonConfig"]) == (1, 1)
    assert (read["VesselConfig"], read["GuidanceConfig"]) == (20, 10)


def test_an_override_reads_its_section_alone(read):
    assert load_study("sea_wind", ["wind.speed_mps=5"]).wind.speed_mps == 5.0
    assert (read["WindConfig"], read["StartConfig"], read["CriteriaConfig"]) == (1, 1, 1)


def test_a_scenario_knows_which_keys_are_set_when_another_section_changes():
    changed = load_study("sea_wind", ["keepout.radius_m=190"])
    assert changed.guidance.model_fields_set == load_study("sea_wind").guidance.model_fields_set
