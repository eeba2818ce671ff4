"""An installed package made for a test: files on the path, and entry points as pip writes them."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

GROUP = "plume_flight_study"


class AddedPackage:
    """A package in a folder of its own, known to every process that it starts.

    Parameters
    ----------
    folder : that holds it
    files : their texts, by paths below the folder
    points : entry points ``name = module:object`` by the kind of part
    """

    def __init__(
        self, folder: Path, files: Mapping[str, str], points: Mapping[str, Mapping[str, str]]
    ) -> None:
        self.folder = folder
        for name, text in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        metadata = folder / "added_package-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(
            "Metadata-Version: 2.1\nName: added-package\nVersion: 1.0\n", encoding="utf-8"
        )
        lines = []
        for kind, named in points.items():
            lines.append(f"[{GROUP}.{kind}]")
            lines += [f"{name} = {value}" for name, value in named.items()]
        (metadata / "entry_points.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def python(
        self, *arguments: str, cwd: Path | None = None
    ) -> "subprocess.CompletedProcess[str]":
        """Run Python where the package is installed."""
        path = os.pathsep.join(filter(None, (str(self.folder), os.environ.get("PYTHONPATH"))))
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=cwd or self.folder,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    def command(
        self, *arguments: str, cwd: Path | None = None
    ) -> "subprocess.CompletedProcess[str]":
        """Run ``plume-flight`` where the package is installed."""
        return self.python("-c", "from scenarios.cli.main import main; main()", *arguments, cwd=cwd)
