# SPDX-License-Identifier: Apache-2.0
"""Rivals of the rollout kernel: the same exact steps with the same slip in numpy, numba, JAX and casadi."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]
#: From commands v, omega [K, N] to the last x, y, yaw [3, N].
Rival = Callable[[Floats, Floats], Floats]

CURVATURE_SPEED = 0.01  # m/s, as in the core


def slip_tangent(p: Floats, v: Any, omega: Any, dt: float) -> tuple[Any, Any, Any]:
    """Return forward, left and turn of one step; p is [3, 5]: kappa, V, kappa V, kappa^2, V^2 per channel."""
    kappa = omega * v / (v * v + CURVATURE_SPEED**2)
    features = (kappa, v, kappa * v, kappa * kappa, v * v)
    slip = [sum(float(p[c, i]) * features[i] for i in range(5)) for c in range(3)]
    return (v + slip[0]) * dt, slip[1] * dt, (omega + slip[2]) * dt


def numpy_rival(p: Floats, dt: float) -> Rival:
    """All rollouts of one period at once, float32, exact steps."""
    kind = np.float32

    def roll(v: Floats, omega: Floats) -> Floats:
        x, y, yaw = (np.zeros(v.shape[1], kind) for _ in range(3))
        for k in range(len(v)):
            forward, left, turn = (np.asarray(a, kind) for a in slip_tangent(p, v[k], omega[k], kind(dt)))
            a, b = arc(turn)
            c, s = np.cos(yaw), np.sin(yaw)
            dx, dy = a * forward - b * left, b * forward + a * left
            x, y, yaw = x + c * dx - s * dy, y + s * dx + c * dy, yaw + turn
        return np.stack((x, y, yaw))

    return roll


def arc(turn: Any) -> tuple[Any, Any]:
    """Return sin(f)/f and (1 - cos(f))/f of a small turn, by their series."""
    q = turn * turn
    return 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0)), turn / 2.0 * (
        1.0 - q / 12.0 * (1.0 - q / 30.0)
    )


def numba_rival(p: Floats, dt: float) -> Rival:
    """One rollout after the other in compiled loops, float32, one core."""
    import numba

    fraction = p.astype(np.float32)
    step, speed = np.float32(dt), np.float32(CURVATURE_SPEED**2)
    one, half, sixth, twelfth = (np.float32(x) for x in (1.0, 0.5, 1 / 6, 1 / 12))
    twentieth, thirtieth = np.float32(1 / 20), np.float32(1 / 30)

    @numba.njit  # type: ignore[untyped-decorator, unused-ignore]
    def roll(v: Floats, omega: Floats) -> Floats:
        periods, rollouts = v.shape
        result = np.zeros((3, rollouts), np.float32)
        cosine, sine = np.ones(rollouts, np.float32), np.zeros(rollouts, np.float32)
        for k in range(periods):
            for n in range(rollouts):
                a, w = v[k, n], omega[k, n]
                e = w * a / (a * a + speed)
                f0, f1, f2, f3, f4 = e, a, e * a, e * e, a * a
                x = (
                    a
                    + fraction[0, 0] * f0
                    + fraction[0, 1] * f1
                    + fraction[0, 2] * f2
                    + fraction[0, 3] * f3
                    + fraction[0, 4] * f4
                ) * step
                y = (
                    fraction[1, 0] * f0
                    + fraction[1, 1] * f1
                    + fraction[1, 2] * f2
                    + fraction[1, 3] * f3
                    + fraction[1, 4] * f4
                ) * step
                t = (
                    w
                    + fraction[2, 0] * f0
                    + fraction[2, 1] * f1
                    + fraction[2, 2] * f2
                    + fraction[2, 3] * f3
                    + fraction[2, 4] * f4
                ) * step
                q = t * t
                arc_a = one - q * sixth * (one - q * twentieth)
                arc_b = t * half * (one - q * twelfth * (one - q * thirtieth))
                along, across = arc_a * cosine[n] - arc_b * sine[n], arc_a * sine[n] + arc_b * cosine[n]
                result[0, n] += along * x - across * y
                result[1, n] += across * x + along * y
                result[2, n] += t
                cosine[n], sine[n] = cosine[n] - t * across, sine[n] + t * along
        return result

    return roll  # type: ignore[no-any-return, unused-ignore]


def jax_rival(p: Floats, dt: float) -> Rival:
    """A jitted scan over periods, float32, on the CPU."""
    import jax
    import jax.numpy as jnp

    def one(state: Any, command: Any) -> tuple[Any, None]:
        x, y, yaw = state
        forward, left, turn = slip_tangent(p, command[0], command[1], dt)
        a, b = arc(turn)
        c, s = jnp.cos(yaw), jnp.sin(yaw)
        dx, dy = a * forward - b * left, b * forward + a * left
        return (x + c * dx - s * dy, y + s * dx + c * dy, yaw + turn), None

    @jax.jit
    def roll(v: Any, omega: Any) -> Any:
        zero = jnp.zeros(v.shape[1], jnp.float32)
        return jnp.stack(jax.lax.scan(one, (zero, zero, zero), (v, omega))[0])

    return lambda v, omega: np.asarray(roll(v, omega).block_until_ready())


def casadi_rival(p: Floats, dt: float, shape: tuple[int, int]) -> Rival:
    """`mapaccum` over periods and `map` over rollouts of one symbolic step, double."""
    import casadi

    state, command = casadi.SX.sym("state", 3), casadi.SX.sym("command", 2)
    forward, left, turn = slip_tangent(p, command[0], command[1], dt)
    a, b = arc(turn)
    c, s = casadi.cos(state[2]), casadi.sin(state[2])
    dx, dy = a * forward - b * left, b * forward + a * left
    after = casadi.vertcat(state[0] + c * dx - s * dy, state[1] + s * dx + c * dy, state[2] + turn)
    periods, rollouts = shape
    mapped = casadi.Function("step", [state, command], [after]).mapaccum(periods).map(rollouts)

    def roll(v: Floats, omega: Floats) -> Floats:
        flat = np.stack((v.T.ravel(), omega.T.ravel()))  # rollout after rollout
        every = np.array(mapped(np.zeros((3, rollouts)), flat))
        return every[:, periods - 1 :: periods]

    return roll
