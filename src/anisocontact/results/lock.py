"""One run at a time in a results folder."""

from __future__ import annotations

import errno
import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.results.files import LOCK

#: What file systems answer that have no locks, some of those over a network.
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)
#: What a folder may lack for a while, whose run goes on later: no fault of its name.
_LACKING = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.ENOMEM, errno.EMFILE, errno.ENFILE)


@contextmanager
def locked(folder: Path, comm: Any = None) -> Iterator[str]:
    """Keep a results folder for this run until it ends, in whatever way.

    Args:
        folder: Results folder; made if it is not there, and taken away if nothing is written.
        comm: Communicator of the run, whose processes are one; the call is collective.

    Yields:
        A warning where the file system has no locks; empty where the folder is locked.

    Raises:
        InputError: Another process works in the folder, or no file can be made there.
    """
    first = comm is None or comm.rank == 0
    made = [path for path in (folder, *folder.parents) if not path.exists()] if first else []
    number, refused, warning = _locked(folder) if first else (None, "", "")
    if comm is not None:
        refused, warning = comm.bcast((refused, warning))
    try:
        if refused:
            raise InputError(refused)
        yield warning
    finally:
        if number is not None:
            with suppress(OSError):
                (folder / LOCK).unlink()
            os.close(number)
        with suppress(OSError):  # until one of them is not empty
            for path in made:
                path.rmdir()


def _locked(folder: Path) -> tuple[int | None, str, str]:
    """Descriptor of the locked file, why the folder is refused, and a warning."""
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            number = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            if error.errno in _LACKING:  # who writes the results says what is wrong
                return None, "", ""
            text = f"results folder '{folder}' cannot be written: {error.strerror}; "
            return None, text + "name another one with -o", ""
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            busy = _busy(folder, number)
            os.close(number)
            return None, busy, ""
        except OSError as error:
            os.close(number)
            if error.errno not in _NO_LOCKS:
                raise
            text = f"results folder '{folder}' cannot be locked ({error.strerror}): "
            return None, "", text + "two runs in it at once would mix their files"
        if _still_there(folder, number):
            os.truncate(number, 0)
            os.write(number, f"process {os.getpid()} on {socket.gethostname()}".encode())
            return number, "", ""
        os.close(number)  # whoever had it has ended in between, and taken the file away


def _still_there(folder: Path, number: int) -> bool:
    """Whether the file of a descriptor has its name still."""
    try:
        return os.path.samestat(os.fstat(number), os.stat(folder / LOCK))
    except FileNotFoundError:
        return False


def _busy(folder: Path, number: int) -> str:
    who = os.pread(number, 200, 0).decode(errors="replace") or "another process"
    return f"results folder '{folder}' is in use by {who}: wait for it, or name another one with -o"
