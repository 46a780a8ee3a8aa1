# SPDX-License-Identifier: Apache-2.0
"""The command that the thesis adds to slipwise."""
