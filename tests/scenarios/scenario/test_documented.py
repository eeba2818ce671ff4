"""What is said of keys is complete, and agrees with what the schemas accept."""

from pydantic import RootModel

from extensions.convergence.scenario import ConvergenceScenario
from scenarios.scenario.documentation import FLIGHT_STUDIES, documented_keys, documented_sections
from scenarios.scenario.errors import known_keys
from scenarios.scenario.files import KINDS
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList

KEYS = documented_keys()
BY_KEY = {key.key: key for key in reversed(KEYS)}


def test_every_key_of_the_schemas_is_documented():
    for kind in (Scenario, TrialList, ConvergenceScenario):
        sections = list(documented_sections(kind))
        named = {key.key for section in sections for key in section.keys} | {
            section.name.removesuffix(".0") for section in sections
        }
        named |= {section.name for section in sections}
        for key in set(known_keys(kind)) - named:
            assert issubclass(kind.model_fields[key].annotation, RootModel), key


def test_every_number_has_a_unit_and_nothing_else_has():
    for key in KEYS:
        assert bool(key.unit) == ("number" in key.range), key


UNITS = {
    "_m": "m", "_s": "s", "_mps": "m/s", "_deg": "deg", "_rad_s": "rad/s", "_hz": "Hz",
    "_per_s": "1/s",
}  # fmt: skip


def test_units_are_those_of_the_names():
    longer = ("_per_m", "_per_s", "_deg_s", "_rad_s", "_per_m_s", "_m_s")
    for suffix, unit in UNITS.items():
        named = [key for key in KEYS if key.key.endswith(suffix)]
        found = [key for key in named if suffix in longer or not key.key.endswith(longer)]
        assert {key.unit for key in found} == {unit}


def test_ranges_and_defaults_are_those_of_the_schema():
    assert BY_KEY["wind.speed_mps"].range == "a number from 0 to 40"
    assert BY_KEY["criteria.tracking_error_rms_m"].range == "a number above 0 or false"
    assert BY_KEY["start.distance_m"].range == "2 values, each a number above 0"
    assert BY_KEY["flights"].range == "a whole number from 1 to 1,000,000"
    values = Scenario(title="own").model_dump(mode="json")
    for key in KEYS:
        section, _, name = key.key.rpartition(".")
        if (
            key.studies
            and set(key.studies) <= set(FLIGHT_STUDIES)
            and name in values.get(section, ())
        ):
            assert key.default == values[section][name], key


def test_studies_are_those_in_which_a_key_can_act():
    assert {study for key in KEYS for study in key.studies} == set(KINDS)
    assert BY_KEY["search.population"].studies == ("falsify",)
    assert BY_KEY["subset.repeats"].studies == ("monte_carlo",)
    assert BY_KEY["wind.speed_mps"].studies == FLIGHT_STUDIES
    assert "falsify" not in BY_KEY["flights"].studies
    # A study of one point refuses several.
    assert BY_KEY["sweep"].studies == ("flights", "monte_carlo", "premises")
    assert BY_KEY["share"].studies == ("trials",)
