"""The command line: ``sweep``, or ``python -m gronwall``."""

import signal
import sys

from . import _native


def main() -> int:
    """Run ``sweep`` with the arguments of this process; its exit code."""
    # Python looks at an interrupt when the call returns: the program is to end at once.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.sweep(["sweep", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
