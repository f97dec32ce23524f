# SPDX-License-Identifier: Apache-2.0
"""A .venv that is a link: what it leads to belongs to somebody else."""

import pytest

from scripts.setup import bootstrap


def test_a_linked_environment_is_left_alone(tmp_path, capsys):
    other = tmp_path / "other"
    other.mkdir()
    (other / "kept").touch()
    root = tmp_path / "checkout"
    root.mkdir()
    (root / ".venv").symlink_to(other)
    with pytest.raises(SystemExit) as stopped:
        bootstrap.Setup(str(root)).make_venv()
    assert stopped.value.code == 2 and (other / "kept").exists()
    assert capsys.readouterr().err == (
        f"cga-ik: .venv is a link to {other}, which set-up will not overwrite: remove the link\n"
    )
