# SPDX-License-Identifier: Apache-2.0
"""A watcher's thread never makes the node wait, and its failure is no failure of the node."""

from __future__ import annotations

import threading

from slipwise.live.outputs import Note, Output
from slipwise.live.watch.terminal import OutputThread


def test_outputs_are_handled_in_their_order_before_it_closes() -> None:
    seen: list[Output] = []
    thread = OutputThread(seen.append, name="test")
    notes = [Note(float(i), "") for i in range(1000)]
    for note in notes:
        thread.put(note)
    assert thread.close(20.0)
    assert seen == notes
    thread.put(notes[0])
    assert thread.close()
    assert len(seen) == 1000


def test_what_finds_the_queue_full_is_left_out_and_counted() -> None:
    go = threading.Event()
    seen: list[Output] = []

    def slow(output: Output) -> None:
        go.wait(60.0)
        seen.append(output)

    thread = OutputThread(slow, name="test", capacity=10)
    for i in range(50):
        thread.put(Note(float(i), ""))
    assert 39 <= thread.left_out <= 40
    assert not thread.close(0.01)
    go.set()
    assert thread.close(20.0)
    assert len(seen) == 50 - thread.left_out


def test_a_handler_that_raises_is_not_called_again() -> None:
    calls = []

    def broken(output: Output) -> None:
        calls.append(output)
        raise ValueError("no")

    thread = OutputThread(broken, name="test")
    for i in range(5):
        thread.put(Note(float(i), ""))
    assert thread.close(20.0)
    assert len(calls) == 1
    assert str(thread.failure) == "no"


def test_rest_is_called_without_outputs_too() -> None:
    rested = threading.Event()
    thread = OutputThread(lambda _: None, name="test", rest=rested.set)
    assert rested.wait(30.0)
    assert thread.close(20.0)
