# SPDX-License-Identifier: Apache-2.0
"""Examples of the core in use."""
