# SPDX-License-Identifier: Apache-2.0
"""Arms that move: the reference axis, poses of whole arrays of targets."""
