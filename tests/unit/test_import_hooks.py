"""Modules that are executed when something of them is used; source: `import` as Python has it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = {
    "outer/__init__.py": "",
    "outer/inner/__init__.py": "import outer.heavy\n",
    "outer/inner/light.py": "number = 3\n",
    "outer/heavy.py": "print('heavy')\ndef f():\n    return 7\n",
}
USES = {
    "import outer.heavy": "",
    "import outer.heavy; outer.heavy.f()": "heavy\n",
    "from outer.heavy import f; f()": "heavy\n",
    "import outer.inner.light": "",
    "from outer.inner.light import number; assert number == 3": "",
    "import outer.inner; from outer.inner import light; outer.heavy.f()": "heavy\n",
    "import outer.heavy\ntry:\n outer.heavy.g\nexcept AttributeError as e: print(e)": "heavy\n"
    "module 'outer.heavy' has no attribute 'g'\n",
}


@pytest.mark.parametrize("use", USES)
def test_modules_are_executed_when_they_are_used(use: str, tmp_path: Path) -> None:
    """Requirement: a module that is put off prints when something of it is asked for, once."""
    for name, text in PACKAGE.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(text)
    before = "from anisocontact.base.import_hooks import alone, when_used\n"
    before += "when_used('outer.heavy'); alone('outer.inner.light'); alone('nothing.of.this')\n"
    done = subprocess.run(
        [sys.executable, "-c", before + use],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == USES[use]
