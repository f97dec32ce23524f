# SPDX-License-Identifier: Apache-2.0
"""The cocotb side of :func:`tb.units.unit.run_unit`: a bench, once for every instance of the generated top.

IK_BENCH names the bench, IK_SETS maps instances to their parameters.  A bench reads its parameters when it is loaded,
so it is loaded once for each instance; its tests get that instance as ``dut``, and are named after it.
"""

import functools
import importlib.util
import json
import os


def _on(instance: str, parameters: str, test):
    """The test function with the instance in place of the top, and its parameters."""

    @functools.wraps(test)
    async def narrowed(top, **options):
        os.environ["IK_PARAMETERS"] = parameters
        await test(getattr(top, instance), **options)

    return narrowed


for _instance, _parameters in json.loads(os.environ["IK_SETS"]).items():
    os.environ["IK_PARAMETERS"] = json.dumps(_parameters)  # for the bench as it is loaded
    _spec = importlib.util.find_spec(os.environ["IK_BENCH"])
    _bench = importlib.util.module_from_spec(_spec)
    _bench.__name__ = f"{os.environ['IK_BENCH'].rpartition('.')[2]}[{_instance}]"
    _spec.loader.exec_module(_bench)
    for _name, _test in vars(_bench).items():
        if hasattr(_test, "generate_tests"):
            _test.func = _on(_instance, json.dumps(_parameters), _test.func)
            globals()[f"{_instance}.{_name}"] = _test
