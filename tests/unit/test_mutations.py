"""The mutations of the core (`make mutants`) fit the sources: nothing is compiled here.

Requirement: at least 20, each by its own name; the text of each occurs exactly once in its file
and is changed; the files that are compiled and the tests that have to notice exist.
"""

from __future__ import annotations

import importlib.util
import re
import shlex
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


def _tool() -> Any:
    spec = importlib.util.spec_from_file_location("mutants", ROOT / "tools" / "mutants.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look themselves up
    spec.loader.exec_module(module)
    return module


MUTATIONS = _tool().mutations()


def test_enough_with_names_of_their_own() -> None:
    names = [one.name for one in MUTATIONS]
    assert len(names) == len(set(names)) >= 20


@pytest.mark.parametrize("one", MUTATIONS, ids=lambda one: one.name)
def test_mutation_fits(one: Any) -> None:
    assert one.places() == 1
    assert one.after not in (one.before, "")
    assert one.compiles or any("test_pair_tangent" in t for t in one.tests)
    for name in one.compiles:
        assert any((ROOT / "cpp" / at / f"{name}.cpp").is_file() for at in ("python", "src"))
    assert one.tests
    for arguments in one.tests:
        for call in shlex.split(arguments):
            file, _, test = call.partition("::")
            text = (ROOT / file).read_text()
            name, _, parameters = test.partition("[")
            assert not name or f"def {name}(" in text
            # words of parameters are those of the law beside the tests, or of the registries
            known = text + (ROOT / "tests/verification/independent/law.py").read_text()
            words = re.findall(r"[a-z]+", parameters)
            assert all(word in known for word in words)
