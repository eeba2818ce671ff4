"""A room behind a bar that keeps out what it must not import."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]

_BAR = """
import sys

class Bar:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {barred!r}:
            raise ModuleNotFoundError(f"{{name}} is barred", name=name)

sys.meta_path.insert(0, Bar())
"""


class StandingAlone:
    """A room that may import no other room and no dependency but those named.

    Attributes
    ----------
    modules : of the room, by name
    """

    def __init__(self, room: str, *, allowed: set[str], barred: set[str] = frozenset()) -> None:
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        # "control>=0.10.2" and the like; each is imported by the name it is installed by.
        installed = {
            requirement.partition(">=")[0] for requirement in project["project"]["dependencies"]
        }
        rooms = {
            name.rstrip("*")
            for name in project["tool"]["setuptools"]["packages"]["find"]["include"]
        }
        self._bar = _BAR.format(barred=sorted((installed | rooms | barred) - allowed - {room}))
        files = (path.relative_to(ROOT).with_suffix("") for path in (ROOT / room).rglob("*.py"))
        self.modules = sorted(".".join(file.parts).removesuffix(".__init__") for file in files)

    def run(self, script: str) -> "subprocess.CompletedProcess[str]":
        """Run a script behind the bar, in the root of the checkout; a new interpreter has imported
        nothing yet.
        """
        # Plugins that are installed have no part in collecting, and import much.
        return subprocess.run(
            [sys.executable, "-c", self._bar + script],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
            env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        )
