# SPDX-License-Identifier: Apache-2.0
"""cocotb side of :func:`tb.units.unit.run_unit`: the tests of a bench, for every instance of the generated top.

IK_BENCH names the file and function of the bench; IK_SETS maps instances to their parameters. A test gets its instance
as ``dut`` and is named after it. IK_FLAT skips the tests that access module internals.
"""

import importlib
import json
import os

import cocotb


def _on(instance: str, test):
    """Return the test bound to an instance of the top."""

    async def narrowed(top):
        await test(dut=getattr(top, instance))

    return narrowed


_file, _, _function = os.environ["IK_BENCH"].partition(":")
_bench = getattr(importlib.import_module(_file), _function)
for _instance, _parameters in json.loads(os.environ["IK_SETS"]).items():
    for _name, _test in _bench(**_parameters).items():
        if os.environ["IK_FLAT"] and hasattr(_test, "inside"):
            continue
        _title = f"{_instance}.{_name}"
        globals()[_title] = cocotb.test(name=_title)(_on(_instance, _test))
