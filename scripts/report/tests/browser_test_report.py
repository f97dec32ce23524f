# SPDX-License-Identifier: Apache-2.0
"""The report in headless Chromium (`make test-browser`, which installs it if necessary).

Not part of `make test`. The page is from an RTL run of all trajectories.
"""

import time
from pathlib import Path

import pytest

from model.dataflow.fixed import latency
from model.io import trajectories
from scripts.report import page as report
from scripts.report.tests.browser import AT, COUNT, FITS, NARROW, PICTURE, STICKING_OUT, WIDE, Page, across, show, stays

NAMES = list(trajectories.TRAJECTORIES)


# -- it loads and moves ----------------------------------------------------------------------------


def test_it_opens_from_disk_and_plays(written, browser):
    page = browser(written)
    assert page.requests == [written], "nothing but the file itself is loaded"
    page.wait_for(f"{AT} >= 3")
    first, picture = page.run(AT), page.run(PICTURE)
    page.wait_for(f"{AT} > {first} + 5")
    assert page.run(PICTURE) != picture
    page.wait_for(f"{AT} < {first}")  # the motion restarts after its end
    assert page.run("document.getElementById('play').textContent") == "Pause"


def test_it_does_not_move_for_who_asks_for_less_motion(written, browser):
    assert stays(browser(written, prefers_reduced_motion="reduce")) == 0


@pytest.mark.parametrize("target, shown", [("-5", 0), ("1000", 99), ("x", 0), ("", 0)])
def test_addresses_that_lead_nowhere(written, browser, target, shown):
    page = browser(f"{written}#trajectory=none&target={target}")
    assert stays(page, 0.1) == shown
    assert page.run("document.getElementById('trajectory').value") == NAMES[0]


# -- its controls ----------------------------------------------------------------------------------


def test_play_and_pause(written, browser):
    page = browser(written + "#target=10")
    assert stays(page) == 10
    page.click("#play")
    page.wait_for(f"{AT} > 12")
    page.click("#play")
    at = stays(page)
    page.press(" ")  # the focused button treats the key as a click
    page.wait_for(f"{AT} != {at}")
    page.run("document.activeElement.blur()")
    page.press(" ")
    stays(page)


def test_keys(written, browser):
    page = browser(written)
    page.press("Home")
    assert stays(page) == 0, "a step pauses"
    for key, at in [
        ("ArrowRight", 1),
        ("ArrowRight", 2),
        ("ArrowLeft", 1),
        ("End", 99),
        ("ArrowRight", 99),
        ("Home", 0),
    ]:
        page.press(key)
        assert page.run(AT) == at, key
    page.click("#next")
    page.click("#next")
    page.click("#back")
    assert stays(page, 0.1) == 1
    page.run("document.getElementById('scrub').focus()")
    page.press("ArrowRight")  # handled by the slider alone: one step, not two
    assert page.run(AT) == 2


def test_scrub(written, browser):
    page = browser(written + "#target=0")
    x, y = page.middle("#scrub")
    page.drag((x, y), (x + 60, y))
    assert 50 < stays(page, 0.1) < 99
    page.drag((x, y), (x, y))
    assert page.run(AT) in (49, 50)


def test_click_on_a_plot_goes_there(written, browser):
    page = browser(written + "#target=0")
    clocks = latency("lean", 32)
    out = across(page, "#pipeline") * (100 + clocks) - clocks  # the target that leaves at that clock
    middles = [(plot, 99 * across(page, plot)) for plot in ("#hand", "#angles")]
    for plot, at in [*middles, ("#pipeline", out)]:
        page.click(plot)
        assert abs(page.run(AT) - at) < 2, plot
    x, y = page.middle("#pipeline")
    width = page.run("document.getElementById('pipeline').clientWidth")
    page.drag((x + 0.4 * width, y), (x + 0.4 * width, y))
    assert page.run(AT) > 60


def test_drag_turns_the_view(written, browser):
    page = browser(written + "#target=20")
    picture = page.run(PICTURE)
    x, y = page.middle("#scene")
    page.drag((x, y), (x + 100, y + 30))
    turned = page.run(PICTURE)
    assert turned != picture and stays(page, 0.1) == 20
    page.drag((x, y), (x, y))
    assert page.run(PICTURE) == turned, "a click does not turn"
    page.click("#view")
    assert page.run(PICTURE) == picture


# -- what it draws ---------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [WIDE, (1000, 700), NARROW, (320, 600)], ids=str)
def test_every_trajectory_is_drawn_and_fits(written, browser, size):
    page = browser(written + "#target=50", size)
    assert page.run("[...document.getElementById('trajectory').options].map((o) => o.value)") == NAMES
    pictures = set()
    for name in NAMES:
        show(page, name)
        page.press("End")
        assert page.run(FITS) and page.run("document.documentElement.dataset.fits") == "true", name
        assert page.run(STICKING_OUT) == [], name
        assert page.run("document.getElementById('verdict').textContent").startswith("pass: ")
        rows = page.run("document.getElementById('figures').rows.length")
        assert rows == (15 if name == "out_of_reach" else 14), name
        for canvas in ("scene", "hand", "angles"):
            pictures.add(page.run(f"document.getElementById('{canvas}').toDataURL()"))
    assert len(pictures) == 3 * len(NAMES), "no canvas is empty, or as the trajectory before left it"


COLOURS = """(() => {
    const canvas = document.getElementById('scene');
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const pixels = copy.getImageData(0, 0, canvas.width, canvas.height).data;
    const style = getComputedStyle(document.documentElement);
    return ['upper', 'fore', 'joint', 'goal'].map((name) => {
        const hex = style.getPropertyValue('--' + name).trim();
        const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
        const box = [Infinity, Infinity, -Infinity, -Infinity];
        for (let i = 0; i < pixels.length; i += 4) {
            if (pixels[i] === r && pixels[i + 1] === g && pixels[i + 2] === b && pixels[i + 3] === 255) {
                const [x, y] = [(i / 4) % canvas.width, Math.floor(i / 4 / canvas.width)];
                [box[0], box[1]] = [Math.min(box[0], x), Math.min(box[1], y)];
                [box[2], box[3]] = [Math.max(box[2], x), Math.max(box[3], y)];
            }
        }
        return [...box, canvas.width, canvas.height];
    });
})()"""


@pytest.mark.parametrize(("size", "scheme"), [(WIDE, "light"), (NARROW, "dark")], ids=str)
def test_the_arm_is_in_the_picture(written, browser, size, scheme):
    """At several targets of every motion, the limbs are large enough to see and inside the picture."""
    page = browser(written + "#target=0", size, prefers_color_scheme=scheme)
    for name in NAMES:
        show(page, name)
        for n in range(0, 100, 33):
            page.run(f"""(() => {{ const s = document.getElementById('scrub'); s.value = {n};
                         s.dispatchEvent(new Event('input')); }})()""")
            boxes = page.run(COLOURS)
            for left, top, right, bottom, width, height in boxes:
                assert 0 < left and right < width - 1 and 0 < top and bottom < height - 1, (name, n, boxes)
            arm = [min(b[0] for b in boxes[:3]), min(b[1] for b in boxes[:3]), max(b[2] for b in boxes[:3])]
            arm.append(max(b[3] for b in boxes[:3]))
            size_on_screen = max(arm[2] - arm[0], arm[3] - arm[1])
            # A child's arm next to an adult's, or an arm with the hand near the shoulder, is small but never a dot.
            assert size_on_screen > 0.12 * min(boxes[0][4:]), (name, n, boxes)


def test_dark_and_light_follow_the_system(written, browser):
    page = browser(written + "#target=0", prefers_color_scheme="light")
    page.run(f"window.light = {PICTURE}; 0")
    assert page.run("getComputedStyle(document.body).backgroundColor") == "rgb(245, 246, 248)"
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    page.wait_for(f"{PICTURE} !== window.light", 10)
    assert page.run("getComputedStyle(document.body).backgroundColor") == "rgb(18, 21, 26)"


def test_another_size_of_the_window_draws_again(written, browser):
    page = browser(written + "#target=0", WIDE)
    page.call("Emulation.setDeviceMetricsOverride", width=400, height=800, deviceScaleFactor=2, mobile=False)
    page.wait_for("document.getElementById('scene').width === 2 * document.getElementById('scene').clientWidth")
    assert page.run(FITS)


def test_everything_has_a_name_for_who_does_not_see_it(written, browser):
    page = browser(written + "#target=0")
    nodes = page.call("Accessibility.getFullAXTree")["nodes"]
    for node in nodes:
        role = node.get("role", {}).get("value")
        if role in ("button", "slider", "combobox", "image", "img", "region") and not node.get("ignored"):
            assert node.get("name", {}).get("value"), node


@pytest.mark.parametrize("size", [WIDE, (900, 700), NARROW], ids=str)
def test_the_overview_leads_to_each_trajectory(written, browser, size):
    page = browser(written + "#target=0", size)
    cards = "[...document.querySelectorAll('#cards button')]"
    assert page.run(f"{cards}.map((b) => b.dataset.name)") == NAMES
    assert page.run(f"{cards}.every((b) => b.textContent.includes('pass'))")
    empty = "document.createElement('canvas')"
    pictures = page.run(f"{cards}.map((b) => b.querySelector('canvas').toDataURL())")
    assert len(set(pictures)) == len(NAMES) and page.run(f"{empty}.toDataURL()") not in pictures
    for name in ("punch", "out_of_reach"):
        page.click(f"#cards button[data-name={name}]")
        assert page.run("document.getElementById('trajectory').value") == name
        assert page.run(f"{cards}.filter((b) => b.ariaPressed === 'true').map((b) => b.dataset.name)") == [name]


def test_links_lead_to_files(written, browser):
    page = browser(written + "#trajectory=wave&target=0")
    links = page.run("[...document.querySelectorAll('#files a')].map((a) => a.href)")
    assert [link.rpartition("report0/")[2] for link in links] == ["wave/results.csv", "wave/results.npz", "score.json"]
    assert all(Path(link.removeprefix("file://")).is_file() for link in links)


# -- a clip ----------------------------------------------------------------------------------------

FRAME = "Number(document.documentElement.dataset.frame)"


def test_a_clip_moves_frame_by_frame(clip, browser):
    page = browser(clip + "#frame=0")
    assert page.run("document.getElementById('scrub').max") == "60"
    for key, frame in [("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", 60), ("Home", 0)]:
        page.press(key)
        assert [page.run(FRAME), page.run(AT)] == [frame, 2 * frame], key
    page.press("End")
    assert page.run("document.getElementById('target').textContent") == "frame 60 / 60, 0.50 s"
    page.run("""(() => { const s = document.getElementById('arm'); s.value = '1';
                s.dispatchEvent(new Event('change')); })()""")
    assert [page.run(FRAME), page.run(AT)] == [60, 121], "the other arm, at the same time"
    for plot in ("#joints", "#hand", "#angles"):
        page.press("Home")
        page.click(plot)
        assert abs(page.run(FRAME) - 60 * across(page, plot)) < 1, plot
    page.click("#pipeline")
    assert page.run(AT) % 2 == 1


def test_a_clip_plays_at_its_own_rate(clip, browser):
    """A 120 Hz clip at a tenth of its speed plays 12 frames per second."""
    page = browser(clip + "#frame=0")
    page.run("document.getElementById('speed').value = '0.1'")
    page.press(" ")
    start = time.monotonic()
    page.wait_for(f"{FRAME} >= 24")
    assert 1.5 < time.monotonic() - start < 4


@pytest.mark.parametrize(("size", "scheme"), [(WIDE, "light"), (NARROW, "dark")], ids=str)
def test_the_whole_figure_is_in_the_picture(clip, browser, size, scheme):
    page = browser(clip + "#frame=0", size, prefers_color_scheme=scheme)
    pictures = set()
    for frame in (0, 20, 40, 60):
        page.run(f"""(() => {{ const s = document.getElementById('scrub'); s.value = {frame};
                     s.dispatchEvent(new Event('input')); }})()""")
        for name in ("body", "upper", "fore", "joint", "goal"):
            assert page.run(f"{COUNT}('{name}')") > 20, (name, frame)
        for left, top, right, bottom, width, height in page.run(COLOURS)[:3]:
            assert 0 < left and right < width - 1 and 0 < top and bottom < height - 1, frame
        pictures.add(page.run(PICTURE))
        assert page.run(FITS) and page.run(STICKING_OUT) == []
    assert len(pictures) == 4
    shown = "[...document.querySelectorAll('.legend li')].filter((e) => e.clientWidth).length"
    assert page.run(shown) == 6


def test_a_lone_trajectory_has_no_overview(clip, browser):
    page = browser(clip + "#frame=0")
    assert page.run("document.getElementById('overview').clientHeight") == 0
    assert "clip (BVH)" in page.run("document.getElementById('files').textContent")


# -- other input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rows",
    [
        "0.3,0.1,-0.2\n",
        "0.3,0.1,-0.2\n" * 2,
        "0,0,0\n9,9,9\n0,0,0.4\n0.01,0,0\n",
        "".join(f"0.3,{0.2 * k / 10_000},-0.2\n" for k in range(10_000)),
    ],
    ids=["one", "two that rest", "at the edges", "ten thousand"],
)
def test_other_numbers_of_targets(fake, browser, rows, capsys):
    count = rows.count("\n")
    page = browser(fake("x,y,z\n" + rows), NARROW)
    if count > 2:
        page.wait_for(f"{AT} > 0")
    page.press("End")
    assert stays(page, 0.1) == count - 1
    assert page.run(FITS) and page.run(STICKING_OUT) == []


def test_a_name_that_is_markup_is_text(fake, browser, tmp_path):
    fake("x,y,z\n0.3,0.1,-0.2\n")
    name = "<img src=x onerror=console.log(1)>&'" + "long" * 30
    (tmp_path / f"{name}.csv").write_text("x,y,z\n0.3,0.1,-0.2\n")
    assert report.main(["--trajectory", str(tmp_path / f"{name}.csv"), "--out", str(tmp_path)]) in (0, 1)
    page = browser((tmp_path / "report.html").as_uri(), NARROW)
    assert page.run("document.title") == f"CGA-IK: {name}"
    assert page.run("document.images.length") == 0
    assert page.run("document.getElementById('trajectory').value") == name
    assert page.run(FITS) and page.run(STICKING_OUT) == []


# -- seeded bugs -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "spoilt, problem",
    [
        ("throw new Error('on purpose');", "on purpose"),
        ("console.warn('on purpose');", "on purpose"),
        (
            "document.body.append(Object.assign(new Image(), {src: 'http://localhost/x.png'}));",
            "Content Security Policy",
        ),
    ],
)
def test_problems_are_noticed(written, tmp_path, spoilt, problem):
    path = tmp_path / "spoilt.html"
    path.write_text(
        Path(written.removeprefix("file://")).read_text().replace("\nstart();\n", f"\nstart();\n{spoilt}\n")
    )
    with Page(tmp_path / "profile", *WIDE) as page:
        page.open(path.as_uri())
        page.run("new Promise((done) => setTimeout(done, 200))")
        assert len(page.problems) == 1 and problem in page.problems[0]
