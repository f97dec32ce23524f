# SPDX-License-Identifier: Apache-2.0
"""Tests of ``ik_axi``. The benches act as the host at its register port and as the memory at its memory port."""
