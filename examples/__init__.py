# SPDX-License-Identifier: Apache-2.0
"""Examples. A package, because cocotb-coverage installs one of the same name, which would otherwise take precedence."""
