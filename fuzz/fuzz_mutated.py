# SPDX-License-Identifier: Apache-2.0
"""Fuzzes one reader with random changes of its seeds: TARGET SECONDS EXECUTIONS SEED FOLDER."""

from __future__ import annotations

import faulthandler
import hashlib
import random
import resource
import signal
import sys
import time
import traceback
from pathlib import Path

from mutations import mutated
from run_fuzz import MEMORY
from seeds import seeds
from targets import Target

SLOWEST = 60.0  # s of one input, then the process is ended
MOST_FINDINGS = 10


def main() -> int:
    """Run until time or executions are up; return 1 where something was found."""
    name, seconds, executions, seed, folder = sys.argv[1:6]
    faulthandler.enable()
    target, corpus, draw = Target(name), seeds(name), random.Random(int(seed))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    began, count, read, found = time.monotonic(), 0, 0, set()
    pending = Path(folder) / f"{name}-pending"
    while (
        time.monotonic() - began < float(seconds) and count < int(executions) and len(found) < MOST_FINDINGS
    ):
        data = mutated(draw.choice(corpus), draw, corpus)
        pending.write_bytes(data)  # what a crash or a hang leaves behind
        signal.setitimer(signal.ITIMER_PROF, SLOWEST)  # processor time: being paused is no hang
        try:
            read += not target.run(data)
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            fault = f"{type(error).__name__} in {Path(where.filename).name}:{where.lineno}"
            if fault not in found:
                found.add(fault)
                path = Path(folder) / f"{name}-{hashlib.sha256(data).hexdigest()[:12]}"
                path.write_bytes(data)
                print(
                    f"fuzz: {name}: {fault}: {' '.join(str(error).split())[:150]} ({path.name})", flush=True
                )
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        count += 1
    pending.unlink(missing_ok=True)
    rate = count / max(time.monotonic() - began, 1e-9)
    print(f"fuzz: {name}: {count} executions ({rate:.0f}/s), {read} read, {len(found)} findings", flush=True)
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
