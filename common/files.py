"""Files that are written completely or not at all."""

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
"""How the names of files of data end that a scenario may name: tables, AIS sentences, netCDF."""


def is_data_file(name: str) -> bool:
    """Return whether ``name`` is that of a file of data, by how it ends."""
    return name.lower().endswith(DATA_SUFFIXES)


def is_path(name: str) -> bool:
    """Return whether ``name`` leads into a folder, as ``DIR/NAME`` does."""
    return any(separator and separator in name for separator in ("/", os.sep, os.altsep))


def is_file(path: Path) -> bool:
    """Return whether there is a file, which there is not under a name that no file can have."""
    try:
        return path.is_file()
    except OSError:
        return False


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Call ``write`` with a temporary path beside ``path``, then rename the result; a file with the
    same content is left as it is."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(part)
        if not (is_file(path) and filecmp.cmp(part, path, shallow=False)):
            part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_json(path: Path, value: Mapping[str, Any], *, indent: int | None = 1) -> None:
    """Write a JSON file, completely or not at all; with an ``indent`` of None on one line.

    Raises
    ------
    ValueError : a number is not finite, which JSON cannot express
    """
    write_text(path, json_text(value, indent=indent))


def json_text(value: Mapping[str, Any], *, indent: int | None) -> str:
    """Return what ``write_json`` writes."""
    return json.dumps(value, indent=indent, allow_nan=False, default=plain_number) + "\n"


def plain_number(value: object) -> object:
    """Return the number that one of NumPy's is, for JSON: such as a part of a user's own may
    answer.
    """
    if callable(item := getattr(value, "item", None)):
        return item()
    raise TypeError(f"JSON has nothing for {type(value).__name__}")


def write_text(path: Path, text: str) -> None:
    """Write a text file, completely or not at all."""
    write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def write_tree(source: Path, target: Path) -> None:
    """Copy the files below ``source`` to ``target``; those with the same content are left as they
    are.
    """
    for path in sorted(path for path in source.rglob("*") if path.is_file()):
        copy = target / path.relative_to(source)
        copy.parent.mkdir(parents=True, exist_ok=True)
        write_whole(copy, partial(shutil.copyfile, path))


def files_hash(root: Path, paths: Iterable[Path]) -> str:
    """Return a SHA-256 of files below a folder, by their paths in it and their contents, in the
    order given.
    """
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def remove_reports(directory: Path) -> None:
    """Remove reports and exports of a run that continues, or of a design that is made again: they
    are no longer true.
    """
    for name in (REPORT_HTML, REPORT_PDF):
        (directory / name).unlink(missing_ok=True)
    shutil.rmtree(directory / EXPORT, ignore_errors=True)
