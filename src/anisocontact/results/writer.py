"""The results folder while a run goes on."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from anisocontact import __version__
from anisocontact.base.errors import InputError, printable
from anisocontact.contact.narrow import narrow_so_far
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.results.checkpoint_times import Checkpoints
from anisocontact.results.dataset import DataSet
from anisocontact.results.fields import FieldFiles
from anisocontact.results.files import FAILED, Disk, WriteError, clear, clear_drafts, write_text
from anisocontact.results.history import HistoryTable
from anisocontact.results.master_patches import MasterPatches
from anisocontact.results.no_energy import energies_by_name, finite
from anisocontact.results.output_options import Labels, OutputOptions
from anisocontact.results.paraview import BodyGrid, slave_points
from anisocontact.results.probes import Probe, ProbeTable
from anisocontact.results.read import Results
from anisocontact.results.report_process import Reporter, report_here
from anisocontact.results.snapshot import Observer, constants
from anisocontact.results.vtkhdf import write_vtkhdf
from anisocontact.results.warnings import (
    UNREPORTED,
    at_end,
    at_start,
    idle,
    narrow,
    of_models,
    soft,
    worst,
    worst_of_models,
)
from anisocontact.solver import Accepted, Culprit, Cut, Problem, Step
from anisocontact.solver.stepping.increment_warnings import lasting, missed_event
from anisocontact.solver.terms.persistent import Persistent


class Writer:
    """Writes a run into a folder; every file in it is whole at any moment.

    Every rank makes the same calls and writes its pieces of bodies, slave points and checkpoints,
    the first one the rest.

    Args:
        folder: Where; what an earlier run left there is removed.
        problem: The problem, not yet solved.
        steps: Its steps.
        options: What is written, and when.
        labels: What the run and its parts are called.
        case: Text of the case file, kept beside the results.
        reporter: Makes the report at the end.
        resumed: What `state` gave: the folder is that of a run which goes on.

    Raises:
        WriteError: The folder cannot be written.

    Attributes:
        folder: The folder.
        summary: What `summary.json` says.
    """

    def __init__(
        self,
        folder: str | Path,
        problem: Problem,
        steps: Sequence[Step],
        options: OutputOptions | None = None,
        labels: Labels | None = None,
        *,
        case: str = "",
        reporter: Reporter = report_here,
        resumed: Mapping[str, Any] | None = None,
    ) -> None:
        self._began = time.perf_counter()
        self._problem = problem
        self._steps = list(steps)
        self._options = options = options or OutputOptions()
        self._reporter, labels = reporter, labels or Labels()
        self._kept, self._lasting = 0, dict[str, str]()
        self._disk = Disk(problem.model.mesh.comm)
        self.folder = Path(folder)
        self._checkpoints = Checkpoints(self.folder, problem.model, options.checkpoint_every)
        self._observer = Observer(problem, self._steps, options.resultants)
        self._disk.write(lambda: self._open(case, resumed is not None))
        self._constants = constants(problem, labels.masters or [c.name for c in problem.contacts])
        self._history = HistoryTable(self.folder / "history.csv")
        self._bodies = BodyGrid(problem, options.quantities)
        self._probes = self._probe_tables(options.probes)
        now = self._now(options.quantities)
        self._fields = FieldFiles(self.folder, self._disk, self._steps, now, options)
        self.summary: dict[str, Any] = self._head(labels.title) | {"units": dict(labels.units)}
        if resumed is None:
            self._begin()
        else:
            self._resume(resumed)
        self._write_summary()
        self._disk.check()

    def _open(self, case: str, resumed: bool) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        if resumed:
            clear_drafts(self.folder)
            (self.folder / FAILED).unlink(missing_ok=True)
        else:
            clear(self.folder)
            write_text(self.folder / "run.log", f"anisocontact {__version__}\n")
        if case:
            write_text(self.folder / "case.toml", case)

    def _probe_tables(self, probes: Mapping[str, Probe]) -> dict[str, ProbeTable]:
        folder = self.folder / "probes"
        return {
            name: ProbeTable(folder / f"{name}.csv", probe, self._bodies, name)
            for name, probe in probes.items()
        }

    def _now(self, quantities: Sequence[str]) -> dict[str, Callable[[], DataSet | None]]:
        """What the files for ParaView have of the state of now, by sort of fields."""
        contacts = self._problem.contacts
        surfaces = MasterPatches(contacts, self._problem.model.mesh.comm, quantities)
        return {
            "fields": self._bodies.grid,
            "contact": lambda: slave_points(contacts, quantities),
            "surfaces": surfaces.mesh,
        }

    def _begin(self) -> None:
        """Write the state before the first increment, and what is to be said of it."""
        self._take(self._observer.numbers())
        self._at_start = at_start(self._problem.contacts, self.summary["contacts"])
        for warning in self._at_start:
            self.log(f"warning: {warning}")
        self._fields.write(0.0)

    def _resume(self, state: Mapping[str, Any]) -> None:
        """Take up the files where they were at a checkpoint."""
        for name, value in state["summary"].items():
            if name not in ("title", "version", "ranks", "unknowns", "units"):
                self.summary[name] = value
        energy = self.summary["energy"]  # JSON has null for what is not a number
        self.summary["energy"] = {n: math.nan if v is None else v for n, v in energy.items()}
        self._began -= state["summary"]["wall_time_s"]
        self._at_start = list(state["at_start"])
        self._lasting = dict(state.get("lasting", {}))
        self._kept = state["kept"]
        self._disk.write(lambda: self._history.resume(state["history"]))
        for name, table in self._probes.items():
            if name in state.get("probes", {}):
                self._disk.write(partial(table.history.resume, state["probes"][name]))
        self._fields.resume(state)
        self.log(f"goes on after {self.summary['steps']} accepted increments")

    def state(self) -> dict[str, Any]:
        """Where the files are, as JSON can have it."""
        return {
            "summary": self.summary,
            "at_start": self._at_start,
            "lasting": self._lasting,
            "kept": self._kept,
            "history": self._history.state(),
            "probes": {name: table.history.state() for name, table in self._probes.items()},
        } | self._fields.state()

    def keep(self, kept: Persistent, facts: Mapping[str, Any]) -> None:
        """Keep an accepted increment, from which the run can go on; see `Checkpoints`.

        Args:
            kept: State of the run, of this rank.
            facts: What the next run has to know beside it.

        Raises:
            WriteError: It cannot be written; the one before is still there.
        """
        self._kept += 1
        content = {"writer": finite(self.state()), **facts}
        self._checkpoints.take(self._disk, self._kept, kept, content)

    def keep_last(self) -> None:
        """Write a checkpoint of the last increment that `keep` has taken, unless it has one.

        Raises:
            WriteError: It cannot be written; the one before is still there.
        """
        self._checkpoints.write(self._disk)

    def strategy(self, name: str, reason: str) -> None:
        """Say how the equations are solved, and why."""
        self.summary["strategy"] = name
        self.summary["strategy_reason"] = reason
        self.log(f"strategy: {name} ({reason})")
        self._write_summary()

    def log(self, text: str) -> None:
        """Add a line to `run.log`; what does not print in it is written as an escape."""
        self._disk.write(lambda: self._append(text))

    def _append(self, text: str) -> None:
        with (self.folder / "run.log").open("a", encoding="utf-8") as file:
            file.write(printable(text) + "\n")

    def accept(self, accepted: Accepted) -> None:
        """Write an accepted increment: table and summary, and fields where they are due.

        Raises:
            WriteError: Something cannot be written.
        """
        for note in self._problem.stabilisation.take_notes():
            self.log(note)
        numbers = self._observer.numbers(accepted)
        row = {
            "step": accepted.step,
            "increment": accepted.increment,
            "time": accepted.time,
            "newton_iterations": accepted.iterations,
            "residual": accepted.residuals[-1],
        }
        self._disk.write(lambda: self._history.append(row | numbers))
        self._write_probes({name: row[name] for name in ("step", "increment", "time")})
        self.summary["steps"] += 1
        self.summary["newton_iterations"] += accepted.iterations
        before, self.summary["time"] = self.summary["time"], accepted.time
        self._take(numbers)
        self.summary.update(worst_of_models(accepted, self.summary))
        self._lasting = lasting(accepted) | self._lasting
        if accepted.event or accepted.missed:
            self.summary["events"].append(_event(accepted))
        self._fields.accept(accepted, before)
        self._write_summary()
        self._disk.check()

    def _write_probes(self, when: Mapping[str, Any]) -> None:
        for table in self._probes.values():
            rows = table.rows(when, table.values())
            for row in rows:
                self._disk.write(partial(table.history.append, row))

    def cut(self, cut: Cut) -> None:
        """Log a cut and keep it for the summary."""
        self.log(str(cut))
        self._log_culprits(cut.culprits, cut.count)
        self.summary["cuts"].append(asdict(cut))

    def _log_culprits(self, culprits: Sequence[Culprit], count: int = 0) -> None:
        """Log the places that caused a failure, and how many there are if not all are given."""
        for one in culprits:
            self.log(f"    {one}")
        if count > len(culprits):
            self.log(f"    and {count - len(culprits)} more")

    def log_stop(
        self, why: str, culprits: Sequence[Culprit] = (), failed: FailedPoint | None = None
    ) -> None:
        """Log why a run stopped, with the places that caused it, and keep a point that failed."""
        self.log(f"stopped: {why}")
        self._log_culprits(culprits)
        self._keep_failed(failed)

    def _keep_failed(self, point: FailedPoint | None) -> None:
        """Write a point at which the laws failed, if this rank has one."""
        if point is None:
            return
        try:
            self._disk.write_each(lambda: point.write(self.folder / FAILED))
            said = f"the point is kept: anisocontact replay {self.folder / FAILED}"
        except InputError as error:
            said = f"{FAILED} is not written: {error}"
        self._disk.write_each(lambda: self._append(said))

    def close(self, status: str, message: str = "", doubtful: Sequence[str] = ()) -> str:
        """Write the end of the run and its report.

        Args:
            status: "done" or "stopped".
            message: Why it stopped.
            doubtful: What is to be said of the case and its steps, beside what happened.

        Returns:
            A warning, that there is no report, which the files do not have; empty if there is.

        Raises:
            WriteError: What converged last could not be written, why is in `summary`.
        """
        self._checkpoints.rescue()
        self._fields.close(self.summary["time"])
        self.summary["stress"] = self._bodies.extremes()
        self.summary["status"] = status
        self.summary["message"] = message
        contacts, shown = self._problem.contacts, self.summary["contacts"]
        relaxed = bool(self.summary.get("relaxed"))
        found = at_end(contacts, shown, self.summary["energy"], relaxed, self._at_start)
        if status == "done":  # a run that stopped has its reason
            found += [*idle(contacts, shown), *soft(contacts, shown, relaxed), *narrow(shown)]
        missed = [event["text"] for event in self.summary["events"] if not event["happened"]]
        found = [*missed, *found]
        known = [*self._at_start, *self._lasting.values(), *found, *of_models(self.summary)]
        self.summary["warnings"] = list(dict.fromkeys([*doubtful, *known]))
        self._write_summary()
        if self._options.vtkhdf:
            self._disk.write(self._write_vtkhdf)
        if lost := self._disk.failure():
            reasons = dict.fromkeys(filter(None, (message, lost)))
            self.summary |= {"status": "stopped", "message": "; ".join(reasons)}
            raise WriteError(lost)
        if self._options.pictures:
            self._disk.write(self._report)
        if not (lost := self._disk.failure()):
            return ""
        said = UNREPORTED.format(lost=lost, folder=self.folder)
        self.summary["warnings"].append(said)
        return said

    def abandon(self, message: str, details: str = "") -> None:
        """Note the end of a run in which the other processes are stuck; any of them may do it.

        Args:
            message: Why it stopped.
            details: For the log.
        """
        self.summary["status"] = "stopped"
        self.summary["message"] = message
        with suppress(OSError):
            for line in (details or message).splitlines():
                self._append(line)
            write_text(self.folder / "summary.json", self._text())

    def _write_vtkhdf(self) -> None:
        results = Results(self.folder)
        for kind in results.kinds:
            write_vtkhdf(results, self.folder / f"{kind}.vtkhdf", kind)

    def _report(self) -> None:
        for line in self._reporter(self.folder):
            self._append(line)

    def _head(self, title: str) -> dict[str, Any]:
        model = self._problem.model
        topology = model.mesh.topology
        return {
            "status": "stopped",
            "message": "not finished: the run still goes on or was killed",
            "title": title,
            "version": __version__,
            "wall_time_s": 0.0,
            "unknowns": self._problem.unknowns,
            "nodes": model.space.dofmap.index_map.size_global,
            "cells": topology.index_map(topology.dim).size_global,
            "bodies": model.body_names(),
            "idealisation": model.idealisation.entry.name,
            "ranks": model.mesh.comm.size,
            "steps": 0,
            "newton_iterations": 0,
            "time": 0.0,
            "cuts": [],
            "events": [],
            "warnings": [],
        }

    def _take(self, numbers: dict[str, Any]) -> None:
        pairs = zip(numbers["contacts"], self._constants, strict=True)
        contacts = [constant | changing for changing, constant in pairs]
        before = self.summary.get("contacts", [{}] * len(contacts))
        # loads press as they are, however soft penalties are; temperatures do not
        stored = numbers["energy"] if self._problem.bulk.heated else {}
        for contact, entry, old in zip(self._problem.contacts, contacts, before, strict=True):
            entry.update(worst(entry, old, self.summary["time"], stored))
            entry["narrow"] = narrow_so_far(contact, old.get("narrow"))
        self.summary.update(numbers, contacts=contacts)

    def _write_summary(self) -> None:
        self.summary["wall_time_s"] = round(time.perf_counter() - self._began, 3)
        text = self._text()
        self._disk.write(lambda: write_text(self.folder / "summary.json", text))

    def _text(self) -> str:
        energy = energies_by_name(self.summary.get("energy", {}))
        content = finite(self.summary | {"energy": energy})
        return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _event(accepted: Accepted) -> dict[str, Any]:
    """What has become of the event of a step, for the summary."""
    text = accepted.event or f"step {accepted.step!r}: {missed_event(accepted)}"
    happened = bool(accepted.event)
    return {"step": accepted.step, "time": accepted.time, "happened": happened, "text": text}
