# SPDX-License-Identifier: Apache-2.0
"""Fuzzes every reader for some seconds: `make fuzz ARGS=60`, `make fuzz ARGS="60 mcap --executions 1000"`.

Where atheris is installed, half of the time of each target is guided by the code that inputs reach; the other
half mutates the seeds at random. Inputs that are findings go to build/fuzz/findings.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
from pathlib import Path

from seeds import TARGETS

HERE = Path(__file__).resolve().parent
MEMORY = 2 << 30  # bytes of address space for a target
FINDINGS = HERE.parent / "build" / "fuzz" / "findings"


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seconds", nargs="?", type=float, default=30.0, help="for each target; default 30")
    parser.add_argument("targets", nargs="*", help=f"of {', '.join(TARGETS)}; default all")
    parser.add_argument("--executions", type=int, default=10**9, help="stop a target after so many")
    parser.add_argument("--seed", type=int, default=1, help="of the mutations")
    parser.add_argument("--unguided", action="store_true", help="mutate at random alone")
    return parser.parse_args()


def main() -> int:
    """Run the targets one after the other; return 1 if there is a finding."""
    asked = arguments()
    unknown = set(asked.targets) - set(TARGETS)
    if unknown:
        print(
            f"fuzz: no target {', '.join(sorted(unknown))}; known are {', '.join(TARGETS)}", file=sys.stderr
        )
        return 2
    guided = not asked.unguided and importlib.util.find_spec("atheris") is not None
    ways = ("fuzz_mutated.py", "fuzz_guided.py") if guided else ("fuzz_mutated.py",)
    FINDINGS.mkdir(parents=True, exist_ok=True)
    failed = False
    for target in asked.targets or TARGETS:
        for way in ways:
            options = [
                target,
                str(asked.seconds / len(ways)),
                str(asked.executions),
                str(asked.seed),
                str(FINDINGS),
            ]
            done = subprocess.run([sys.executable, str(HERE / way), *options], check=False)
            failed = failed or done.returncode != 0
    print(f"fuzz: {'findings are in ' + str(FINDINGS) if failed else 'no finding'}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
