"""Docstrings of the house as text: in ``north : position [m]`` what follows the colon is a
description, not a type.
"""

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

_UNDERLINE = re.compile(r"-{3,}")
_ENTRY = re.compile(r"(?P<names>[*\w.]+(?:, [*\w.]+)*) : (?P<about>.+)")
_LITERAL = re.compile(r"(``.+?``)")
_MARKUP = re.compile(r"[*|`\\]|(?<=\w)_(?!\w)")
_INDENT = "   "


def as_text(lines: Sequence[str]) -> list[str]:
    """Return a docstring as reStructuredText.

    Sections (a name over a line of dashes) become fields, each entry a term with its description.
    Characters that reStructuredText would take for markup are escaped, but not in literals and in
    the indented code after a line that ends with ``::``.

    Parameters
    ----------
    lines : of the docstring, without indentation
    """
    done: list[str] = []
    i = 0
    while i < len(lines):
        if i + 1 < len(lines) and lines[i].strip() and _UNDERLINE.fullmatch(lines[i + 1].strip()):
            end = _end_of_section(lines, i + 2)
            done += ["", f":{lines[i].strip()}:", *_entries(lines[i + 2 : end]), ""]
            i = end
        elif lines[i].endswith("::"):
            end = _end_of_code(lines, i + 1)
            done += [_escaped(lines[i]), *lines[i + 1 : end]]
            i = end
        else:
            done.append(_escaped(lines[i]))
            i += 1
    return done


def _end_of_section(lines: Sequence[str], start: int) -> int:
    """Return the index after a section: it ends at an empty line."""
    end = start
    while end < len(lines) and lines[end].strip():
        end += 1
    return end


def _end_of_code(lines: Sequence[str], start: int) -> int:
    """Return the index after a block of code: it ends at a line that is not indented."""
    end = start
    while end < len(lines) and (not lines[end].strip() or lines[end].startswith(" ")):
        end += 1
    return end


def _entries(lines: Sequence[str]) -> Iterator[str]:
    for line in lines:
        entry = _ENTRY.fullmatch(line)
        if entry:
            names = ", ".join(f"``{name}``" for name in entry["names"].split(", "))
            yield from ("", f"{_INDENT}{names}", f"{_INDENT * 2}{_escaped(entry['about'])}")
        else:
            # The rest of a description, or a section without entries.
            indent = _INDENT * 2 if line.startswith(" ") else _INDENT
            yield f"{indent}{_escaped(line.strip())}"


def _escaped(line: str) -> str:
    """Return a line with the characters escaped that would be markup; the bullet of a list is
    meant.
    """
    bullet = re.match(r"\s*\* ", line)
    start = bullet.end() if bullet else 0
    parts = _LITERAL.split(line[start:])
    return line[:start] + "".join(
        part if i % 2 else _MARKUP.sub(r"\\\g<0>", part) for i, part in enumerate(parts)
    )


def _process(
    _app: "Sphinx", _what: str, _name: str, _obj: object, _options: object, lines: list[str]
) -> None:
    lines[:] = as_text(lines)


def setup(app: "Sphinx") -> dict[str, bool]:
    """Let Sphinx convert every docstring in this way."""
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True}
