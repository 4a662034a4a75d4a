"""Files that a user names: whether they are there, and if not, why."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path


def why_no_file(path: Path) -> str:
    """What is wrong with a path that is to be a file.

    `Path.is_file` raises where the system refuses to look, as at a name that is too long.

    Args:
        path: The path.

    Returns:
        The end of a sentence about it; empty where it is a file.

    Example:
        >>> why_no_file(Path("nowhere.msh")), why_no_file(Path("."))
        ('does not exist', 'is a folder')
        >>> why_no_file(Path("m" * 300))
        'cannot be looked at: File name too long'
    """
    try:
        mode = os.stat(path).st_mode
    except ValueError:  # a name with a zero byte
        return "does not exist"
    except OSError as error:
        if error.errno in (errno.ENOENT, errno.ENOTDIR):
            return "does not exist"
        return f"cannot be looked at: {error.strerror}"
    if stat.S_ISDIR(mode):
        return "is a folder"
    return "" if stat.S_ISREG(mode) else "is no file"
