# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""Look in a notebook: learn from a file, read what was learned, and draw how sure a prediction is."""

# Each `# %%` is a cell: Jupyter (with jupytext), VS Code and PyCharm run them one by one, and show what
# stands in a cell's last line. The drive is simulated, so that nothing is needed but this file; with a log
# of your own, give its path to `sw.calibrate`.

# %%
from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import plotly.graph_objects as go

import slipwise as sw
from slipwise_sim import Scenario, simulate

folder = Path(tempfile.mkdtemp())
sw.save_log(simulate(Scenario(duration=150.0), seed=3).log, folder / "run.mcap")

# %% [markdown]
# Paths are taken as they are. The last line of the cell shows the summary, the verdict and the parameters.

# %%
result = sw.calibrate(folder / "run.mcap", input="command")
print(sw.summarise(result.model))
assert result.verdict.good
result  # noqa: B018 - a notebook shows it

# %% [markdown]
# One parameter by its physical name, with its standard deviation.

# %%
delay = result.model["delay_v"]
print(delay)
assert delay.identified
assert 0.1 < delay.value < 0.3

# %% [markdown]
# A predicted path with 95 % ellipses. With pandas, `path.to_dataframe()` gives it as a table.

# %%
commands = [(0.0, 1.0, 0.3), (3.0, 1.0, -0.3)]  # t [s], v [m/s], omega [rad/s]; each held until the next
path = sw.predict(result.model, commands, horizon=6.0)
drawn = path.plot()
assert len(drawn.data) > 1
drawn.write_html(folder / "path.html", include_plotlyjs="directory")
drawn  # noqa: B018 - a notebook shows it

# %% [markdown]
# How one number came about while the robot drove: the part of the yaw rate that slip takes away, with a band
# of two standard deviations.

# %%
history = result.history
assert history is not None
column = history.names.index("ang.w")
mean, std = history.mean[:, column], history.std[:, column]
band = np.concatenate((mean + 2.0 * std, (mean - 2.0 * std)[::-1]))
course = go.Figure(go.Scatter(x=history.t, y=mean, name="ang.w"))
course.add_scatter(x=np.concatenate((history.t, history.t[::-1])), y=band, fill="toself", name="2 std")
course.update_layout(xaxis_title="t [s]", yaxis_title="ang.w [-]", template="plotly_white")
assert std[-1] < std[0]
course  # noqa: B018 - a notebook shows it

# %% [markdown]
# The same report that `slipwise calibrate` writes.

# %%
print(f"report: {result.report(folder / 'report.html').name}")
assert (folder / "report.html").stat().st_size > 100_000
