# SPDX-License-Identifier: Apache-2.0
"""What need not be covered, and why."""
