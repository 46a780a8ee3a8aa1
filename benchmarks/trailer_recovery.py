# SPDX-License-Identifier: Apache-2.0
"""How true the hitch offset, length and slip that `examples/10_trailer.py` learns are, over many drives.

Each drive has commands and noise of its own: white, or lasting for a second, both in what pushes robot and
trailer and in what is measured of them. The filter is told their size and takes both to be white.

    python benchmarks/trailer_recovery.py --drives 40
"""

from __future__ import annotations

import argparse
import runpy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.dynamics import learn_dynamics

Floats = NDArray[np.float64]

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "10_trailer.py"
NOISES = {"white": 0.0, "lasting 1 s": 1.0}  # s
HORIZON = 2.0  # s, over which held-out predictions are judged


@dataclass(frozen=True)
class Recovery:
    """What one drive told."""

    error: Floats  # [parameters] learned minus true
    std: Floats  # [parameters] as reported
    hitch: tuple[float, float]  # rad, held-out error of the hitch angle, and with the parameters as given


def recover(example: dict[str, Any], seed: int, correlated: float, seconds: float) -> Recovery:
    """Learn from one drive."""
    drive = example["towed_drive"](seed, seconds, correlated)
    learned = learn_dynamics(example["TRAILER"], *drive, horizons=(HORIZON,))
    score = learned.scores[-1]
    place = score.names.index("hitch")
    return Recovery(
        np.array([learned[name].value - truth for name, truth in example["TRUTH"].items()]),
        np.array([learned[name].std for name in example["TRUTH"]]),
        (score.error[place], score.given_error[place]),
    )


def print_table(noise: str, names: list[str], drives: list[Recovery]) -> None:
    """Print how far off each parameter was, and how far it was said to be."""
    error, std = (np.array([getattr(d, field) for d in drives]) for field in ("error", "std"))
    z = np.abs(error / std)
    print(
        f"\n{noise}, {len(drives)} drives\n\n| parameter | rms error | mean sigma | rms z | within 3 sigma |"
    )
    print("|---|---|---|---|---|")
    for k, name in enumerate(names):
        print(
            f"| {name} | {np.sqrt(np.mean(error[:, k] ** 2)):.4f} | {std[:, k].mean():.4f} "
            f"| {np.sqrt(np.mean(z[:, k] ** 2)):.2f} | {np.sum(z[:, k] <= 3.0)} |"
        )
    learned, given = np.sqrt(np.mean(np.square([d.hitch for d in drives]), axis=0))
    print(f"\nhitch angle {HORIZON:g} s ahead: {learned:.4f} rad, {given:.4f} with the parameters as given")


def main() -> None:
    """Drive, learn and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--drives", type=int, default=40, help="for each kind of noise")
    parser.add_argument("--seconds", type=float, default=120.0, help="of each drive")
    arguments = parser.parse_args()
    example = runpy.run_path(str(EXAMPLE))
    for noise, correlated in NOISES.items():
        drives = [recover(example, seed, correlated, arguments.seconds) for seed in range(arguments.drives)]
        print_table(noise, list(example["TRUTH"]), drives)


if __name__ == "__main__":
    main()
