"""Time and memory of a whole process."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

#: What sets the number of threads in one code or another.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "CCX_NPROC")


@dataclass(frozen=True)
class Use:
    """What a process took.

    Attributes:
        wall: Wall time, s.
        processor: Processor time of all threads in user and system mode, s: other work on the
            machine moves it less than the wall time.
        memory: Peak resident memory of the process or of the largest of its children, MB.
        load: Load average of the machine when it began.
        status: Exit status; negative where a signal ended it.
    """

    wall: float
    processor: float
    memory: float
    load: float
    status: int

    @property
    def values(self) -> dict[str, float]:
        """What a record keeps."""
        return {
            "wall s": round(self.wall, 3),
            "processor s": round(self.processor, 3),
            "peak MB": round(self.memory, 1),
            "load before": round(self.load, 2),
        }


def run(
    command: Sequence[str],
    folder: Path,
    threads: int,
    limit: float,
    environment: Mapping[str, str] | None = None,
) -> Use:
    """Run a command in a folder; what it says goes into `stdout` there.

    Args:
        command: The command.
        folder: Where.
        threads: Threads that libraries may take.
        limit: Wall time after which it is killed, s.
        environment: More environment variables.
    """
    surroundings = os.environ | dict.fromkeys(THREADS, str(threads)) | dict(environment or {})
    load, start = os.getloadavg()[0], time.perf_counter()
    with (folder / "stdout").open("w") as out:
        # a group of its own, so that the limit ends its children too
        process = subprocess.Popen(
            command, cwd=folder, stdout=out, stderr=out, env=surroundings, start_new_session=True
        )
        clock = Timer(limit, os.killpg, (process.pid, signal.SIGKILL))
        clock.start()
        _, status, used = os.wait4(process.pid, 0)
        clock.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    return Use(
        time.perf_counter() - start,
        used.ru_utime + used.ru_stime,
        used.ru_maxrss / 1024.0,
        load,
        process.returncode,
    )
