"""The docstrings of the house come out as text in the documentation: a description is not a type."""

import inspect
import re
from pathlib import Path

from docstrings import as_text

ROOMS = ("aircraft", "common", "gnc", "innerloop", "measurement", "reports", "scenarios")


def test_every_docstring_of_the_project_names_its_parameters_so():
    """A line of these sections is an entry, ``name : description``, or goes on with one: else it
    would be lost among the text.
    """
    root = Path(__file__).parents[2]
    strange = []
    for path in sorted(path for room in ROOMS for path in (root / room).rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        # As they are written: to parse the files takes a second.
        for docstring in re.findall(r'"""(.*?)"""', source, re.DOTALL):
            text = inspect.cleandoc(docstring)
            for section in re.findall(
                r"^(?:Parameters|Attributes|Raises)\n-+\n(.*?)(?:\n\n|\Z)",
                text,
                re.MULTILINE | re.DOTALL,
            ):
                lines = as_text(["Parameters", "----------", *section.splitlines()])
                strange += [
                    f"{path.relative_to(root)}: {line}"
                    for line in lines[2:]
                    if re.match(r" {3}(?!``| )\S", line)
                ]
    assert strange == []
