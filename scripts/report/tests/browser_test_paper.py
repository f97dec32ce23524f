# SPDX-License-Identifier: Apache-2.0
"""Figures 1 to 5 of the paper and datapaths side by side in a real browser; part of `make test-browser`."""

import json
from pathlib import Path

import numpy as np
import pytest

from model.dataflow.fixed import latency
from scripts.report import page as report
from scripts.report.tests.browser import AT, FITS, NARROW, STICKING_OUT, WIDE, across, show
from tb.sim.env import simulator

FIGURES = range(1, 6)
PAPER = "document.getElementById('paper').toDataURL()"
NOTE = "document.getElementById('paper-note').textContent"
CHOSEN = "[...document.querySelectorAll('#paper-choice button')].map((b) => b.ariaPressed === 'true').indexOf(true) + 1"

# Smallest distance of a drawn pixel from the edge of a canvas.
CLEAR = """((id) => {
    const canvas = document.getElementById(id);
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const pixels = copy.getImageData(0, 0, canvas.width, canvas.height).data;
    let least = Infinity;
    for (let i = 3; i < pixels.length; i += 4) {
        if (pixels[i]) {
            const [x, y] = [((i - 3) / 4) % canvas.width, Math.floor(i / 4 / canvas.width)];
            least = Math.min(least, x, y, canvas.width - 1 - x, canvas.height - 1 - y);
        }
    }
    return least;
})"""

# Drawn names and their boxes; subscripts (after _) are drawn separately and excluded.
NAMES = """(() => {
    const g = document.getElementById('paper').getContext('2d');
    const names = [];
    g.fillText = (text, x, y) => {
        const width = g.measureText(text).width;
        const left = g.textAlign === 'center' ? x - width / 2 : x;
        if (!g.font.startsWith('9.5px')) { names.push([text, left, y - 6, left + width, y + 6]); }
    };
    window.dispatchEvent(new Event('resize'));
    delete g.fillText;
    return names;
})()"""


def overlapping(names):
    return [
        (a[0], b[0])
        for i, a in enumerate(names)
        for b in names[:i]
        if a[1] < b[3] and b[1] < a[3] and a[2] < b[4] and b[2] < a[4]
    ]


def scrub(page, n):
    page.run(f"""(() => {{ const s = document.getElementById('scrub'); s.value = {n};
                 s.dispatchEvent(new Event('input')); }})()""")


# -- figures 1 to 5 --------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "scheme"), [(WIDE, "light"), (NARROW, "dark")], ids=str)
def test_each_figure_is_drawn_whole(written, browser, size, scheme):
    """Figures fit their canvas, names do not overlap, and every figure and target gives a different picture."""
    page = browser(written + "#target=0", size, prefers_color_scheme=scheme)
    pictures, drawn = set(), 0
    for name in ("reach", "overhead", "unequal_arms", "two_arms", "fold_in"):
        show(page, name)
        for figure in FIGURES:
            page.run(f"document.querySelectorAll('#paper-choice button')[{figure - 1}].click()")
            for n in (0, 66):
                scrub(page, n)
                assert page.run(f"{CLEAR}('paper')") >= 2, (name, figure, n)
                names = page.run(NAMES)
                assert len(names) >= 6 and overlapping(names) == [], (name, figure, n, names)
                pictures.add(page.run(PAPER))
                drawn += 1
        assert page.run(FITS) and page.run(STICKING_OUT) == []
    assert len(pictures) == drawn


def test_a_figure_is_chosen(written, browser):
    page = browser(written + "#target=20&figure=4")
    assert page.run(CHOSEN) == 4
    for figure in (2, 5):
        page.click(f"#paper-choice button:nth-child({figure})")
        assert page.run(CHOSEN) == figure and page.run(AT) == 20


def test_a_figure_turns_with_the_view(written, browser):
    page = browser(written + "#target=20")
    before = page.run(PAPER)
    x, y = page.middle("#paper")
    page.drag((x, y), (x + 80, y + 20))
    assert page.run(PAPER) != before
    page.click("#view")
    assert page.run(PAPER) == before


def test_a_figure_is_that_of_the_arm_that_is_looked_at(clip, browser):
    page = browser(clip + "#frame=10&figure=1")
    left, note = page.run(PAPER), page.run(NOTE)
    page.run("""(() => { const s = document.getElementById('arm'); s.value = '1';
                s.dispatchEvent(new Event('change')); })()""")
    assert page.run(PAPER) != left
    assert note == page.run(NOTE) and "85.9" in note, "both are asked for a swivel angle of 1.5 rad"
    for figure in FIGURES:
        page.click(f"#paper-choice button:nth-child({figure})")
        assert page.run(f"{CLEAR}('paper')") >= 2 and overlapping(page.run(NAMES)) == [], figure


JOINTS = """((id) => {
    const g = document.getElementById(id).getContext('2d');
    const found = [];
    g.arc = (x, y) => found.push([x, y]);
    window.dispatchEvent(new Event('resize'));
    delete g.arc;
    window.dispatchEvent(new Event('resize'));
    return found;
})"""


def test_a_figure_of_a_clip_stands_as_the_arm_does(clip, browser):
    """Both views show shoulder, elbow and wrist in the same directions, apart from perspective."""
    page = browser(clip + "#frame=10&figure=1")
    for arm in (0, 1):
        page.run(f"""(() => {{ const s = document.getElementById('arm'); s.value = '{arm}';
                     s.dispatchEvent(new Event('change')); }})()""")
        scene, paper = (np.array(page.run(f"{JOINTS}('{name}')")) for name in ("scene", "paper"))
        ours, theirs = scene[3 * arm : 3 * arm + 3], paper[:6:2]
        for a, b in ((0, 1), (1, 2), (0, 2)):
            ways = [(joints[b] - joints[a]) / np.linalg.norm(joints[b] - joints[a]) for joints in (ours, theirs)]
            assert ways[0] @ ways[1] > 0.97, (arm, a, b)


SINGULAR = (
    "0,0,0.5,1",
    "0.6,0,0,1",
    "0.59999,0,0,1",
    "0.000001,0,0.5,1",
    "0.27,0,0.33,0.0001",
    "0.6,0.6,0.1,1",
    "0,0,0,1",
)


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=str)
def test_next_to_singular_poses(fake, browser, size):
    page = browser(fake("x,y,z,phi\n" + "\n".join(SINGULAR) + "\n") + "#target=0", size)
    for n in range(len(SINGULAR)):
        scrub(page, n)
        for figure in (1, 2, 4):
            page.run(f"document.querySelectorAll('#paper-choice button')[{figure - 1}].click()")
            assert page.run(f"{CLEAR}('paper')") >= 2, (n, figure)


# -- both datapaths --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Write the report of an RTL run near singular poses on both datapaths; return its folder."""
    out = tmp_path_factory.mktemp("both")
    options = ["--trajectory", "fold_in", "--datapath", "lean,paper", "--sim", simulator(), "--out", str(out)]
    assert report.main(options) == 0
    return out


@pytest.mark.parametrize(("size", "scheme"), [(WIDE, "light"), (NARROW, "dark")], ids=str)
def test_both_are_shown_beside_each_other(both, browser, size, scheme):
    page = browser((both / "report.html").as_uri() + "#target=40", size, prefers_color_scheme=scheme)
    assert page.run(FITS) and page.run(STICKING_OUT) == []
    seen = "[...document.querySelectorAll('.badge')].filter((b) => b.clientHeight || b.offsetHeight)"
    named = page.run(f"{seen}.map((b) => [b.textContent, getComputedStyle(b).backgroundColor])")
    assert [text for text, _ in named] == ["lean", "paper"] * 4, "of target, score, errors, pipeline"
    assert len({tuple(each) for each in named}) == 2, "each has one colour"
    for canvas in ("hand", "angles", "pipeline"):
        first, second = (page.run(f"document.getElementById('{canvas}{k}').toDataURL()") for k in ("", "2"))
        assert first != second, canvas
    scores = {score["datapath"]: score for score in json.loads((both / "score.json").read_text())}
    for place, name in (("", "lean"), ("2", "paper")):
        table = page.run(f"document.getElementById('figures{place}').innerText")
        assert f"{scores[name]['hand_error_max']:.1e}" in table
        assert page.run(f"document.getElementById('verdict{place}').textContent") == scores[name]["outcome"]
        note = page.run(f"document.getElementById('pipeline-note{place}').textContent")
        assert f"leaves {scores[name]['latency_cycles']} clocks after" in note
    place = "document.getElementById('{}').getBoundingClientRect().x"
    left, right = (page.run(place.format(part)) for part in ("hand", "hand2"))
    assert (right > left) == (size[0] >= 900), "side by side where there is room"


def test_both_have_one_scale(both, browser):
    """Both runs have the same axis labels, for errors and for time."""
    page = browser((both / "report.html").as_uri() + "#target=50", WIDE)
    left = """((id) => {
        const copy = new OffscreenCanvas(60, 174).getContext('2d');
        copy.drawImage(document.getElementById(id), 0, 0);
        return copy.getImageData(0, 0, 60, 174).data.join();
    })"""
    below = """((id) => {
        const canvas = document.getElementById(id);
        const g = canvas.getContext('2d');
        const found = [];
        g.fillText = (text, x, y) => y > canvas.height - 30 && found.push(text);
        window.dispatchEvent(new Event('resize'));
        delete g.fillText;
        return found;
    })"""
    for plot, read in (("hand", left), ("angles", left), ("pipeline", below)):
        first, second = (page.run(f"{read}('{plot}{k}')") for k in ("", "2"))
        assert first == second and len(first) > 3, plot


def test_a_click_on_the_other_plots_goes_there(both, browser):
    page = browser((both / "report.html").as_uri() + "#target=0")
    for plot in ("#hand2", "#angles2"):
        page.press("Home")
        page.click(plot)
        assert abs(page.run(AT) - 99 * across(page, plot)) < 2, plot
    x, y = page.middle("#pipeline2")
    width = page.run("document.getElementById('pipeline2').clientWidth")
    clocks = latency("paper", 32) + 20  # 20 results are out
    left = x - width / 2 + 66 + (width - 80) * clocks / (clocks + 80)
    page.drag((left, y), (left, y))
    assert page.run(AT) in range(18, 23)


def test_files_of_both_are_named(both, browser):
    page = browser((both / "report.html").as_uri() + "#target=0")
    links = page.run("[...document.querySelectorAll('#files a')].map((a) => [a.textContent, a.href])")
    kinds = [("results (CSV)", "results.csv"), ("results (NumPy)", "results.npz")]
    expected = [(f"{name}: {kind}", both / name / file) for name in ("lean", "paper") for kind, file in kinds]
    expected.append(("score (JSON)", both / "score.json"))
    assert [(text, Path(href.removeprefix("file://"))) for text, href in links] == expected
    assert all(path.is_file() for _, path in expected)


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """Write the report of an RTL run on three datapaths, one of them fold; return its folder."""
    out = tmp_path_factory.mktemp("three")
    (out / "t.csv").write_text("x,y,z\n" + "".join(f"0.3,{n / 50},0.1\n" for n in range(20)))
    options = ["--trajectory", str(out / "t.csv"), "--datapath", "lean,fold,paper", "--sim", simulator()]
    assert report.main([*options, "--out", str(out)]) == 0
    return out


@pytest.mark.parametrize("size", [WIDE, (900, 700), NARROW], ids=str)
def test_three_machines(three, browser, size):
    page = browser((three / "report.html").as_uri() + "#target=10", size)
    assert page.run(FITS) and page.run(STICKING_OUT) == []
    named = page.run("""[...document.querySelectorAll('.badge')]
        .map((b) => [b.textContent, getComputedStyle(b).backgroundColor])""")
    assert [text for text, _ in named] == ["lean", "fold", "paper"] * 4, "of target, score, errors, pipeline"
    assert len({tuple(each) for each in named}) == 3, "each has one colour"
    scores = {score["datapath"]: score for score in json.loads((three / "score.json").read_text())}
    for place, name in (("", "lean"), ("2", "fold"), ("3", "paper")):
        assert page.run(f"document.getElementById('verdict{place}').textContent") == scores[name]["outcome"]
        assert page.run(f"document.getElementById('hand{place}').ariaLabel").endswith(f", {name}")
    assert page.run("new Set([...document.querySelectorAll('[id]')].map((e) => e.id)).size") == page.run(
        "document.querySelectorAll('[id]').length"
    ), "every name once"
