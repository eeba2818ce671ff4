"""measurement stands alone: it imports, and its tests are collected, without the other rooms."""

import pytest

from tests.standing_alone import StandingAlone

pytestmark = pytest.mark.slow

MEASUREMENT = StandingAlone(
    "measurement",
    allowed={"common", "numpy", "pandas", "rich", "scipy", "typer"},
    barred={"hypothesis"},
)


@pytest.mark.parametrize("name", ["gnc", "hypothesis", "jsbsim", "pydantic"])
def test_the_bar_keeps_out_what_measurement_must_not_know(name):
    outcome = MEASUREMENT.run(f"import {name}")
    assert outcome.returncode == 1
    assert f"{name} is barred" in outcome.stderr


def test_every_module_imports_and_the_tests_are_collected():
    assert {
        "measurement.gases",
        "measurement.emission",
        "measurement.plume.fluctuating_plume",
    } <= set(MEASUREMENT.modules)
    imports = "".join(f"import {module}\n" for module in MEASUREMENT.modules)
    # What tests/conftest.py imports counts, too.
    options = [
        "--collect-only",
        "--assert=plain",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:hypothesispytest",
        "tests/measurement",
    ]
    outcome = MEASUREMENT.run(f"{imports}import pytest; sys.exit(pytest.main({options}))")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "test_flux.py::test_what_passes_a_plane_is_what_was_emitted" in outcome.stdout
