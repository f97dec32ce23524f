# SPDX-License-Identifier: Apache-2.0
"""The Verilog headers say what the model says."""

import re

import pytest

from model.dataflow.datapaths import CONFIGURATIONS
from scripts.generate import headers


def test_headers_are_up_to_date():
    stale = [str(path.relative_to(headers.ROOT)) for path in headers.stale()]
    assert not stale, f"run `python -m scripts.generate.headers`: out of date are {stale}"


def test_a_changed_header_is_found(tmp_path, monkeypatch, capsys):
    changed = tmp_path / "ik_paper_nodes.vh"
    changed.write_text(headers.nodes_header("paper").replace("F_TMP1 = W - 4", "F_TMP1 = W - 5"))
    monkeypatch.setattr(headers, "ROOT", tmp_path)
    monkeypatch.setattr(headers, "HEADERS", {changed: lambda: headers.nodes_header("paper")})
    monkeypatch.setattr("sys.argv", ["headers", "--check"])
    assert headers.main() == 1
    assert capsys.readouterr().out == "out of date: ik_paper_nodes.vh\n"
    monkeypatch.setattr("sys.argv", ["headers"])
    assert headers.main() == 0 and not headers.stale()


def in_python(expression: str) -> str:
    """A Verilog expression as Python has it: ``a ? b : c``, nested in parentheses as well."""
    inner = re.compile(r"\(([^()]*)\)")
    groups: list[str] = []
    expression = expression.replace("||", " or ")
    while found := inner.search(expression):
        groups.append(_choice(found[1]))
        expression = expression.replace(found[0], f"<{len(groups) - 1}>", 1)
    expression = _choice(expression)
    while "<" in expression and re.search(r"<\d+>", expression):
        expression = re.sub(r"<(\d+)>", lambda m: f"({groups[int(m[1])]})", expression)
    return expression


def _choice(expression: str) -> str:
    if "?" not in expression:
        return expression
    condition, rest = expression.split("?", 1)
    yes, no = rest.split(":", 1)
    return f"({yes}) if ({condition}) else ({_choice(no)})"


@pytest.mark.parametrize(
    ("datapath", "header", "key"), [("lean", "lean", 100), ("lean16", "lean", 1100), ("paper", "paper", 0)]
)
def test_header_expressions_give_the_models_clocks(datapath, header, key):
    """The T_ expressions, evaluated as Verilog would, are the model's clocks at every word length."""
    text = headers.nodes_header(header)
    latencies = dict(re.findall(r"(\d+): datapath_latency = (\d+);", headers.latency_header()))
    for width, bits in headers.traced(datapath).items():
        values: dict[str, int] = {"W": width, "TILE": CONFIGURATIONS[datapath].tile}
        for line in text.splitlines():
            if not line.startswith("localparam integer "):
                continue
            for part in line.removeprefix("localparam integer ").split(";")[0].split(","):
                name, expression = part.split("=")
                values[name.strip()] = eval(in_python(expression), {"__builtins__": {}}, dict(values))
        for name, node in bits.nodes.items():
            assert values[f"T_{name.upper()}"] == node.time, f"W={width}: clock of {name}"
            if node.format.signed:
                assert values[f"F_{name.upper()}"] == node.format.frac, f"W={width}: fraction bits of {name}"
        leave = max(node.time for node in bits.nodes.values())
        assert values["T_OUT"] == leave == int(latencies[str(key + width)])
    assert width == CONFIGURATIONS[datapath].widths[-1]
