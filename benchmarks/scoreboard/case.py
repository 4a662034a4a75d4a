"""A hard case and the ways to run it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import product
from pathlib import Path

CASES = Path(__file__).parent / "cases"
#: What is written into the contacts of a case, by name.
METHODS = {
    "auto": "",
    "penalty": 'pass = "single"\nmethod = "penalty"\n',
    "augmented": 'pass = "single"\nmethod = "augmented"\n',
    "mortar": 'pass = "mortar"\nmethod = "penalty"\n',
    "mortar-augmented": 'pass = "mortar"\nmethod = "augmented"\n',
}
STRATEGIES = ("direct", "condensed", "iterative")


@dataclass(frozen=True)
class Way:
    """How a case is run.

    Attributes:
        method: What its contacts are, a name in `METHODS`.
        strategy: How the equations are solved.
    """

    method: str
    strategy: str

    def __str__(self) -> str:
        """Both, as in `augmented, direct`."""
        return f"{self.method}, {self.strategy}"


WAYS = tuple(Way(*both) for both in product(METHODS, STRATEGIES))


@dataclass(frozen=True)
class HardCase:
    r"""A case file of this folder.

    Attributes:
        name: Name of the file.
        text: The case file.

    Example:
        >>> case = HardCase("two", '# A pair.\n# stops: friction\ntitle = "A"\n[[contact]]\n')
        >>> case.what, case.stops
        ('A pair.', 'friction')
        >>> print(case.written(Way("augmented", "direct")).partition("title")[2])
         = "A"
        [[contact]]
        pass = "single"
        method = "augmented"
        <BLANKLINE>
        [solver]
        strategy = "direct"
        <BLANKLINE>
    """

    name: str
    text: str

    @property
    def what(self) -> str:
        """What is hard about it: the comment at its head."""
        lines = re.match(r"(#.*\n)*", self.text)
        kept = [line[2:] for line in (lines[0] if lines else "").splitlines()]
        return " ".join(line for line in kept if not line.startswith("stops:"))

    @property
    def stops(self) -> str:
        """A word of the reason for which it has to stop before its end; empty where it has not."""
        found = re.search(r"^# stops: (.*)$", self.text, re.M)
        return found[1] if found else ""

    def written(self, way: Way) -> str:
        """The case file with the method of its contacts and the strategy."""
        text = self.text.replace("[[contact]]\n", f"[[contact]]\n{METHODS[way.method]}")
        return f'{text}\n[solver]\nstrategy = "{way.strategy}"\n'


def all_cases(names: list[str] | None = None) -> list[HardCase]:
    """The cases of this folder, or those whose names begin with one of `names`."""
    found = [HardCase(path.stem, path.read_text()) for path in sorted(CASES.glob("*.toml"))]
    return [case for case in found if not names or case.name.startswith(tuple(names))]
