"""Every module can be the first one that is imported."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import anisocontact

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

#: What others bring is loaded once, then each module in a child that has none of ours. Those that a
#: package loads itself come with the package, whoever names them; the others are tried from there.
FIRST = """
import importlib, os, sys

for name in sys.argv[1:]:
    importlib.import_module(name)
kept = ("anisocontact", "anisocontact._core", "anisocontact.base.fenicsx")
for name in [name for name in sys.modules if name.split(".")[0] == "anisocontact"]:
    if name not in kept:
        del sys.modules[name]

def first(names):
    failed = False
    while names:
        name, below = names[0], [one for one in names if one.startswith(names[0] + ".")]
        child = os.fork()
        if child == 0:
            try:
                importlib.import_module(name)
            except BaseException as error:
                print(f"{name}: {type(error).__name__}: {error}", flush=True)
                os._exit(1)
            os._exit(first([one for one in below if one not in sys.modules]))
        failed |= os.waitpid(child, 0)[1] != 0
        names = [one for one in names[1:] if one not in below]
    return failed

os._exit(first(sys.argv[1:]))
"""


@pytest.mark.ci
@pytest.mark.slow
def test_every_module_imports_alone() -> None:
    """None needs another one to have been imported before it, as two that import each other do."""
    folder = Path(anisocontact.__file__).parent
    parts = {path.relative_to(folder.parent).with_suffix("").parts for path in folder.rglob("*.py")}
    modules = {".".join(p[:-1] if p[-1] == "__init__" else p) for p in parts}
    names = sorted(modules - {"anisocontact", "anisocontact.__main__"})
    assert len(names) > 100
    command = [sys.executable, "-W", "error::DeprecationWarning:anisocontact", "-c", FIRST, *names]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
