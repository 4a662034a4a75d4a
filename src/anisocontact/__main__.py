"""`python -m anisocontact` is the command `anisocontact`."""

import sys

from anisocontact.cli import command

if __name__ == "__main__":
    sys.exit(command())
