# SPDX-License-Identifier: Apache-2.0
"""Scores one variant of the learner (`variants`) on some logs: JSON in, JSON out."""

from __future__ import annotations

import importlib.util
import json
import sys
from dataclasses import asdict
from typing import Any


def use_core(path: str) -> None:
    """Take the built core at a path for that of slipwise, which must not have been imported."""
    spec = importlib.util.spec_from_file_location("slipwise._core", path)
    if spec is None or spec.loader is None:
        raise SystemExit(f"{path} is no built core")
    module = importlib.util.module_from_spec(spec)
    sys.modules["slipwise._core"] = module
    spec.loader.exec_module(module)


def scores_of(job: dict[str, Any]) -> list[dict[str, Any]]:
    """Score the job's variant on its logs.

    Raises:
        VariantRefusedError: the learner refuses what the variant asks for.
    """
    from data_sets import data_folder, data_sets, input_names
    from replay_score import replay_score
    from variants import VariantRefusedError, scaled

    import slipwise
    from slipwise.calibration.core_settings import core_settings
    from slipwise.calibration.settings import make_settings

    variant, found = job["variant"], []
    chosen = [data for data in data_sets(data_folder()) if data.name in job["logs"]]
    for data in chosen:
        log = slipwise.open_log(data.path)
        for name in input_names(log):
            try:
                core = core_settings(make_settings(variant["settings"]), name, (data.horizon,))
                for path, factor in variant["numbers"].items():
                    scaled(core, path, factor)
                found.append(replay_score(data, log, core, limits=variant["limits"]))
            except (ValueError, slipwise.SlipwiseError) as problem:
                raise VariantRefusedError(str(problem)) from problem
    return [asdict(score) for score in found if score is not None]


def main() -> int:
    """Do the job on stdin."""
    job = json.load(sys.stdin)
    if job["core"]:
        use_core(job["core"])
    from variants import REFUSED, VariantRefusedError

    try:
        json.dump(scores_of(job), sys.stdout)
    except VariantRefusedError as problem:
        print(problem, file=sys.stderr)
        return REFUSED
    return 0


if __name__ == "__main__":
    sys.exit(main())
