"""JSON files that carry the SHA-256 of their own content, so that a change is noticed.

The entry ``sha256`` of such a file is the hash of all its other entries, however they are laid out.
It shows changes by mistake, and is no signature.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from common.files import write_json
from measurement.errors import MeasurementError

_HASH = "sha256"
"""Entry with the hash."""


def content_hash(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a JSON object without its entry ``sha256``."""
    bare = {key: value for key, value in content.items() if key != _HASH}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def with_hash(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a JSON object with the hash of its content."""
    return {**content, _HASH: content_hash(content)}


def write_hashed(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON object with the hash of its content, in a folder that is made if need be.

    Raises
    ------
    OSError : the file cannot be written
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_json(path, with_hash(content))


@dataclass(frozen=True, kw_only=True)
class HashedFile:
    """A kind of file with a hash.

    Attributes
    ----------
    name : of the kind, in words
    kind : entry that says the kind, and its value
    version : entry that says the version, and the one that is read
    version_words : the entry in a sentence
    made_by : what makes such a file, in words
    remedy : what to do about a file that cannot be used, after a colon or semicolon; may be empty
    """

    name: str
    kind: tuple[str, str]
    version: tuple[str, int]
    version_words: str
    made_by: str
    remedy: str = ""

    def read(self, path: Path) -> dict[str, Any]:
        """Return the content of a file, after checking that nothing in it was changed.

        Raises
        ------
        MeasurementError : it cannot be read, is of another kind or version, or was changed
        """
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError) as error:
            raise MeasurementError(
                f"'{path}' cannot be read: {error}; give {self.made_by}"
            ) from None
        kind, kind_value = self.kind
        if not isinstance(content, dict) or content.get(kind) != kind_value:
            raise MeasurementError(f"'{path}' is no {self.name}; give {self.made_by}")
        entry, version = self.version
        if content.get(entry) != version:
            raise MeasurementError(
                f"'{path}' has {self.version_words} {content.get(entry)!r}; this program reads"
                f" {version}{f': {self.remedy}' if self.remedy else ''}"
            )
        if content.get(_HASH) != content_hash(content):
            raise MeasurementError(
                f"'{path}' was changed after it was written: its hash does not"
                f" fit{f'; {self.remedy}' if self.remedy else ''}"
            )
        return content
