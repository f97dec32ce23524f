# SPDX-License-Identifier: Apache-2.0
"""Moving arms: the reference axis, poses of whole arrays of targets."""
