# SPDX-License-Identifier: Apache-2.0
"""What a log may show to be wrong with its robot's wiring: a class for each such thing, all in one list."""
