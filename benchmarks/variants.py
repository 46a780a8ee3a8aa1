# SPDX-License-Identifier: Apache-2.0
"""Variants of the learner, each scored on real logs in a process of its own.

A variant changes settings, multiplies numbers of the core's settings, or multiplies constants of the sources
in a build of the core that reads their factors (`tuning_constants`).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise import _core
from slipwise.cli.progress import progress_bar

if TYPE_CHECKING:
    from replay_score import ReplayScore

WORKER = Path(__file__).resolve().with_name("variant_worker.py")
FACTORS = "SLIPWISE_TUNING"  # environment variable that the build with tuning constants reads


class VariantRefusedError(Exception):
    """The learner refuses what a variant asks for."""


@dataclass(frozen=True)
class Variant:
    """What is changed; nothing: the default."""

    name: str = "default"
    settings: Mapping[str, Any] = field(default_factory=dict)  # as in a settings file
    numbers: Mapping[str, float] = field(
        default_factory=dict
    )  # factors of the core's settings, by their path
    constants: Mapping[str, float] = field(default_factory=dict)  # factors of constants, as file.kName
    limits: bool = False  # look for limits of the actuator too


def score_variants(
    variants: Sequence[Variant], logs: Sequence[str], *, core: Path | None = None, workers: int = 2
) -> list[list[ReplayScore] | None]:
    """Score each variant on the logs, from commands and from wheels; None where the learner refuses it.

    Args:
        variants: what to score.
        logs: names of logs below SLIPWISE_DATA.
        core: the built core with tuning constants, for variants that change these; without it, the installed.
        workers: processes at a time.
    """
    return list(scored_variants(variants, logs, core=core, workers=workers))


def scored_variants(
    variants: Sequence[Variant], logs: Sequence[str], *, core: Path | None = None, workers: int = 2
) -> Iterator[list[ReplayScore] | None]:
    """Yield the scores of each variant, in this order, as soon as they are there."""
    with ThreadPoolExecutor(workers) as pool, progress_bar("variants") as progress:
        for k, scores in enumerate(pool.map(lambda variant: _score(variant, logs, core), variants)):
            progress(variants[k].name[:24], (k + 1) / len(variants))
            yield scores


def _score(variant: Variant, logs: Sequence[str], core: Path | None) -> list[ReplayScore] | None:
    from replay_score import ReplayScore

    if variant.constants and core is None:
        raise SystemExit(f"{variant.name} changes constants: that needs a build with tuning constants")
    job = {"variant": asdict(variant), "logs": list(logs), "core": str(core) if core else None}
    factors = ",".join(f"{name}={factor:.17g}" for name, factor in variant.constants.items())
    done = subprocess.run(
        [sys.executable, str(WORKER)],
        input=json.dumps(job),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {FACTORS: factors, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
    )
    if done.returncode == REFUSED:
        return None
    if done.returncode != 0:
        raise SystemExit(f"{variant.name} failed: {done.stderr.strip()[-800:]}")
    return [ReplayScore(**row) for row in json.loads(done.stdout)]


REFUSED = 3  # exit code of the worker


def scaled(settings: Any, path: str, factor: float) -> None:
    """Multiply a number, or a list of them, of the core's settings; whole ones stay whole and above 0."""
    *tables, name = path.split(".")
    parents = [settings]
    for table in tables:
        parents.append(getattr(parents[-1], table))
    value = getattr(parents[-1], name)
    if isinstance(value, int):
        value = max(1, round(value * factor))
    elif isinstance(value, float):
        value *= factor
    else:
        value = [each * factor for each in value]
    if isinstance(parents[-1], _core.MotionNoise):  # is made at once
        kept = {field: getattr(parents[-1], field) for field in NOISE_FIELDS}
        setattr(parents[-2], tables[-1], _core.MotionNoise(*(kept | {name: value}).values()))
    else:
        setattr(parents[-1], name, value)


NOISE_FIELDS = ("psd_time", "psd_motion", "fraction", "pose_std_xy", "pose_std_yaw")


def of_input(scores: Sequence[ReplayScore], name: str) -> list[ReplayScore]:
    """Return the scores of one input, "command" or "wheel"."""
    return [score for score in scores if score.input == name]
