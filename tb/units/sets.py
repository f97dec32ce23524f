# SPDX-License-Identifier: Apache-2.0
"""cocotb side of :func:`tb.units.unit.runs`: the tests of each instance of the generated top.

IK_SETS maps instances to module and function of their bench, and their parameters. A test gets its instance as ``dut``
and is named after it.
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


for _instance, (_file, _function, _parameters) in json.loads(os.environ["IK_SETS"]).items():
    for _name, _test in getattr(importlib.import_module(_file), _function)(**_parameters).items():
        globals()[f"{_instance}.{_name}"] = cocotb.test(name=f"{_instance}.{_name}")(_on(_instance, _test))
