# SPDX-License-Identifier: Apache-2.0
"""Where rollouts are computed: on the processor, or on a GPU, which is opened when it is first asked for."""

from __future__ import annotations

import functools

from slipwise import _core
from slipwise.errors import SettingsError

DEVICES = ("cpu", "cuda")


def gpu_of(device: str) -> _core.Gpu | None:
    """Return the GPU that `device` names, None for the processor.

    Raises:
        SettingsError: there is no such device, or rollouts cannot run there; it says why.
    """
    if device not in DEVICES:
        raise SettingsError(f"unknown device {device!r}", advice=f"known are {', '.join(DEVICES)}")
    return None if device == "cpu" else _open_gpu()


@functools.cache
def _open_gpu() -> _core.Gpu:
    if reason := _core.why_no_gpu():
        raise SettingsError("no GPU", where="device 'cuda'", advice=reason)
    return _core.Gpu()
