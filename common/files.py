"""Write files atomically, recognise them by name, and hash them."""

import filecmp
import hashlib
import json
import os
import shutil
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from common.run_layout import EXPORT, REPORT_HTML, REPORT_PDF

DATA_SUFFIXES = (".csv", ".nmea", ".txt", ".nc")
"""Suffixes of data files in a scenario: tables, AIS sentences, netCDF."""


def is_data_file(name: str) -> bool:
    """Return whether a name has the suffix of a data file."""
    return name.lower().endswith(DATA_SUFFIXES)


def is_path(name: str) -> bool:
    """Return whether a name contains a folder, such as ``DIR/NAME``."""
    return any(separator and separator in name for separator in ("/", os.sep, os.altsep))


def is_file(path: Path) -> bool:
    """Return whether a file exists; False for names that are impossible for a file."""
    try:
        return path.is_file()
    except OSError:
        return False


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file completely or not at all.

    ``write`` gets the path of a temporary file, which then replaces the file. A file that already
    has the content is left untouched.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(part)
        if not (is_file(path) and filecmp.cmp(part, path, shallow=False)):
            part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_json(path: Path, value: Mapping[str, Any], *, indent: int | None = 1) -> None:
    """Write a JSON file, completely or not at all; an ``indent`` of None gives one line.

    Raises
    ------
    ValueError : a number is not finite
    """
    write_text(path, json_text(value, indent=indent))


def json_text(value: Mapping[str, Any], *, indent: int | None) -> str:
    """Return the text that ``write_json`` writes."""
    return json.dumps(value, indent=indent, allow_nan=False, default=plain_number) + "\n"


def plain_number(value: object) -> object:
    """Convert a NumPy scalar, which a user's part may return, to a Python number for JSON."""
    if callable(item := getattr(value, "item", None)):
        return item()
    raise TypeError(f"JSON cannot express {type(value).__name__}")


def write_text(path: Path, text: str) -> None:
    """Write a text file, completely or not at all."""
    write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def write_tree(source: Path, target: Path) -> None:
    """Copy all files below a folder; files that already have the content are left untouched."""
    for path in sorted(path for path in source.rglob("*") if path.is_file()):
        copy = target / path.relative_to(source)
        copy.parent.mkdir(parents=True, exist_ok=True)
        write_whole(copy, partial(shutil.copyfile, path))


def files_hash(root: Path, paths: Iterable[Path]) -> str:
    """Return the SHA-256 of relative paths and contents of files below a folder, in order."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def remove_reports(directory: Path) -> None:
    """Remove reports and exports before a run continues or a design is repeated."""
    for name in (REPORT_HTML, REPORT_PDF):
        (directory / name).unlink(missing_ok=True)
    shutil.rmtree(directory / EXPORT, ignore_errors=True)
