# SPDX-License-Identifier: Apache-2.0
"""Set-up of a fresh machine."""
