# SPDX-License-Identifier: Apache-2.0
"""Results as pandas data frames, where pandas is installed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from slipwise.errors import SlipwiseError
from slipwise.extras import to_install

if TYPE_CHECKING:
    import pandas as pd


def data_frame(columns: Mapping[str, ArrayLike]) -> pd.DataFrame:
    """Return a data frame of columns of the same length, in their order.

    Raises:
        SlipwiseError: pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError as problem:
        raise SlipwiseError(
            "a data frame needs pandas, which is not installed", advice=to_install("pandas")
        ) from problem
    return pd.DataFrame(dict(columns))
