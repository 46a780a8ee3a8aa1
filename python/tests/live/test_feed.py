# SPDX-License-Identifier: Apache-2.0
"""A feed delivers all it has, and stops where it is when it is closed."""

from __future__ import annotations

import threading
from collections.abc import Iterator

from slipwise.live.feed import Feed
from slipwise.live.samples import Sample, Wheels


def test_all_samples_are_delivered_in_order_and_then_it_is_finished() -> None:
    samples: list[Sample] = [Wheels(float(k), 0.5, 0.0) for k in range(100)]
    taken: list[Sample] = []
    feed = Feed(samples)
    assert not feed.finished
    feed.subscribe(taken.append)
    feed.close()  # waits for the thread, which may be stopped before the end
    assert taken == samples[: len(taken)]
    assert feed.finished is (taken == samples)


def test_an_endless_feed_is_stopped() -> None:
    asked = threading.Event()

    def endless() -> Iterator[Sample]:
        while True:
            asked.set()
            yield Wheels(0.0, 0.5, 0.0)

    feed = Feed(endless())
    feed.subscribe(lambda _: None)
    assert asked.wait(10.0)
    feed.close()
    feed.close()
    assert not feed.finished
