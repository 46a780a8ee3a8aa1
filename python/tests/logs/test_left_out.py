# SPDX-License-Identifier: Apache-2.0
"""What is left out is added up by kind and reason, in the order in which it was met."""

from slipwise.logs.left_out import Tally


def test_equal_reasons_are_added_up_and_keep_their_first_place() -> None:
    tally = Tally()
    tally.add("jump", "poses that jump", count=2, where="line 7")
    tally.add("stamp", "stamps that go backward", count=1, where="line 3")
    tally.add("jump", "poses that jump", count=3, where="line 90")
    jump, stamp = tally.result()
    assert (jump.kind, jump.count, jump.where) == ("jump", 5, "line 7")
    assert (stamp.kind, stamp.count, stamp.where) == ("stamp", 1, "line 3")


def test_one_kind_with_two_reasons_is_two_entries() -> None:
    tally = Tally()
    tally.add("jump", "alone", count=1, where="line 1")
    tally.add("jump", "for good", count=1, where="line 2")
    assert [entry.reason for entry in tally.result()] == ["alone", "for good"]


def test_nothing_counts_for_nothing() -> None:
    tally = Tally()
    tally.add("jump", "poses that jump", count=0, where="line 7")
    tally.add("jump", "poses that jump", count=-1, where="line 8")
    assert tally.result() == ()
    tally.add("jump", "poses that jump", count=1, where="line 9")
    assert tally.result()[0].where == "line 9"
