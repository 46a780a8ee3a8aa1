# SPDX-License-Identifier: Apache-2.0
"""What an address keeps secret is shown nowhere."""

from __future__ import annotations

import json
import sys

import pytest

from slipwise.addresses import masked, shown
from slipwise.cli.command_line import command_line
from slipwise.cli.document import head
from slipwise.cli.errors import line_for
from slipwise.errors import LogError

SECRET = "https://me:pass@example.org/logs/a.mcap?X-Amz-Signature=abc&key=def"


def test_an_address_is_shown_without_user_password_and_signature() -> None:
    assert shown(SECRET) == "https://example.org/logs/a.mcap"
    assert masked(f"cannot read '{SECRET}': no") == "cannot read 'https://example.org/logs/a.mcap': no"
    assert masked("s3:/key:secret@bucket/a.csv and b.csv") == "s3://bucket/a.csv and b.csv"
    assert masked("nothing: here // at all") == "nothing: here // at all"


def test_arguments_and_errors_give_no_secret_away(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["slipwise", "calibrate", SECRET, f"--poses={SECRET}", "--json", "-"])
    for text in (json.dumps(head("calibrate")), command_line(), line_for(LogError("no", where=SECRET))):
        assert "example.org/logs/a.mcap" in text
        assert not [secret for secret in ("pass", "abc", "def") if secret in text]
