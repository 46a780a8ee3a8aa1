# SPDX-License-Identifier: Apache-2.0
"""The commands that the simulator adds to slipwise."""
