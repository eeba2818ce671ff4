"""The manifest of a run: configuration, software and parameters."""

import hashlib
import json
import re
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel
from pydantic_core import to_jsonable_python

from common.provenance import provenance
from scenarios.engine.fingerprint import fingerprint


def initial_manifest(scenario: BaseModel, name: str, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the manifest as written before the first flight.

    Parameters
    ----------
    scenario, name : the scenario and its name
    overrides : overrides that were applied to the scenario
    """
    config = scenario.model_dump(mode="json")
    return {
        "study": config["study"],
        "name": name,
        "title": config["title"],
        "overrides": list(overrides),
        "config": config,
        "config_hash": config_hash(scenario),
        "fingerprint": fingerprint(),
        "parameters": parameters(scenario),
        **provenance(),
    }


def config_hash(*scenarios: BaseModel) -> str:
    """Return a hash of the scenarios."""
    text = "\n".join(json.dumps(scenario.model_dump(mode="json"), sort_keys=True) for scenario in scenarios)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def parameters(scenario: BaseModel) -> list[dict[str, Any]]:
    """Return every key of the scenario's sections with value, default if any, meaning and unit."""
    listed = []
    for section_name in type(scenario).model_fields:
        section = getattr(scenario, section_name)
        if not isinstance(section, BaseModel) or section_name in ("comparison", "sweep"):
            continue
        values = section.model_dump(mode="json")
        for key, field in type(section).model_fields.items():
            meaning, unit = _split_unit(field.description or "")
            parameter = {"key": f"{section_name}.{key}", "value": values[key], "unit": unit, "meaning": meaning}
            if not field.is_required():
                parameter["default"] = to_jsonable_python(field.get_default(call_default_factory=True))
            listed.append(parameter)
    return listed


def _split_unit(description: str) -> tuple[str, str]:
    """Split "Meaning [unit]; more." into the meaning and the unit."""
    found = re.search(r"\s*\[([^\]]+)\]", description)
    if found is None:
        return description, ""
    meaning = description[: found.start()] + description[found.end() :]
    return meaning, "" if found[1] == "-" else found[1]
