# SPDX-License-Identifier: Apache-2.0
"""Coverage waivers and their reasons."""
