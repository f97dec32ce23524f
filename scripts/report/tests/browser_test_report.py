# SPDX-License-Identifier: Apache-2.0
"""Test the report in headless Chromium. `make test-browser` installs Chromium and runs this; `make test` does not."""

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.io import trajectories
from model.io.files import format_csv
from model.motion.tests import figure
from scripts.conftest import FITS, LATENCY, NARROW, STICKING_OUT, WIDE, without_rtl
from scripts.report import __main__ as report
from scripts.report.tests.test_page import data_in
from tb.sim.env import simulator as simulator_name

NAMES = list(trajectories.TRAJECTORIES)
SIZES = [(WIDE, "light"), ((900, 700), "light"), (NARROW, "dark"), ((320, 600), "dark")]
AT = "Number(document.documentElement.dataset.target)"
FRAME = "Number(document.documentElement.dataset.frame)"
BADGES = """[...document.querySelectorAll('.badge')].filter((b) => b.clientHeight || b.offsetHeight)
    .map((b) => [b.textContent, getComputedStyle(b).backgroundColor])"""

CANVAS = Path(__file__).with_name("canvas.js").read_text().rstrip()
PIXELS, CALLS, AXIS, GREEN = (f"{CANVAS}.{name}" for name in ("pixels", "calls", "axis", "green"))

# Position of a plot's middle on the plot's axis, which lies between the margins: 0 to 1.
MIDDLE = "((plot) => (plot.clientWidth / 2 - 66) / (plot.clientWidth - 80))(document.querySelector('{}'))"


def write(folder, *options):
    """Write a page into a folder; return its address."""
    assert report.main([*options, "--sim", simulator_name(), "--out", str(folder)]) == 0
    return (folder / "report.html").as_uri()


def write_without_rtl(folder, *options):
    with pytest.MonkeyPatch.context() as patch:
        without_rtl(patch)
        return write(folder, *options)


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """Return the address of a page with all trajectories."""
    return write_without_rtl(tmp_path_factory.mktemp("report"), "--trajectory", "all")


@pytest.fixture(scope="session")
def clip(tmp_path_factory):
    """Return the address of the page of a clip whose swivel angles are changed to 1.5 rad."""
    path = figure.write(tmp_path_factory.mktemp("clip") / "t.bvh", frames=61)
    return write_without_rtl(path.parent, "--trajectory", str(path), "--phi", "1.5")


@pytest.fixture(scope="session")
def three(tmp_path_factory):
    """Return the address of a page of 20 targets, run through the RTL of three datapaths."""
    path = tmp_path_factory.mktemp("three") / "t.csv"
    path.write_text("x,y,z\n" + "".join(f"0.3,{n / 50},0.1\n" for n in range(20)))
    return write(path.parent, "--trajectory", str(path), "--datapath", "lean,fold,paper")


def stays(page, seconds=0.1):
    """Assert that the page shows the same target for `seconds`; return the target."""
    before = page.run(AT)
    time.sleep(seconds)
    assert page.run(AT) == before
    return before


def walk(page, steps, script=AT):
    """Press a key or click an element (#id) in each step, then assert that `script` has the step's expected value."""
    for action, expected in steps:
        (page.click if action.startswith("#") else page.press)(action)
        assert page.run(script) == expected, action


def assert_plots_move_to_the_pointer(page, plots, last, script=AT):
    """Assert that a click on a plot of targets 0 to `last` selects the target at the pointer."""
    for plot in plots:
        page.press("Home")
        page.click(plot)
        assert abs(page.run(script) - last * page.run(MIDDLE.format(plot))) < 2, plot


def assert_fits(page, what=None):
    assert page.run(FITS) and page.run("document.documentElement.dataset.fits") == "true", what
    assert page.run(STICKING_OUT) == [], what


def assert_figure_is_whole(page, what):
    """Assert that the paper's figure is inside its canvas and that no labels overlap; return the number of labels."""
    assert page.run(f"{PIXELS}('paper', [null])")[0][1] >= 2, what
    boxes = []
    for name, x, y, width, align, font in page.run(f"{CALLS}('paper', 'fillText')"):
        if not font.startswith("9.5px"):  # subscripts are drawn separately
            left = x - width / 2 if align == "center" else x
            boxes.append((left, y - 6, left + width, y + 6, name))
    for n, a in enumerate(boxes):
        for b in boxes[:n]:
            assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3], (what, a, b)
    return len(boxes)


def test_playback(written, browser):
    page = browser(written)
    assert page.requests == [written], "nothing but the file itself is loaded"
    page.wait_for(f"{AT} >= 3")
    first = page.run(AT)
    page.wait_for(f"{AT} > {first} + 5")
    page.wait_for(f"{AT} < {first}")  # the motion restarts after its end
    page.click("#play")
    at = stays(page, 0.4)
    page.press("Space")  # the focused button treats the key as a click
    page.wait_for(f"{AT} != {at}")
    page.run("document.activeElement.blur()")
    page.press("Space")
    stays(page, 0.4)
    for target, at in (("-5", 0), ("1000", 99), ("x", 0)):
        page.open(f"{written}#trajectory=none&target={target}")
        assert stays(page) == at and page.run("document.getElementById('trajectory').value") == NAMES[0]
    assert stays(browser(written, reduced_motion="reduce"), 0.4) == 0


def test_controls(written, browser):
    page = browser(written + "#trajectory=reach&target=20&figure=4")
    figures = "[...document.querySelectorAll('#paper-choice button')].findIndex((b) => b.ariaPressed === 'true') + 1"
    assert page.run(figures) == 4
    page.click("#paper-choice button:nth-child(2)")
    assert page.run(figures) == 2 and stays(page) == 20
    for canvas in ("scene", "paper"):  # a drag turns, a click does not
        before = page.picture(canvas)
        x, y = page.middle(f"#{canvas}")
        page.drag((x, y), (x + 80, y + 20))
        turned = page.picture(canvas)
        page.click(f"#{canvas}")
        assert page.picture(canvas) == turned != before and page.run(AT) == 20
        page.click("#view")
        assert page.picture(canvas) == before

    page.run("document.activeElement.blur()")
    keys = [("Home", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", 99), ("ArrowRight", 99)]
    walk(page, [*keys, ("Home", 0), ("#next", 1), ("#next", 2), ("#back", 1)])
    page.run("document.getElementById('scrub').focus()")
    walk(page, [("ArrowRight", 2)])  # handled by the slider alone: one step, not two
    x, y = page.middle("#scrub")
    page.drag((x, y), (x + 60, y))
    assert 50 < stays(page) < 99
    assert_plots_move_to_the_pointer(page, ("#hand", "#angles"), 99)
    page.click("#pipeline")  # the target that leaves at that clock
    assert abs(page.run(AT) - (page.run(MIDDLE.format("#pipeline")) * (100 + LATENCY) - LATENCY)) < 2

    cards = "[...document.querySelectorAll('#cards button')]"
    good = page.run(f"{cards}.filter((b) => b.querySelector('.good')).map((b) => b.dataset.name)")
    assert good == [name for name in NAMES if name != "out_of_reach"]
    assert len(set(page.run(f"{cards}.map((b) => b.querySelector('canvas').toDataURL())"))) == len(NAMES)
    page.click("#cards button[data-name=punch]")
    assert page.run("document.getElementById('trajectory').value") == "punch"
    links = [Path(href) for href in page.run("[...document.querySelectorAll('#files a')].map((a) => a.pathname)")]
    files = ("punch/results.csv", "punch/results.npz", "score.json")
    assert links == [Path(written.removeprefix("file://")).parent / name for name in files]
    assert all(path.is_file() for path in links)

    for node in page.call("Accessibility.getFullAXTree")["nodes"]:
        role = node.get("role", {}).get("value")
        if role in ("button", "slider", "combobox", "image", "img", "region") and not node.get("ignored"):
            assert node.get("name", {}).get("value"), f"no name for a screen reader: {node}"


@pytest.mark.parametrize(("size", "scheme"), SIZES, ids=str)
def test_every_trajectory_is_drawn_and_fits(written, browser, size, scheme):
    """Limbs are inside the picture and large enough to see; figures 1 to 5 are complete; no two pictures are equal."""
    page = browser(written + "#target=50", size, color_scheme=scheme)
    pictures, figures = set(), set()
    for name in NAMES:
        page.choose("trajectory", name)
        for n in (0, 33, 66, 99):
            page.choose("scrub", n)
            limbs = page.run(f"{PIXELS}('scene', ['upper', 'fore', 'joint', 'goal'])")
            assert min(margin for _, margin, _ in limbs) > 0, (name, n, limbs)
            # A child's arm next to an adult's, or an arm with the hand near the shoulder, is small but never a dot.
            assert max(extent for *_, extent in limbs[:3]) > 0.09, (name, n, limbs)
        assert_fits(page, name)
        verdict = "bad" if name == "out_of_reach" else "good"
        assert page.run("document.getElementById('verdict').className") == verdict
        pictures |= {page.picture(canvas) for canvas in ("scene", "hand", "angles")}
        if name in ("reach", "overhead", "two_arms", "fold_in"):
            for number, n in ((number, n) for number in range(1, 6) for n in (0, 66)):
                page.run(f"document.querySelectorAll('#paper-choice button')[{number - 1}].click()")
                page.choose("scrub", n)
                assert assert_figure_is_whole(page, (name, number, n)) >= 6
                figures.add(page.picture("paper"))
    assert len(pictures) == 3 * len(NAMES), "no canvas is empty, or as the trajectory before left it"
    assert len(figures) == 4 * 5 * 2


def test_a_clip_is_played_by_frames(clip, browser):
    page = browser(clip + "#frame=0")
    keys = [("ArrowRight", 1), ("ArrowLeft", 0), ("End", 60)]
    walk(page, [(key, [frame, 2 * frame]) for key, frame in keys], f"[{FRAME}, {AT}]")
    page.choose("arm", 1)
    assert [page.run(FRAME), page.run(AT)] == [60, 121], "the other arm, at the same time"
    assert_plots_move_to_the_pointer(page, ("#joints", "#hand", "#angles"), 60, FRAME)
    page.press("Home")
    page.choose("speed", 0.1)
    page.press("Space")
    start = time.monotonic()
    page.wait_for(f"{FRAME} >= 24")  # 120 Hz at a tenth of the speed
    assert 1.5 < time.monotonic() - start < 4


@pytest.mark.parametrize(("size", "scheme"), SIZES[::2], ids=str)
def test_a_clip_is_drawn_and_fits(clip, browser, size, scheme):
    """The whole body is visible in figure 1, and its bones have nearly the same directions there as in the scene."""
    page = browser(clip + "#frame=0", size, color_scheme=scheme)
    pictures = set()
    for frame in (0, 20, 40, 55):  # the motion ends in the pose of its beginning
        page.choose("scrub", frame)
        parts = page.run(f"{PIXELS}('scene', ['body', 'upper', 'fore', 'joint', 'goal'])")
        assert min(count for count, *_ in parts) > 20 and min(margin for _, margin, _ in parts[1:4]) > 0, (frame, parts)
        pictures |= {page.picture(), page.picture("paper")}
        assert_fits(page, frame)
    page.choose("scrub", 10)
    for arm in (0, 1):
        page.choose("arm", arm)
        pictures.add(page.picture("paper"))
        scene, paper = (np.array([c[:2] for c in page.run(f"{CALLS}('{at}', 'arc')")]) for at in ("scene", "paper"))
        ours, theirs = scene[3 * arm : 3 * arm + 3], paper[:6:2]
        for a, b in ((0, 1), (1, 2), (0, 2)):
            ways = [(joints[b] - joints[a]) / np.linalg.norm(joints[b] - joints[a]) for joints in (ours, theirs)]
            assert ways[0] @ ways[1] > 0.97, (arm, a, b)
        for number in range(1, 6):
            page.click(f"#paper-choice button:nth-child({number})")
            assert_figure_is_whole(page, (arm, number))
        page.click("#paper-choice button:nth-child(1)")
    assert len(pictures) == 10


@pytest.mark.parametrize(("size", "scheme"), SIZES[::2], ids=str)
def test_hand_poses_are_drawn_and_fit(browser, size, scheme, tmp_path):
    """Each joint has a strip; the elbow's circle is green exactly where all joints are within their limits."""
    poses, phi = trajectories.make("pick_and_place"), np.linspace(-3, 3, 100)
    still = {name: np.full(100, getattr(poses, name)[30]) for name in "xyz"}
    others = {name: column[30:31] * 100 for name, column in poses.others.items()} | {"branch": ["0"] * 100}
    (tmp_path / "t.csv").write_text(format_csv(replace(poses, phi=phi, others=others, **still)))
    words = "--trajectory", str(tmp_path / "t.csv"), "--robot", "iiwa14", "--limits", "report"
    page = browser(write_without_rtl(tmp_path, *words) + "#target=0", size, color_scheme=scheme)
    hands = data_in(tmp_path / "report.html")[0]["hands"]
    over, names, ends = np.array(hands["over"]), np.array(hands["names"]), np.radians(hands["free"][0]).ravel()
    away = np.abs(np.angle(np.exp(1j * (phi - ends[:, None])))).min(axis=0)
    shown, pictures, elbows = np.flatnonzero(away > 0.3)[::5].tolist(), set(), {}
    for n in shown:
        page.choose("scrub", n)
        assert_fits(page, n)
        beyond = ", ".join(names[(over[n] >> np.arange(7) & 1) > 0]) or "none"
        assert page.text("now").endswith(f"joints outside limits{beyond}")
        assert min(margin for _, margin, _ in page.run(f"{PIXELS}('scene', ['upper', 'fore', 'body', 'joint'])")) > 0
        strips = page.run(f"{PIXELS}('seven', ['upper', 'fore', 'plane', 'elbow', 'bad'])")
        assert min(count for count, *_ in strips) > 50
        pictures |= {page.picture(), page.picture("seven"), page.picture("steps"), page.picture("circle")}
        *_, (x, y, *_), _, _, _ = page.run(f"{CALLS}('scene', 'arc')")  # elbow, wrist twice, ring
        elbows[n] = f"{x}, {y}, {30 if size == WIDE else 10}"
    assert len(pictures) == 4 * len(shown)
    green = [page.run(f"{GREEN}({elbow})") > 2 for elbow in elbows.values()]
    assert green == (over[shown] == 0).tolist() and 2 < sum(green) < len(shown) - 2, (green, over[shown])
    assert_plots_move_to_the_pointer(page, ("#seven", "#steps"), 99)


@pytest.mark.parametrize(("size", "scheme"), SIZES[:3], ids=str)
def test_datapaths_side_by_side(three, browser, size, scheme):
    """Each datapath has its own colour, plots, verdict and score; all plots of errors have the same scale."""
    page = browser(three + "#target=10", size, color_scheme=scheme)
    assert_fits(page)
    folder, names = Path(three.removeprefix("file://")).parent, ("lean", "fold", "paper")
    badges = page.run(BADGES)
    assert [label for label, _ in badges] == [*names] * 4, "of target, score, errors, pipeline"
    assert len({tuple(badge) for badge in badges}) == 3, "each has one colour"
    scores = {score["datapath"]: score for score in json.loads((folder / "score.json").read_text())}
    for place, name in zip(("", "2", "3"), names, strict=True):
        assert page.text(f"verdict{place}") == scores[name]["outcome"]
        assert f"{scores[name]['hand_error_max']:.1e}" in page.text(f"figures{place}")
        assert f"leaves {scores[name]['latency_cycles']} clocks after" in page.text(f"pipeline-note{place}")
    for canvas in ("hand", "angles", "pipeline"):
        assert len({page.picture(canvas + place) for place in ("", "2", "3")}) >= 2, canvas
        axes = {page.run(f"{AXIS}('{canvas + place}')") for place in ("", "2", "3")}
        assert len(axes) == 1 or canvas == "pipeline", f"{canvas}: one scale"
    place = "document.getElementById('{}').getBoundingClientRect().x"
    assert (page.run(place.format("hand2")) > page.run(place.format("hand"))) == (size[0] >= 900), "where there is room"
    assert_plots_move_to_the_pointer(page, ("#hand2", "#angles3"), 19)


SINGULAR = "0,0,0.5,1\n0.6,0,0,1\n0.59999,0,0,1\n0.000001,0,0.5,1\n0.27,0,0.33,0.0001\n0.6,0.6,0.1,1\n0,0,0,1\n"
THOUSANDS = "".join(f"0.3,{k / 15_000},-0.2,3\n" for k in range(3000))


@pytest.mark.parametrize("rows", ["0.3,0.1,-0.2,3\n", "0.3,0.1,-0.2,3\n" * 2, SINGULAR, THOUSANDS])
def test_other_targets(simulator, browser, rows, tmp_path):
    """The page shows any number of targets, even singular targets; a name with markup is shown as text."""
    name = "<img src=x onerror=console.log(1)>&'" + "long" * 30
    (tmp_path / f"{name}.csv").write_text("x,y,z,phi\n" + rows)
    assert report.main(["--trajectory", str(tmp_path / f"{name}.csv"), "--out", str(tmp_path)]) == 0
    page = browser((tmp_path / "report.html").as_uri(), NARROW)
    assert page.run("document.title").endswith(name) and page.run("document.images.length") == 0
    assert page.run("document.getElementById('trajectory').value") == name
    count = rows.count("\n")
    if count > 2:
        page.wait_for(f"{AT} > 0")
    page.press("End")
    assert stays(page) == count - 1
    assert_fits(page)
    for n, number in ((n, number) for n in range(min(count, 7)) for number in (1, 2, 4)):
        page.choose("scrub", n)
        page.click(f"#paper-choice button:nth-child({number})")
        assert page.run(f"{PIXELS}('paper', [null])")[0][1] >= 2, (n, number)
