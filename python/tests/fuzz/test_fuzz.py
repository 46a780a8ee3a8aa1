# SPDX-License-Identifier: Apache-2.0
"""The fuzzers start from sound files, find what is no plain refusal, and count what they did."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest
from mutations import mutated
from seeds import TARGETS, seeds
from targets import NEVER_REFUSED, Target

ROOT = Path(__file__).parents[3]


def test_the_seeds_are_read_and_their_changes_are_read_or_refused(subtests: pytest.Subtests) -> None:
    for name in TARGETS:
        with subtests.test(name=name):
            target, corpus, draw = Target(name), seeds(name), random.Random(3)
            for seed in corpus:
                assert target.run(seed) == ""
            changed = [mutated(draw.choice(corpus), draw, corpus) for _ in range(15)]
            refused = sum(bool(target.run(data)) for data in changed)
            while (
                not refused and name not in NEVER_REFUSED and len(changed) < 60
            ):  # what comes by radio is read in spite of most damage
                changed.append(mutated(draw.choice(corpus), draw, corpus))
                refused += bool(target.run(changed[-1]))
            assert refused or name in NEVER_REFUSED
            assert sum(data not in corpus for data in changed) > 10


def test_the_same_seed_gives_the_same_changes() -> None:
    corpus = seeds("csv")
    first, second = ([mutated(corpus[0], random.Random(7), corpus) for _ in range(5)] for _ in range(2))
    assert first == second


@pytest.mark.slow
def test_an_input_that_is_no_plain_refusal_is_kept_and_fails(tmp_path: Path) -> None:
    script = (
        "import sys; sys.path.insert(0, sys.argv.pop(1))\n"
        "import fuzz_mutated, targets\n"
        "def broken(path): raise KeyError('no refusal')\n"
        "targets._READERS['settings'] = broken\n"
        "sys.exit(fuzz_mutated.main())"
    )
    arguments = ["settings", "30", "5", "1", str(tmp_path)]
    command = [sys.executable, "-c", script, str(ROOT / "fuzz"), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1, done
    assert "fuzz: settings: KeyError in <string>:3: 'no refusal'" in done.stdout
    assert "5 executions" in done.stdout
    (kept,) = tmp_path.iterdir()
    assert kept.name in done.stdout
