# SPDX-License-Identifier: Apache-2.0
"""Tests of ``ik_axi`` with a host at its registers and a memory at its bus port."""
