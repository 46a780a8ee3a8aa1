# SPDX-License-Identifier: Apache-2.0
"""A feed delivers all it has, and stops where it is when it is closed."""

from __future__ import annotations

import threading
from collections.abc import Iterator

from slipwise.live.feed import Feed
from slipwise.live.samples import Sample, Wheels


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
