"""gnc/EQUATIONS.md names what exists."""

import ast
import importlib
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "gnc" / "EQUATIONS.md").read_text(encoding="utf-8")
NAMES = sorted(set(re.findall(r"`(gnc(?:\.\w+)+\.\w+)`", PAGE)))
TESTS = sorted(set(re.findall(r"`([^`]+::[^`]+)`", PAGE)))


def test_every_name_and_every_test_on_the_page_exists():
    for name in NAMES:
        module, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(module), attribute), name
    for test in TESTS:
        file, _, function = test.partition("::")
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        assert function in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
