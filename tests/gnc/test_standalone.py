"""gnc stands alone: it needs only numpy, scipy and common, and its tests pytest and hypothesis."""

import pytest

from tests.standing_alone import StandingAlone

pytestmark = pytest.mark.slow

GNC = StandingAlone("gnc", allowed={"common", "numpy", "scipy"})


@pytest.mark.parametrize("name", ["jsbsim", "control", "aircraft.fdm", "scenarios"])
def test_the_bar_keeps_out_what_gnc_must_not_know(name):
    outcome = GNC.run(f"import {name}")
    assert outcome.returncode == 1
    assert f"{name.partition('.')[0]} is barred" in outcome.stderr


def test_every_module_imports_and_every_test_is_collected_with_numpy_scipy_and_common_alone():
    assert {"gnc.laws", "gnc.paper", "gnc.tracker", "gnc.reference.reference"} <= set(GNC.modules)
    imports = "".join(f"import {module}\n" for module in GNC.modules)
    # What tests/conftest.py imports counts, too.
    options = ["--collect-only", "--assert=plain", "-p", "no:cacheprovider", "tests/gnc"]
    outcome = GNC.run(f"{imports}import pytest; sys.exit(pytest.main({options}))")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "test_cascade.py::test_under_law_30_the_system_21_is_the_cascade_31" in outcome.stdout
