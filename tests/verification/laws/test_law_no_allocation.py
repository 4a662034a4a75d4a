"""The update of a point takes no memory, whatever the sliding rule."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
#: glibc's own allocator under a counter; operator new and Eigen end up here, too.
COUNTER = """
#include <stddef.h>
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
static size_t taken = 0;
size_t allocations(void) { return taken; }
void* malloc(size_t n) { return ++taken, __libc_malloc(n); }
void* calloc(size_t n, size_t m) { return ++taken, __libc_calloc(n, m); }
void* realloc(void* p, size_t n) { return ++taken, __libc_realloc(p, n); }
void* aligned_alloc(size_t a, size_t n) { return ++taken, __libc_memalign(a, n); }
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="counts glibc's malloc")
def test_no_allocation_in_the_hot_path(tmp_path):
    """Twice the points allocate no more, with every rule on four surfaces, with tangent or not.

    Requirement: no allocation in the loop over points, be they open, stuck or slipping. The core
    is the one that is used everywhere else. Tolerance: one allocation for a hundred points, which
    the interpreter may make meanwhile; a point that allocates does so once at least. The last line
    is that of arrays that are made to be counted.
    """
    compiler = os.environ.get("CC", "").split() or [shutil.which("cc") or "gcc"]
    source, library = tmp_path / "counter.c", tmp_path / "counter.so"
    source.write_text(COUNTER)
    command = [*compiler, "-shared", "-fPIC", "-fno-builtin", "-O1", str(source)]
    subprocess.run([*command, "-o", str(library)], check=True)
    done = subprocess.run(
        [sys.executable, "-m", "tests.verification.laws.allocations"],
        cwd=ROOT,
        env=os.environ | {"LD_PRELOAD": str(library), "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    *updates, counter = [line.split() for line in done.stdout.splitlines()]
    assert float(counter[2]) >= 100.0, "the counter does not count"
    assert len(updates) > 4 * 2 * 5
    for shape, rule, each, *seen in updates:
        assert float(each) < 0.01, f"{shape}, {rule}: {each} allocations a point"
        assert min(map(int, seen)) > 100, f"{shape}, {rule}: {seen} open, stuck and slid"
