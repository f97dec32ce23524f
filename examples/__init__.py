# SPDX-License-Identifier: Apache-2.0
"""Examples. A package, as cocotb-coverage installs one of this name, which would be found first otherwise."""
