# SPDX-License-Identifier: Apache-2.0
"""The dataflow graphs and schedules show the design as it is; without graphviz, which only draws them."""

import re
from dataclasses import replace
from html import unescape
from xml.etree import ElementTree

import pytest

from model.dataflow.datapaths import DATAPATHS
from model.io.words import RESULT_FIELDS
from scripts.console import InputError
from scripts.pages import figures, flow, graphs
from scripts.pages.flow import KINDS, design, kind

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def both():
    return figures.designs()


@pytest.fixture
def nodes(both):
    return both["paper"]


@pytest.fixture(scope="module")
def files(both):
    return {figure.name: figure for figure in figures.figures(both)}


def is_current(figure, text):
    """Whether a picture is of the figure: a graph by the digest that it carries."""
    if figure.text.startswith("digraph"):
        return text.startswith(f"<!-- of the graph {graphs.digest(figure.text)} -->")
    return text == figure.text


def test_figures_and_page_are_up_to_date(both, files):
    stale = [f.name for f in files.values() if not f.path.exists() or not is_current(f, f.path.read_text("utf-8"))]
    assert not stale, f"run `make figures`: out of date are {stale}"
    assert figures.PAGE.read_text("utf-8") == figures.page(both), "run `make figures`"
    assert sorted(figures.FOLDER.iterdir()) == sorted(figure.path for figure in files.values())
    assert sum(figure.path.stat().st_size for figure in files.values()) < 1_500_000


def test_a_changed_design_is_found(both, nodes, files):
    fmt = nodes["tmp1"].format
    changed = nodes | {"tmp1": replace(nodes["tmp1"], format=replace(fmt, frac=fmt.frac - 1))}
    other = {f.name for f in figures.figures({**both, "paper": changed}) if f.text != files[f.name].text}
    named = {"graph_p_e_x", "graph_paper", "graph_paper_elbow", "schedule_p_e_x", "schedule_paper"}
    assert named <= other and not any("lean" in name for name in other)
    assert not is_current(replace(files["graph_paper"], text="digraph {}"), files["graph_paper"].path.read_text())


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_every_node_and_operand_is_drawn(both, files, datapath):
    nodes = both[datapath]
    arrows = {f"{o}->{n.name}" for n in nodes.values() for o in flow.operands(n, nodes)}
    drawn = ElementTree.parse(files[f"graph_{datapath}"].path)
    groups = [(g.get("class"), g.find(f"{SVG}title").text) for g in drawn.iter(f"{SVG}g") if g.get("class")]
    assert {unescape(title) for what, title in groups if what == "node"} == set(nodes)
    assert {unescape(title) for what, title in groups if what == "edge"} == arrows
    schedule = ElementTree.fromstring(files[f"schedule_{datapath}"].text)
    assert len(list(schedule.iter(f"{SVG}g"))) == len(nodes)
    for name in DATAPATHS[datapath].sections:
        own = {n for n, v in nodes.items() if v.section == name}
        if len(own) > 1:
            graph = files[f"graph_{datapath}_{name}"].text
            assert own <= set(re.findall(r'^  "(\w+)" \[label', graph, re.M)), name


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_a_box_has_name_equation_format_and_section(both, files, datapath):
    graph, nodes = files[f"graph_{datapath}"].text, both[datapath]
    for name, node in nodes.items():
        (line,) = re.findall(rf'^  "{name}" \[label=.*', graph, re.M)
        assert f"<b>{name}</b>" in line and flow.q(node.format) in line
        assert f"&#160;{node.equation}<br/>" in line if node.equation else "&#160;" not in line
        assert f"{KINDS[kind(node)]}" in line and flow.declared(node.format) in line.partition("tooltip")[2]
    colours = {v.section: set() for v in nodes.values() if v.operands}
    for name, node in nodes.items():
        if node.operands:
            colours[node.section] |= set(re.findall(rf'^  "{name}" .*fillcolor="(#\w+)"', graph, re.M))
    assert all(len(of) == 1 for of in colours.values()) and len(set.union(*colours.values())) == len(colours)


def test_no_font_below_9_pixels_and_nothing_from_elsewhere(files):
    for figure in files.values():
        text = figure.path.read_text()
        sizes = re.findall(r"(?:font-size:|font:)(\d+)px|font-size=\"([\d.]+)\"", text)
        assert min(float(a or b) for a, b in sizes) >= 9, figure.name
        assert not re.search(r"href=|<script|/work|/tmp", text), figure.name


@pytest.mark.parametrize(("datapath", "width"), [("lean", 32), ("lean", 18), ("paper", 32)])
def test_longest_path_takes_the_whole_latency(datapath, width):
    """Without a gap."""
    nodes = design(datapath, width)
    path = flow.longest_path(nodes)
    assert path[0].op == "input" and path[0].time == 0 and path[-1].name in RESULT_FIELDS
    assert path[-1].time == max(n.time for n in nodes.values())
    for before, after in zip(path, path[1:], strict=False):
        assert before.time == flow.start(after, width), after.name


def test_delays_are_consumer_minus_operand(nodes):
    waits = flow.delays(nodes, out=318)
    assert (waits["inf_pp"].begin, waits["inf_pp"].end, waits["inf_pp"].bits) == (96, 140, 32)
    assert waits["inf_pp"].flip_flops == 44 * 32
    assert waits["qe_w"].end == 318 and "qs_w" not in waits


def test_a_negative_delay_names_the_node(nodes):
    early = nodes | {"tmp_sqr": replace(nodes["tmp_sqr"], time=nodes["tmp_sqr"].time - 1)}
    with pytest.raises(ValueError, match="node tmp_sqr: starts 1 clocks before its operand tmp1 is ready"):
        figures.figures({"paper": early})


def test_a_missing_format_names_the_node(nodes):
    with pytest.raises(ValueError, match="node c3: no format"):
        figures.figures({"paper": nodes | {"c3": replace(nodes["c3"], format=None)}})


def test_a_missing_operand_names_both(nodes):
    with pytest.raises(ValueError, match="node flat: its operand tmp1 is no node"):
        figures.figures({"paper": {k: v for k, v in nodes.items() if k not in ("tmp1", "tmp_sqr")}})


@pytest.fixture
def drawn(monkeypatch):
    """A stand-in for graphviz."""
    monkeypatch.setattr(figures, "svg", lambda graph: f"<svg>{graphs.digest(graph)}</svg>")


def test_any_node_from_the_command_line(drawn, tmp_path, capsys):
    assert figures.main(["--node", "pi_inv", "--out", str(tmp_path)]) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["graph_pi_inv.svg", "schedule_pi_inv.svg"]
    assert figures.main(["--datapath", "lean", "--node", "pi_inv", "--out", str(tmp_path)]) == 2
    assert "no node pi_inv" in capsys.readouterr().err


def test_a_node_that_does_not_fit_is_named(drawn, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(figures.ranges, "failures", lambda width: {"pi_inv": f"pi_inv does not fit, W = {width}"})
    assert figures.main(["--node", "pi_inv", "--out", str(tmp_path)]) == 1
    assert capsys.readouterr().err == "pi_inv does not fit, W = 32\n"


def test_without_graphviz_one_line(monkeypatch):
    monkeypatch.setattr(graphs.shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="dot is missing"):
        graphs.svg("digraph {}")
