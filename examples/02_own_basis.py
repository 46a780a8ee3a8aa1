# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""A slip basis of one's own: write its terms, learn them, and compare with the bases that ship."""

# A basis says what slip may depend on: a list of terms for each of the forward (lon), sideways (lat) and
# angular (ang) slip rates. Each term becomes one learned number. Here the yaw slip grows with the yaw rate
# and, separately, with the sideways acceleration V*w.

# %%
from __future__ import annotations

import slipwise as sw
from slipwise_sim import Scenario, simulate

log = simulate(Scenario(duration=150.0), seed=4).log
settings = sw.make_settings(
    {
        "basis": "custom",
        "terms": {"lon": ["V", "V*abs(w)"], "lat": ["V*w"], "ang": ["w", "w*abs(V)"]},
    }
)

# %% [markdown]
# The same keys can stand in a TOML file, which `slipwise calibrate --settings FILE` reads.

# %%
result = sw.calibrate(log, input="command", settings=settings)
names = [parameter.name for parameter in result.model.content.parameters]
print(", ".join(names))
assert names[:5] == ["lon.V", "lon.V*abs(w)", "lat.V*w", "ang.w", "ang.w*abs(V)"]

# %% [markdown]
# Is it better than what ships? `evaluate` predicts every window with every method from what was known
# before it.

# %%
options = sw.EvaluationOptions(horizons=(2.0,), methods=("none", "edd-2", "custom", "auto"))
evaluation = sw.evaluate(log, input="command", settings=settings, options=options)
for score in evaluation.scores:
    mean = score.position
    print(f"{score.method:8} {mean.mean:.3f} m  (95 %: {mean.low:.3f} to {mean.high:.3f})")
assert evaluation.score("custom", 2.0).position.mean < 0.5 * evaluation.score("none", 2.0).position.mean

# %% [markdown]
# A term that does not vanish for a parked robot is refused, and the message says what to write instead.

# %%
wrong = sw.make_settings({"basis": "custom", "terms": {"lon": ["sgn(V)"]}})
try:
    sw.calibrate(log, settings=wrong)
except sw.SlipwiseError as error:
    message = str(error)
else:
    message = "accepted"
print(message)
assert "parked" in message
