"""Names and signatures that scripts rely on.

Where one of these tests fails, scripts of users break: change docs/reference/api.md with it.
"""

import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import scenarios

SIGNATURES = {
    "fly": "(scenario, /, *, flight_id=None, out=None, progress=False, **keys)",
    "run": "(scenario, /, *, out=None, jobs=None, progress=False, **keys)",
    "load": "(scenario, /, *, name=None, **keys)",
    "read_ais": "(path, mmsi=None, **table)",
    "Scenario": "(*, name, source, changes=(), parts=())",
    "Scenario.set": "(self, **keys)",
    "Run": "(directory, *, lines)",
    "Run.report": "(self, path=None, *, all_flights=False)",
    "Flight": "(run, flight_id)",
    "Flight.plot": "(self)",
    "Flight.export": "(self, path)",
    "Statistics.quantile": "(self, figure, probability)",
}

ATTRIBUTES = {
    "Scenario": {"changes", "config", "name", "parts", "set", "source", "title"},
    "Run": {"columns", "comparison", "crossings", "draws", "flights", "manifest", "met", "report", "statistics", "summary", "verdict"},
    "Flight": {"crossings", "export", "history", "kept_out", "met", "plot", "reasons", "row"},
    "Statistics": {
        "confidence", "content", "flights", "measured", "outcomes", "quantile", "quantiles", "violation", "violation_at_most",
    },
    "InputError": {"add_note", "args", "with_traceback"},
}  # fmt: skip
"""Public attributes of each class, those set when it is made apart."""


def test_the_public_names_are_these():
    assert scenarios.__all__ == [
        "Flight",
        "InputError",
        "Run",
        "Scenario",
        "Statistics",
        "fly",
        "load",
        "read_ais",
        "run",
    ]
    assert set(scenarios.__all__) <= set(dir(scenarios))


@pytest.mark.parametrize("name", SIGNATURES)
def test_signatures_are_these(name):
    first, _, rest = name.partition(".")
    found = getattr(scenarios, first)
    found = getattr(found, rest) if rest else found
    bare = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in inspect.signature(found).parameters.values()
    ]
    assert str(inspect.Signature(bare)) == SIGNATURES[name]


@pytest.mark.parametrize("name", ATTRIBUTES)
def test_attributes_are_these(name):
    assert {
        attribute for attribute in dir(getattr(scenarios, name)) if not attribute.startswith("_")
    } == ATTRIBUTES[name]


@pytest.mark.parametrize("name", scenarios.__all__)
def test_every_public_name_is_documented(name):
    found = getattr(scenarios, name)
    assert inspect.getdoc(found)
    for attribute in ATTRIBUTES.get(name, ()):
        member = inspect.getattr_static(found, attribute)
        function = getattr(member, "fget", None) or getattr(member, "func", member)
        if inspect.isfunction(function):
            assert inspect.getdoc(function), attribute


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'flie'"):
        scenarios.flie  # noqa: B018 - what is tested is that this is refused


def python(code):
    found = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.returncode, found.stderr) == (0, ""), found.stderr


def test_importing_the_package_imports_nothing_of_others_and_its_names_no_simulator_and_no_figures():
    python(
        "import sys, scenarios\n"
        "heavy = {'numpy', 'scipy', 'pandas', 'control', 'jsbsim', 'matplotlib', 'pydantic', 'typer'}\n"
        "if found := sorted(heavy & set(sys.modules)): sys.exit('the package: ' + ', '.join(found))\n"
        "from scenarios import fly, load, run, Scenario\n"
        "heavy = {'pandas', 'control', 'jsbsim', 'matplotlib', 'typst'}\n"
        "if found := sorted(heavy & set(sys.modules)): sys.exit('the names: ' + ', '.join(found))"
    )


def test_run_stays_the_function_when_the_command_line_is_imported():
    python(
        "import scenarios.run; from scenarios import run; assert callable(run), run; from scenarios.run import main; assert main"
    )
