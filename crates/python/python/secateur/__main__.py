"""The program ``secateur``, as ``python -m secateur`` or by its name."""

import sys

from ._secateur import run_program


def main() -> int:
    """Runs the program with the words of the command line; gives its exit code."""
    return run_program(["secateur", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
