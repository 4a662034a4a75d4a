"""What came of a run: read from the results that a user has."""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import measure
from about import paths
from blocks.ours import RUN

from scoreboard.case import HardCase, Way

#: Exit codes of the command that mean: bad input, stopped before the end.
REFUSED, STOPPED = 2, 3


@dataclass(frozen=True)
class Outcome:
    """A run of a case in one way.

    Attributes:
        case: Name of the case.
        method: Method of its contacts.
        strategy: Strategy of the solution.
        status: "done", "stopped", "refused" (this way does not apply to the case), "time" (beyond
            the limit) or "error".
        said: Why it stopped or was refused.
        iterations: Newton iterations, those of failed attempts too.
        cuts: Number of cuts.
        balance: Largest residual of an accepted state over the forces at work.
        energy: Residual of the balance of energies at the end over the work and the energies.
        warnings: What the run warned of.
        seconds: Processor time, s.
    """

    case: str
    method: str
    strategy: str
    status: str
    said: str = ""
    iterations: int = 0
    cuts: int = 0
    balance: float = 0.0
    energy: float = 0.0
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def key(self) -> tuple[str, str, str]:
        """Case and way."""
        return self.case, self.method, self.strategy


def load(path: Path) -> dict[tuple[str, str, str], Outcome]:
    """Outcomes that were kept, by case and way."""
    kept = json.loads(path.read_text())["outcomes"] if path.exists() else []
    found = (Outcome(**one | {"warnings": tuple(one["warnings"])}) for one in kept)
    return {one.key: one for one in found}


def store(found: dict[tuple[str, str, str], Outcome], made: dict[str, str], path: Path) -> None:
    """Keep outcomes, a line each."""
    lines = ",\n".join(json.dumps(asdict(found[key])) for key in sorted(found))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'{{"made": {json.dumps(made)},\n"outcomes": [\n{lines}\n]}}\n')


def run(case: HardCase, way: Way, folder: Path, limit: float) -> Outcome:
    """Run a case with the command that a user has.

    Args:
        case: The case.
        way: How.
        folder: Where, an empty folder.
        limit: Wall time after which it is ended, s.
    """
    (folder / "case.toml").write_text(case.written(way))
    command = [*RUN, "case.toml", "-o", "out"]
    used = measure.run(command, folder, 1, limit, {"PYTHONPATH": paths()})
    plain = Outcome(case.name, way.method, way.strategy, "error", seconds=round(used.processor, 1))
    printed = (folder / "stdout").read_text().splitlines()
    last = next((line for line in reversed(printed) if line.startswith("error")), "")
    if used.status < 0:
        return Outcome(**asdict(plain) | {"status": "time", "said": f"ended after {limit:.0f} s"})
    if used.status == REFUSED:
        return Outcome(**asdict(plain) | {"status": "refused", "said": last})
    if used.status not in (0, STOPPED):
        return Outcome(**asdict(plain) | {"said": last or f"exit code {used.status}"})
    return Outcome(**asdict(plain) | _read(folder / "out"))


def _read(folder: Path) -> dict[str, object]:
    """What the results of a run say, by name of the attribute."""
    summary = json.loads((folder / "summary.json").read_text())
    path = folder / "history.csv"  # absent where nothing converged
    history = list(csv.DictReader(path.read_text().splitlines())) if path.exists() else []
    energies = {
        name.partition(".")[2]: float(value or "nan")
        for name, value in (history[-1] if history else {}).items()
        if name.startswith("energy.")
    }
    residual = energies.pop("residual", 0.0)
    scale = max(map(abs, energies.values()), default=0.0)
    return {
        "status": summary["status"],
        "said": summary["message"],
        "iterations": summary["newton_iterations"],
        "cuts": len(summary["cuts"]),
        "balance": max((float(row["residual"]) for row in history), default=0.0),
        "energy": residual / scale if scale > 0.0 else 0.0,
        "warnings": tuple(summary["warnings"]),
    }
