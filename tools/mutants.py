"""Changes the core in one place at a time and sees whether the tests notice.

`make mutants`, or `python tools/mutants.py [NAME ...]`. The mutations are in
`tools/mutations.toml`: a text of a file that occurs once, what stands there instead, the files of
`cpp/python` and `cpp/src` that are compiled with it and the tests that have to fail. All runs in a
copy of the sources in `build/mutants`, without optimisation: the core is compiled once as it is,
and for each mutation only the files named, which are linked in front of the others, so that the
linker takes their copies of shared templates. Ends with 1 where a mutation survives, does not
compile, or a test fails without any.
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIST = ROOT / "tools" / "mutations.toml"
CPP = Path("cpp")
#: What the tests need besides the core.
COPIED = ("cpp", "src", "tests", "tools", "docs", "examples")
FILES = ("CMakeLists.txt", "LICENSE", "pyproject.toml")
# An editable install of the package finds its own sources before the copy: it is taken out.
START = """
import runpy, sys
sys.meta_path[:] = [f for f in sys.meta_path if "anisocontact" not in type(f).__module__]
sys.argv = sys.argv[1:]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""


@dataclass(frozen=True)
class Mutation:
    """One change of one file.

    Attributes:
        name: A word for it.
        file: The header or source, below `cpp`.
        before: Text that occurs once in it.
        after: What stands there instead.
        compiles: Files of `cpp/python` and `cpp/src`, without suffix, that are compiled anew.
        tests: Arguments of pytest, one list for each call; the first failure ends it.
    """

    name: str
    file: str
    before: str
    after: str
    compiles: tuple[str, ...]
    tests: tuple[str, ...]

    def places(self, root: Path = ROOT) -> int:
        """How often the text occurs in the file below a root."""
        return (root / CPP / self.file).read_text().count(self.before)

    def applied(self, text: str) -> str:
        """The file with the change."""
        return text.replace(self.before, self.after)


def mutations() -> list[Mutation]:
    """All mutations of the list; a group says once what most of it compiles."""
    found = []
    for group in tomllib.loads(LIST.read_text())["group"]:
        for one in group["mutation"]:
            given = {"compiles": group["compiles"]} | one
            name, file, before, after = (given[key] for key in ("name", "file", "before", "after"))
            found.append(
                Mutation(name, file, before, after, tuple(given["compiles"]), tuple(given["tests"]))
            )
    return found


class Core:
    """A copy of the sources with the core compiled as it is.

    Args:
        folder: Where; objects of an earlier call that still fit are taken again.
    """

    def __init__(self, folder: Path) -> None:
        self.root = folder / "sources"
        self._build = folder / "objects"
        self._module = self.root / "src/anisocontact/_core.so"

    def prepare(self) -> None:
        """Copy the sources and compile; headers that are the same keep their dates."""
        for name in COPIED:
            _mirror(ROOT / name, self.root / name)
        for name in FILES:
            _keep(ROOT / name, self.root / name)
        configure = ["cmake", "-S", self.root, "-B", self._build, "-G", "Ninja"]
        options = ["-DCMAKE_BUILD_TYPE=Quick", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]
        _run([*configure, *options, f"-DPython_EXECUTABLE={sys.executable}"])
        _run(["cmake", "--build", self._build, "--parallel", str(os.cpu_count() or 1)])
        self._take(self._objects(), {})

    @contextmanager
    def mutated(self, one: Mutation) -> Iterator[None]:
        """The file changed, for tests that compile it, and linked with what is compiled of it."""
        header = self.root / CPP / one.file
        text, old = header.read_text(), header.stat()
        header.write_text(one.applied(text))
        try:
            changed = {name: self._compile(name) for name in one.compiles}
            self._take(self._objects(), changed)
            yield
        finally:
            header.write_text(text)
            os.utime(header, ns=(old.st_atime_ns, old.st_mtime_ns))

    def test(self, arguments: str) -> bool:
        """Whether tests pass.

        Raises:
            RuntimeError: They could not be run.
        """
        command = [sys.executable, "-c", START, "pytest", "-x", "-q", "-p", "no:cacheprovider"]
        env = os.environ | {"PYTHONPATH": str(self.root / "src")}
        command += ["-m", "", "--rootdir", str(self.root), *shlex.split(arguments)]
        r = subprocess.run(
            command, cwd=self.root, env=env, capture_output=True, text=True, check=False
        )
        if r.returncode not in (0, 1):
            raise RuntimeError(f"{arguments}\n{r.stdout[-3000:]}{r.stderr[-3000:]}")
        return r.returncode == 0

    def _objects(self) -> dict[str, Path]:
        found = self._build.glob("CMakeFiles/*.dir/cpp/*/*.cpp.o")
        return {path.name.removesuffix(".cpp.o"): path for path in found}

    def _compile(self, name: str) -> Path:
        """One file of the core, to an object beside the one that is kept."""
        entries = json.loads((self._build / "compile_commands.json").read_text())
        (entry,) = (e for e in entries if Path(e["file"]).name == f"{name}.cpp")
        command = shlex.split(entry["command"])
        made = self._build / f"{name}.mutated.o"
        command[command.index("-o") + 1] = str(made)
        _run(command, cwd=entry["directory"])
        return made

    def _take(self, kept: dict[str, Path], changed: dict[str, Path]) -> None:
        """Link the module of the copy, what has changed in front."""
        rest = [path for name, path in sorted(kept.items()) if name not in changed]
        (library,) = self._build.glob("libnanobind-static*.a")
        compiler = os.environ.get("CXX", "c++")
        draft = self._module.with_suffix(".draft")
        objects = [*changed.values(), *rest, library]
        _run([compiler, "-shared", "-pthread", "-o", draft, *objects])
        draft.replace(self._module)


def _run(command: Sequence[object], cwd: str | Path | None = None) -> None:
    r = subprocess.run(
        [str(c) for c in command], cwd=cwd, capture_output=True, text=True, check=False
    )
    if r.returncode:
        raise RuntimeError(f"{shlex.join(map(str, command))}\n{r.stdout[-3000:]}{r.stderr[-3000:]}")


def _keep(source: Path, target: Path) -> None:
    """Copy a file where it differs."""
    if not target.is_file() or target.read_bytes() != source.read_bytes():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


def _mirror(source: Path, target: Path) -> None:
    """Copy a folder, but for what is compiled or a cache; files that have gone go."""
    there = {p.relative_to(source) for p in source.rglob("*") if p.is_file() and _wanted(p)}
    for path in there:
        _keep(source / path, target / path)
    for path in [p for p in target.rglob("*") if p.is_file()]:
        if path.relative_to(target) not in there and _wanted(path):
            path.unlink()


def _wanted(path: Path) -> bool:
    return path.suffix not in (".so", ".pyc") and "__pycache__" not in path.parts


def _baseline(core: Core, chosen: Sequence[Mutation]) -> Iterator[str]:
    """Tests that fail without a mutation."""
    for arguments in dict.fromkeys(t for one in chosen for t in one.tests):
        if not core.test(arguments):
            yield arguments


def fate(core: Core, one: Mutation) -> str:
    """Killed, survived, or what went wrong.

    Args:
        core: The copy.
        one: The mutation.
    """
    if one.places() != 1:
        return f"its text occurs {one.places()} times in {one.file}"
    try:
        with core.mutated(one):
            return "survived" if all(core.test(arguments) for arguments in one.tests) else "killed"
    except RuntimeError as error:
        return f"error: {error}"


def run(core: Core, chosen: Sequence[Mutation], say: Callable[[str], None]) -> bool:
    """Whether all tests pass as the core is, and every mutation is killed.

    Args:
        core: The copy.
        chosen: The mutations.
        say: Takes a line.
    """
    begin = time.perf_counter()
    core.prepare()
    failed = list(_baseline(core, chosen))
    for arguments in failed:
        say(f"fails without a mutation: {arguments}")
    if failed:
        return False
    say(f"core compiled, tests pass without a mutation: {time.perf_counter() - begin:.0f} s")
    killed = 0
    for one in chosen:
        start = time.perf_counter()
        found = fate(core, one)
        killed += found == "killed"
        say(f"{one.name}: {found} ({time.perf_counter() - start:.0f} s)")
    say(f"{killed} of {len(chosen)} mutations killed in {time.perf_counter() - begin:.0f} s")
    return killed == len(chosen)


def main() -> int:
    """Run the mutations that are named, or all."""
    parser = argparse.ArgumentParser(description="Mutations of the core that tests have to notice.")
    parser.add_argument("names", nargs="*", help="some of the mutations; all if left out")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "mutants")
    given = parser.parse_args()
    every = mutations()
    if unknown := set(given.names) - {one.name for one in every}:
        parser.error(f"no mutation called {', '.join(sorted(unknown))}")
    chosen = [one for one in every if not given.names or one.name in given.names]
    return 0 if run(Core(given.folder), chosen, lambda line: print(line, flush=True)) else 1


if __name__ == "__main__":
    sys.exit(main())
