# SPDX-License-Identifier: Apache-2.0
"""examples/icebreaker at its pins: a serial line from a kept cocotb extension, and the host script itself."""
