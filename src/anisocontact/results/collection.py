"""Files for ParaView: data sets, in pieces on several ranks, and lists that put them in time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from anisocontact.base.whole_files import replacing
from anisocontact.results.dataset import DataSet
from anisocontact.results.files import Disk, write_text


class Collection:
    """A `.pvd` file and the folder of the data sets it lists.

    On one rank a data set is one file. On several each rank writes a piece of its own, and the
    first one a file that names the pieces.

    Args:
        path: The `.pvd` file; its data sets go into the folder of the same name.
        suffix: Of the data sets, ".vtu" or ".vtp".
        comm: Communicator of the run.
    """

    def __init__(self, path: Path, suffix: str, comm: Any) -> None:
        self._path = path
        self._suffix = suffix
        self._comm = comm
        self._folder = path.with_suffix("")
        self._entries: list[tuple[float, str]] = []

    def state(self) -> list[list[Any]]:
        """What `resume` needs, as JSON can have it."""
        return [list(entry) for entry in self._entries]

    def resume(self, state: Iterable[Sequence[Any]]) -> None:
        """Go on behind the data sets of a state."""
        self._entries = [(float(time), str(name)) for time, name in state]

    def tidy(self) -> None:
        """Remove data sets that are not listed, and write the list anew."""
        listed = {Path(name).stem for _, name in self._entries}
        for path in self._folder.glob(f"*{self._suffix.replace('.', '.*')}"):
            if path.name.partition(".")[0] not in listed:
                path.unlink()
        if self._entries:
            self._write_list()
        else:
            self._path.unlink(missing_ok=True)

    def add(self, disk: Disk, time: float, data: DataSet | None) -> None:
        """Write a data set and then the list with it; all ranks call it.

        Args:
            disk: Where failures go.
            time: Time of the data.
            data: That of this rank, None for none; nothing is written where all have none.
        """
        sizes = self._comm.allgather(-1 if data is None else len(data.points))
        filled = [rank for rank, size in enumerate(sizes) if size > 0]
        if not filled:
            return
        rank = self._comm.rank
        number = f"{len(self._entries):04d}"
        whole = all(size < 0 for size in sizes[1:])
        suffix = self._suffix if whole else f".p{self._suffix[1:]}"
        disk.write(lambda: self._folder.mkdir(exist_ok=True))
        self._comm.Barrier()
        if data is not None and rank in filled:
            own = self._folder / f"{number}{'' if whole else f'.{rank}'}{self._suffix}"
            disk.write_each(lambda: _write(own, data.encoded()))
        self._comm.Barrier()
        if data is not None and rank == filled[0] and not whole:
            content = data.summary([f"{number}.{i}{self._suffix}" for i in filled])
            disk.write_each(lambda: _write(self._folder / f"{number}{suffix}", content))
        self._entries.append((time, f"{self._folder.name}/{number}{suffix}"))
        disk.write(self._write_list)

    def _write_list(self) -> None:
        rows = "".join(
            f'    <DataSet timestep="{t!r}" part="0" file="{escape(name)}"/>\n'
            for t, name in self._entries
        )
        write_text(
            self._path,
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
            f"{rows}  </Collection>\n</VTKFile>\n",
        )


def _write(target: Path, content: bytes) -> None:
    with replacing(target) as draft:
        try:
            draft.write_bytes(content)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(target)) from None
