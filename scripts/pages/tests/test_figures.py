# SPDX-License-Identifier: Apache-2.0
"""The dataflow graphs and schedules show the design as it is."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from model.targets.words import RESULT_FIELDS
from scripts.pages import figures
from tb.sim.env import ROOT

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def nodes():
    return figures.design()


@pytest.fixture(scope="module")
def files():
    return figures.figures()


def test_figures_and_page_are_up_to_date(files):
    stale = [str(p.relative_to(ROOT)) for p, text in files.items() if not p.exists() or p.read_text("utf-8") != text]
    assert not stale, f"run `make figures`: out of date are {stale}"
    assert sorted(figures.FOLDER.iterdir()) == sorted(p for p in files if p.suffix == ".svg")
    assert sum(p.stat().st_size for p in files) < 1_500_000


def test_a_changed_design_is_found(nodes, files):
    fmt = nodes["tmp1"].format
    changed = nodes | {"tmp1": replace(nodes["tmp1"], format=replace(fmt, frac=fmt.frac - 1))}
    other = [p.name for p, text in figures.figures(changed).items() if text != files[p]]
    assert "dataflow.svg" in other and "dataflow_p_e_x.svg" in other and "schedule.svg" in other


def test_every_node_and_operand_is_drawn(nodes, files):
    graph = ElementTree.fromstring(files[figures.FOLDER / "dataflow.svg"])
    assert {g.get("id") for g in graph.iter(f"{SVG}g")} == set(nodes)
    arrows = sum("marker-end" in p.attrib for p in graph.iter(f"{SVG}path"))
    assert arrows == sum(len({o.name for o in n.operands if o.name}) for n in nodes.values())
    for group in graph.iter(f"{SVG}g"):
        assert group.find(f"{SVG}title").text.startswith(group.get("id"))
    schedule = ElementTree.fromstring(files[figures.FOLDER / "schedule.svg"])
    assert len(list(schedule.iter(f"{SVG}g"))) == len(nodes)


def test_boxes_do_not_overlap(files):
    for path, text in files.items():
        if not path.name.startswith("dataflow"):
            continue
        boxes = re.findall(r'<rect class="b \w+" x="([\d.-]+)" y="([\d.-]+)"', text)
        columns: dict[str, list[float]] = {}
        for x, y in boxes:
            columns.setdefault(x, []).append(float(y))
        for ys in columns.values():
            ys.sort()
            gaps = [low - high for high, low in zip(ys, ys[1:], strict=False)]
            assert all(g >= figures.BOX_H for g in gaps), path.name


def test_no_font_below_9_pixels_and_nothing_from_elsewhere(files):
    for path, text in files.items():
        if path.suffix == ".svg":
            assert min(float(s) for s in re.findall(r"(?:font-size:|font:)(\d+)px", text)) >= 9, path.name
            assert not re.search(r"href|<script|/work|/tmp", text), path.name


def test_critical_path_takes_the_whole_latency(nodes):
    path = figures.critical_path(nodes)
    assert nodes[path[0]].op == "input" and path[-1] in RESULT_FIELDS
    assert nodes[path[-1]].time == max(n.time for n in nodes.values())
    for a, b in zip(path, path[1:], strict=False):
        assert nodes[a].time == figures.start(nodes[b])


def test_delays_are_consumer_minus_operand(nodes):
    waits = figures.delays(nodes, out=318)
    assert (waits["inf_pp"].begin, waits["inf_pp"].end, waits["inf_pp"].bits) == (96, 140, 32)
    assert (waits["inf_pp"].flag, waits["inf_pp"].flip_flops) == (174, 44 * 32 + 78)
    assert waits["qe_w"].end == 318 and "qs_w" not in waits


def test_a_negative_delay_names_the_node(nodes):
    early = nodes | {"tmp_sqr": replace(nodes["tmp_sqr"], time=nodes["tmp_sqr"].time - 1)}
    with pytest.raises(ValueError, match="node tmp_sqr: starts 1 clocks before its operand tmp1 is ready"):
        figures.figures(early)


def test_a_missing_format_names_the_node(nodes):
    with pytest.raises(ValueError, match="node c3: no format"):
        figures.figures(nodes | {"c3": replace(nodes["c3"], format=None)})


def test_a_missing_operand_names_both(nodes):
    with pytest.raises(ValueError, match="node flat: its operand tmp1 is no node"):
        figures.figures({k: v for k, v in nodes.items() if k not in ("tmp1", "tmp_sqr")})


def test_any_node_from_the_command_line(tmp_path, capsys):
    assert figures.main(["--node", "pi_inv", "--out", str(tmp_path)]) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dataflow_pi_inv.svg", "schedule_pi_inv.svg"]
    assert figures.main(["--node", "pi_ind", "--out", str(tmp_path)]) == 2
    assert "no node pi_ind" in capsys.readouterr().err


def test_a_node_that_does_not_fit_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(figures.ranges, "failures", lambda width: {"pi_inv": f"pi_inv does not fit, W = {width}"})
    assert figures.main(["--node", "pi_inv", "--out", str(tmp_path)]) == 1
    assert capsys.readouterr().err == "pi_inv does not fit, W = 32\n"
