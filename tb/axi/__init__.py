# SPDX-License-Identifier: Apache-2.0
"""From memory to memory: ``ik_axi`` with registers and memory around it."""
