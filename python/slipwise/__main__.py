# SPDX-License-Identifier: Apache-2.0
"""The program `slipwise`, also as `python -m slipwise`."""

import signal


def main() -> None:
    """Run the command line and leave the process with its exit code."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # while modules load, Ctrl-C ends without a traceback
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from slipwise.cli.main import main as run

    signal.signal(signal.SIGINT, before)
    run()


if __name__ == "__main__":
    main()
