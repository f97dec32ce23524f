# SPDX-License-Identifier: Apache-2.0
"""Test the playground in headless Chromium: its cores equal the model, and its controls work."""

import gzip
import json

import numpy as np
import pytest

from model.dataflow import fixed
from model.io import stimuli, trajectories
from model.io.flags import expected_flags
from model.io.words import FIELDS, Targets, from_words, to_words
from model.reference.joints import wrap
from model.reference.kinematics import conjugate, multiply, rotate
from model.reference.lean_equations import solve_lean
from scripts.conftest import FITS, NARROW, SET, STICKING_OUT, WIDE, Page
from scripts.playground import __main__ as playground
from scripts.playground.__main__ import Machine
from scripts.waves import read
from tb.sim.env import ROOT
from tb.sim.native_run import nodes_of

BUILT = [Machine("lean", 32), Machine("fold", 32)]
EVERY = [m if m in BUILT else pytest.param(m, marks=pytest.mark.slow) for m in playground.MACHINES]
"""All cores. Those not in BUILT, tested by ``make test-browser ONLY=core``, take minutes to compile."""
FLOW = "document.querySelector('button[data-flow={}]').click()"
MACHINE = "playground.ui.machines[0]"
LEAN = fixed.latency("lean", 32)

RESET = f"""(async () => {{
    const {{ ui, state, first }} = playground;
    {FLOW.format("step")};
    Object.assign(ui.target, first.target);
    Object.assign(state.view, first.view);
    for (const name of ['ready', 'dense']) if (!ui[name]) document.getElementById(name).click();
    const values = {{ axis: 'z', trajectory: '', zoom: 80, second: '', machine: 'lean-W32' }};
    for (const [name, value] of Object.entries(values)) {SET}(name, value);
    await new Promise((done) => setTimeout(done));
}})()"""


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Write the page with the cores of BUILT; return its path."""
    out = tmp_path_factory.mktemp("playground")
    assert playground.main(["--datapath", "lean,fold", "--width", "32", "--out", str(out)]) == 0
    return out / "index.html"


@pytest.fixture(scope="session")
def loaded(written, chromium):
    """Load the page once for all tests."""
    page = Page(chromium, *WIDE).open(written.as_uri())
    page.wait_for("document.documentElement.dataset.ready")
    page.run("playground.first = structuredClone({ target: playground.ui.target, view: playground.state.view })")
    return page


@pytest.fixture
def page(loaded):
    """Return the page with the lean core, stopped, and all controls in their initial states."""
    loaded.resize(*WIDE)
    loaded.run(RESET)
    yield loaded
    assert loaded.problems == []


def step(page, clocks):
    page.run(f"(() => {{ for (let k = 0; k < {clocks}; k++) {FLOW.format('step')}; }})()")


def rows_of(name):
    """Return a trajectory's rows: x, y, z, phi, d1, d2. The page scales each row separately."""
    return next(trajectory["rows"] for trajectory in playground.data([])["trajectories"] if trajectory["name"] == name)


def bits(node):
    return [int(word) & ((1 << node.format.width) - 1) for word in node.value.tolist()]


def assert_answers(answers, words, width, datapath):
    """Assert that results and flags of the core equal the model's; return the model's run."""
    model = fixed.run(words, width, datapath)
    assert [answer["result"] for answer in answers] == model.results.tolist()
    assert [answer["flags"] for answer in answers] == model.flags.tolist()
    return model


@pytest.mark.parametrize("machine", EVERY, ids=lambda machine: machine.name)
def test_every_core_equals_the_model(page, browser, tmp_path, machine):
    """Results, flags, latency and all nodes equal the model's for 200 targets from trajectories and hard cases."""
    width = machine.width
    built_in = [to_words(trajectories.make(name), width)[0][::10] for name in trajectories.TRAJECTORIES]
    words = np.concatenate([*built_in, stimuli.mixed(200, width, seed=15)])[:200]
    if machine not in BUILT:
        parts = ["--datapath", machine.datapath, "--width", str(width), "--out", str(tmp_path)]
        assert playground.main(parts) == 0
        page = browser((tmp_path / "index.html").as_uri())
    answers = page.run(f"playground.answer('{machine.name}', {json.dumps(words.tolist())})")
    model = assert_answers(answers, words, width, machine.datapath)
    assert {answer["latency"] for answer in answers} == {fixed.latency(machine.datapath, width)}
    for name, node in model.nodes.items():
        assert [int(answer["nodes"][name], 16) for answer in answers] == bits(node), name


def test_double_precision(page):
    """The page's solutions and flags in double precision equal the model's."""
    words = stimuli.mixed(400, 32, seed=17)
    answers = page.run(f"{json.dumps(words.tolist())}.map((words) => playground.solve(words, 32))")
    asked = from_words(words, 0, 32, "mixed")
    exact = solve_lean(*(getattr(asked, name) for name in FIELDS))
    for of, parts in (("qs", "wijk"), ("qe", "wi")):
        ours = np.array([answer[of] for answer in answers])
        theirs = np.column_stack([exact[f"{of}_{part}"] for part in parts])
        same_sign = np.sign((ours * theirs).sum(axis=1))  # at k = 0 either sign is right
        assert np.abs(ours * same_sign[:, None] - theirs).max() < 1e-12
    bit = {flag["name"]: flag["bit"] for flag in playground.data([])["flags"]}
    flags = [sum(bit[name] for name, on in answer["flag"].items() if on) for answer in answers]
    assert flags == expected_flags(words, 32).tolist()


@pytest.mark.parametrize("width", [18, 24, 32])
def test_words_equal_the_model(page, width):
    random = np.random.default_rng(18)
    lengths = 10.0 ** random.uniform(-2, 2, (300, 2))
    position = random.uniform(-0.9, 0.9, (300, 3)) * lengths.sum(axis=1)[:, None]
    rows = np.column_stack([position, random.uniform(-9, 9, 300), lengths])
    targets = [dict(zip(FIELDS, row, strict=True)) for row in rows.tolist()]
    answers = page.run(f"{json.dumps(targets)}.map((target) => playground.toWords(target, {width}))")
    for row, answer in zip(rows, answers, strict=True):
        words, exponent = to_words(Targets("one", *row), width)
        assert (answer["words"], answer["exponent"], answer["fits"]) == (words[0].tolist(), exponent, True)


def test_every_axis_gives_the_hand_its_target(page):
    """The wrist is at the target in the user's frame for every axis, while the quaternions differ."""
    seen = set()
    for axis in playground.data([])["axes"]:
        page.choose("axis", axis)
        step(page, LEAN + 2)
        run = page.run("(({ wrist, qs, one }) => ({ wrist, qs, place: one.place }))(playground.state.runs[0].now)")
        assert np.allclose(run["wrist"], run["place"], atol=1e-8), axis
        seen.add(tuple(np.round(run["qs"], 6)))
    assert len(seen) == 6


WRIST = """(() => {
    const { state, ui, camera } = playground;
    const part = state.parts[0];
    const box = document.getElementById('scene').getBoundingClientRect();
    const [x, y] = camera(part.w, part.h, state.bounds, state.view).project([ui.target.x, ui.target.y, ui.target.z]);
    return [box.x + part.x + x, box.y + part.y + y];
})()"""
PLACE = "[playground.ui.target.x, playground.ui.target.y, playground.ui.target.z]"


@pytest.mark.parametrize("touch", [False, True])
def test_the_wrist_follows_the_pointer(page, touch):
    """The wrist ends where the pointer was released, and the core has solved that target."""
    page.run(FLOW.format("run"))
    page.middle("#scene")
    start = page.run(WRIST)
    end = [start[0] - 60, start[1] - 45]
    page.drag(start, end, touch=touch)
    assert np.allclose(page.run(WRIST), end, atol=3)
    page.wait_for(f"String(playground.state.runs[0].now.one.place) === String({PLACE})")
    assert page.run("playground.state.runs[0].now.hand") < 2e-8
    assert page.run("document.documentElement.dataset.flow") == "run"


def test_the_background_turns_the_view_and_keys_move_the_wrist(page):
    x, y = page.middle("#scene")
    before, view = page.run(PLACE), page.run("playground.state.view.azimuth")
    page.drag((x - 250, y - 150), (x - 150, y - 150))
    assert page.run(PLACE) == before
    assert abs(page.run("playground.state.view.azimuth") - view + 1.0) < 0.1
    page.run("document.getElementById('scene').focus()")
    for key in ("ArrowLeft", "ArrowUp", "PageUp"):
        page.press(key)
    assert (np.array(page.run(PLACE)) != before).all()
    page.run("document.activeElement.blur()")
    page.press("Space")
    assert page.run("document.documentElement.dataset.flow") == "run"


ANGLES = "[...document.getElementById('angles').rows].map((row) => [row.className, row.cells[1].textContent])"
RING = """((ring, i) => {
    const box = document.getElementById('scene').getBoundingClientRect();
    const { state, rings, viewOf } = playground;
    const [x, y] = rings(viewOf(state.parts[0]))[ring][i].at;
    return [box.x + state.parts[0].x + x, box.y + state.parts[0].y + y];
})"""
NOW = "(({ joints, branch, one }) => [joints.map(({ at }) => at), branch, one.words, one.turn])"
NOW += "(playground.state.runs[0].now)"


@pytest.mark.parametrize("touch", [False, True])
@pytest.mark.parametrize("name", playground.ARMS)
def test_the_hand_turns_and_the_joints_follow(page, name, touch):
    """Dragging a ring or pressing keys turns the hand about the ring's axis; the hand's point stays. The joint angles
    equal those of `Arm.solve` in double precision. They are within the limits if this is possible in any branch, and
    the page marks joints beyond their limits."""
    arm = playground.ARMS[name]
    page.choose("robot", name)
    step(page, LEAN + 2)
    assert not any(over for over, _ in page.run(ANGLES)), "an arm starts within its limits"
    page.choose("phi", -2.8)
    page.run(FLOW.format("run"))
    page.middle("#scene")
    before, turns = page.run("playground.pointOf(playground.place(), playground.ui.target.turn)"), []
    for ring in range(3):
        turns.append(page.run("playground.ui.target.turn"))
        start, end = page.run(f"[8, 14].map((i) => {RING}({ring}, i))")
        page.drag(start, end, touch=touch)
        by = multiply(conjugate(np.array(turns[-1])), np.array(page.run("playground.ui.target.turn")))
        assert 0.2 < 2 * abs(by[1 + ring]) < 1.5 and np.abs(np.delete(by[1:], ring)).max() < 1e-9, "another axis"
    page.run("document.getElementById('scene').focus()")
    for key in ("ArrowRight", "PageUp"):
        page.press(f"Shift+{key}")
    assert np.allclose(page.run("playground.pointOf(playground.place(), playground.ui.target.turn)"), before, atol=1e-9)
    page.wait_for("String(playground.state.runs[0].now.one.turn) === String(playground.ui.target.turn)")
    page.run(FLOW.format("step"))
    joints, branch, words, turn = page.run(NOW)
    asked = from_words(np.array([words]), 0, 32, "page")
    place = rotate(arm.mount, asked.position * (arm.d1 + arm.d2) / asked.reach) + arm.base
    point = place + np.linalg.norm(arm.tool) * rotate(np.array(turn), (0.0, 0.0, 1.0))
    pose = arm.solve(point, turn, asked.phi, branch=branch)
    assert np.abs(wrap(pose.joints[0] - joints)).max() < 2e-8
    shown = page.run(ANGLES)
    degrees = [float(text.replace("\N{MINUS SIGN}", "-").rstrip("\N{DEGREE SIGN}")) for _, text in shown]
    assert degrees == pytest.approx(np.degrees(joints), abs=0.051)
    assert [bool(over) for over, _ in shown] == pose.over_limit[0].tolist()
    assert page.run("document.getElementById('branch').textContent") == f"branch {branch}"
    every = [arm.solve(point, turn, asked.phi, branch=other).over_limit.any() for other in range(8)]
    assert pose.over_limit.any() == all(every)


@pytest.mark.parametrize(("x", "z", "flag"), [(0.7, 0, "too_far"), (0, 0.4, "on_axis")])
def test_flags_are_shown(page, x, z, flag):
    page.run(f"Object.assign(playground.ui.target, {{ x: {x}, y: 0, z: {z} }})")
    step(page, LEAN + 2)
    assert page.run("[...document.querySelectorAll('#flags .on')].map((e) => e.textContent)") == [flag]
    assert page.run("playground.state.runs[0].now.flags === playground.state.runs[0].now.owed")


def test_a_receiver_that_stalls_loses_nothing(page):
    """Credits run out and the input stalls; afterwards every result is correct and in order."""
    page.choose("trajectory", "reach")
    start = page.run(f"{MACHINE}.sent")
    page.run("document.getElementById('ready').click()")
    step(page, 150)
    places = page.run(f"{MACHINE}.places")
    assert page.run(f"Number({MACHINE}.live('g_fifo.u_credits.credits'))") == 0
    assert page.run(f"{MACHINE}.sent") - start == places == page.run(f"{MACHINE}.flying.length")
    page.run("document.getElementById('ready').click()")
    page.run("document.getElementById('dense').click()")
    page.run(f"playground.seen = {MACHINE}.flying.map((one) => one)")
    step(page, places + 2)
    seen = page.run("playground.seen.map(({ words, result, flags }) => ({ words, result, flags }))")
    words = np.array([one["words"] for one in seen])
    assert words.tolist() == [to_words(Targets("one", *row), 32)[0][0].tolist() for row in rows_of("reach")[:places]]
    assert_answers(seen, words, 32, "lean")
    assert page.run(f"{MACHINE}.lost") == 0


def test_a_target_is_followed_through_its_nodes(page):
    """The table shows the model's word of each node the target has passed; a click on the pipeline shows a node."""
    cells = "[...document.getElementById('column').rows].map((row) => [1, 3].map((k) => row.cells[k].textContent))"
    step(page, 10)
    model = fixed.run(np.array([page.run("playground.ui.followed.words")]), 32, "lean").nodes
    for clocks in (10, LEAN):
        shown = {name: [int(word, 16)] for name, word in page.run(cells) if word}
        assert shown == {name: bits(node) for name, node in model.items() if node.time < clocks}
        step(page, LEAN - clocks)
    page.middle("#lane")
    x, y = page.run("""(() => {
        const box = document.getElementById('lane').getBoundingClientRect();
        const { ui, laneX } = playground;
        const node = ui.machines[0].nodes.find(({ name }) => name === 'k_law');
        const at = laneX(ui.laid, box.width);
        return [box.x + (at(node.time) + at(node.time + 1)) / 2, box.y + ui.laid.yOf(node) + 4];
    })()""")
    page.drag((x, y), (x, y))
    assert page.run("playground.ui.watched.at(-1)").endswith("k_law")
    assert [int(page.run("document.querySelectorAll('#node dd')[5].textContent"), 16)] == bits(model["k_law"])


@pytest.mark.parametrize("machine", BUILT, ids=lambda machine: machine.name)
def test_the_vcd_holds_every_node(page, tmp_path, machine):
    """All nodes of all targets in the VCD equal the model's. The VCD is read as `make follow` reads it."""
    page.choose("machine", machine.name)
    page.wait_for(f"document.documentElement.dataset.ready === '{machine.name}'")
    page.choose("trajectory", "overhead")
    page.run(f"{MACHINE}.frames.length = 0")
    step(page, 200)
    (tmp_path / "waves.vcd").write_text(page.run("playground.vcd()"))
    nodes = nodes_of(machine.datapath, machine.width)
    recording = read(tmp_path / "waves.vcd", machine.datapath, nodes)
    assert len(recording.admitted) == (200 if machine.datapath == "lean" else 3)
    inputs = {node.name: node for node in nodes if node.kind == "input"}
    last = 200 - fixed.latency(machine.datapath, machine.width)
    whole = [n for n, clock in enumerate(recording.admitted) if clock < last]
    half = 1 << (machine.width - 1)
    words = np.array([[(int(recording.word(inputs[f], n), 2) ^ half) - half for f in FIELDS] for n in whole])
    asked = [to_words(Targets("one", *row), machine.width)[0][0] for row in rows_of("overhead")]
    assert words.tolist() == [asked[n % len(asked)].tolist() for n in whole] and whole
    for name, node in fixed.run(words, machine.width, machine.datapath).nodes.items():
        assert [int(recording.word(node, n), 2) for n in whole] == bits(node), name


def test_signals_are_shown_and_hidden(page):
    step(page, 5)
    wide = page.picture("waves")
    page.choose("zoom", "20")
    assert page.picture("waves") != wide
    for there in (True, False):
        page.choose("watch", "g_fifo.u_credits.u_fifo.wr_ptr")
        assert page.run("playground.ui.watched.includes('g_fifo.u_credits.u_fifo.wr_ptr')") == there


def test_two_cores_side_by_side(page):
    """Both cores give the same words, each after its own latency."""
    page.choose("second", "fold-W32")
    page.wait_for("document.documentElement.dataset.ready === 'lean-W32 fold-W32'")
    page.run(FLOW.format("run"))
    page.wait_for("playground.state.runs.length === 2 && playground.state.runs.every((run) => run.now)")
    page.run(FLOW.format("step"))
    first, second = page.run("playground.state.runs.map(({ now: { one } }) => [one.words, one.result, one.latency])")
    assert first[:2] == second[:2] and [first[2], second[2]] == [LEAN, fixed.latency("fold", 32)]


@pytest.mark.parametrize("size", [WIDE, (900, 700), NARROW], ids=str)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_page_fits(page, size, scheme):
    page.resize(*size, color_scheme=scheme)
    step(page, 50)
    assert page.run(FITS)
    scrolls = STICKING_OUT.replace(".map(", ".filter((e) => !e.closest('.wide, .scrolls')).map(")
    assert page.run(scrolls) == []
    unnamed = """[...document.querySelectorAll('input, select, button, canvas, [tabindex]')]
        .filter((e) => !(e.labels?.length || e.ariaLabel || e.textContent.trim() || e.getAttribute('aria-labelledby')))
        .map((e) => e.id)"""
    assert page.run(unnamed) == [], "everything has a name for a screen reader"


def test_without_webassembly_the_page_reports_it(written, browser):
    opened = browser("about:blank").open(written.as_uri(), before="delete window.WebAssembly")
    assert "no WebAssembly" in opened.text("status")


def test_page_is_one_file(written, page):
    """The page loads no other file and contains no local path. Each core takes less than 1 MiB."""
    assert page.requests == [written.as_uri()]
    assert str(ROOT) not in written.read_text(encoding="utf-8")
    for machine in BUILT:
        packed = playground.wasm(machine)  # gzipped
        assert len(packed) < 2**20 and str(ROOT).encode() not in gzip.decompress(packed)
