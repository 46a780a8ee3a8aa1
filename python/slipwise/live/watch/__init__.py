# SPDX-License-Identifier: Apache-2.0
"""What shows or keeps the outputs of the live node: a page, the terminal."""
