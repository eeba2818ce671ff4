"""The run of a flight at a place on earth, which the tests of exports share."""

from tests.reports.export.conftest import run_path, truth

__all__ = ["run_path", "truth"]
