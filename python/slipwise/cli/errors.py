# SPDX-License-Identifier: Apache-2.0
"""Turns whatever ends a command into an exit code and at most one line on stderr."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Callable

import typer

from slipwise.addresses import masked
from slipwise.errors import SlipwiseError
from slipwise.stop_signals import Interrupt

BAD_USE = 2
_UsageError = typer.BadParameter.__mro__[1]  # typer's own copy of click, or click: wherever this typer has it


def exit_code_of(command: Callable[[], int], *, debug: bool) -> int:
    """Run a command; return its exit code, or 2 after one line that says what went wrong."""
    _make_streams_safe()
    with Interrupt() as interrupt:
        try:
            code = command()
            sys.stdout.flush()
            return code
        except typer.Exit as exit_request:
            return int(exit_request.exit_code)
        except BrokenPipeError:
            silence_stdout()
            return 0
        except OSError as error:
            silence_stdout()
            return _report(error, debug=debug)
        except (Exception, KeyboardInterrupt) as error:
            # a library may turn the interrupt into an error of its own
            return _report(KeyboardInterrupt() if interrupt.asked else error, debug=debug)


def _report(error: BaseException, *, debug: bool) -> int:
    if debug:
        traceback.print_exception(error)
    print(f"slipwise: {line_for(error)}", file=sys.stderr)
    return BAD_USE


def line_for(error: BaseException) -> str:
    """Return the one line that a user sees, without what addresses keep secret."""
    return masked(_line_for(error))


def _line_for(error: BaseException) -> str:
    if isinstance(error, SlipwiseError):
        line = str(error)
    elif isinstance(error, (KeyboardInterrupt, typer.Abort)):
        line = "stopped by the user; no half-written file is left"
    elif isinstance(error, MemoryError):
        line = "out of memory: use a shorter log, or a machine with more memory"
    elif isinstance(error, OSError) and error.strerror:
        line = f"{error.strerror} ({error.filename or 'stdout'}): check the path and the disk"
    elif isinstance(error, _UsageError):
        line = _usage_line(error)
    else:
        name, text = type(error).__name__, str(error)
        line = (
            f"unexpected {name}{f': {text}' if text else ''}; this is a fault of slipwise, please report it"
            " with what `slipwise --debug ...` prints"
        )
    return printable(" ".join(line.split()))


def printable(text: str) -> str:
    """Return the text with control characters replaced: text from a log must not steer a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def silence_stdout() -> None:
    """Stop writing when the reader is gone, as in `slipwise ... | head`."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)


def _usage_line(error: BaseException) -> str:
    """Return what typer says, and where help is."""
    message = error.format_message().rstrip(".").replace("Value error, ", "")  # type: ignore[attr-defined]
    context = error.ctx  # type: ignore[attr-defined]
    command = context.command_path if context is not None else "slipwise"
    return f"{message}: see `{command} --help`"


def _make_streams_safe() -> None:
    """Print to nowhere where a stream is closed, and never fail on a character that a terminal lacks."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: PTH123, SIM115 - for the whole process
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: PTH123, SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
