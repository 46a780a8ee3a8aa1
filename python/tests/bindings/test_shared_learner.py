# SPDX-License-Identifier: Apache-2.0
"""Threads may share a learner: its long methods release the interpreter's lock, and take turns."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np

from slipwise import _core


def recording(begin: float) -> _core.Recording:
    t = begin + np.arange(0.0, 60.0, 0.05)
    v, omega = 0.5 + 0.3 * np.sin(t), 0.4 * np.sin(0.7 * t)
    yaw = np.cumsum(0.045 * omega)
    x, y = np.cumsum(0.0475 * v * np.cos(yaw)), np.cumsum(0.0475 * v * np.sin(yaw))
    inputs = np.column_stack([t, v, np.zeros(len(t)), omega])
    poses = np.column_stack([t, x, y, yaw, np.zeros(len(t))])
    return _core.Recording(inputs, inputs, np.zeros((0, 3)), poses)


def after(*begins: float) -> bytes:
    learner = _core.MotionLearner(_core.LearnerSettings())
    for begin in begins:
        learner.push(recording(begin))
    return bytes(learner.save())


def test_threads_that_push_and_read_at_once_take_turns() -> None:
    learner = _core.MotionLearner(_core.LearnerSettings())
    problems: list[BaseException] = []
    pushed = threading.Event()

    def keep_on(work: Callable[[], object]) -> None:
        try:
            while not pushed.is_set():
                work()
        except BaseException as problem:
            problems.append(problem)

    reads: tuple[Callable[[], object], ...] = (
        learner.model,
        learner.odometry,
        learner.surfaces,
        lambda: learner.newest,
        lambda: _core.MotionLearner.load(learner.save()),
    )
    readers = [threading.Thread(target=keep_on, args=(work,)) for work in reads]
    pushers = [threading.Thread(target=learner.push, args=(recording(begin),)) for begin in (0.0, 100.0)]
    for thread in (*readers, *pushers):
        thread.start()
    for thread in pushers:
        thread.join()
    pushed.set()
    for thread in readers:
        thread.join()
    assert not problems
    assert bytes(learner.save()) in (after(0.0, 100.0), after(100.0, 0.0))
