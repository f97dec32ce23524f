// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts the scripts of this folder into one function.

// -- all trajectories at a glance -----------------------------------------------------------

// Draws the arm a third of the way through the trajectory, and the paths of target and elbow.
function drawThumbnail(canvas, t) {
  const { g, w, h } = prepare(canvas);
  const { colours: c } = state;
  const { project } = camera(w, h, bounds(t), VIEW);
  const last = t.target.length - 1;
  for (const arm of new Set(t.arm)) {
    const mine = t.arm.flatMap((a, i) => (a === arm ? [i] : []));
    line(g, mine.map((i) => project(t.elbow[i])), c.elbow, 1);
    line(g, mine.map((i) => project(t.target[i])), c.goal, 1.5);
    const n = mine[Math.min(mine.length - 1, Math.round(last / 3))];
    line(g, [[0, 0, 0], t.elbow[n]].map(project), c.upper, 4);
    line(g, [t.elbow[n], t.wrist[n]].map(project), c.fore, 3.5);
  }
}

const largest = (values) => values.reduce((most, v) => Math.max(most, v), 0);

function card(t) {
  const button = Object.assign(document.createElement("button"), { type: "button", title: t.about });
  button.dataset.name = t.name;
  const write = (tag, content, className = "") =>
    button.append(Object.assign(document.createElement(tag), { textContent: content, className }));
  const picture = document.createElement("canvas");
  picture.setAttribute("aria-hidden", "true");
  button.append(picture);
  write("b", t.name.replaceAll("_", "_\u200b")); // allow line breaks after underscores
  for (const run of runsOf(t)) {
    write("small", several ? run.datapath : `${t.target.length} targets`, several ? "" : "count");
    write("span", run.passed ? "pass" : "FAIL", run.passed ? "good" : "bad");
    write("small", `hand error ${error(largest(run.hand))}`, "wide");
    write("small", `asked ${run.bar === null ? "nothing" : error(run.bar)}`, "wide");
  }
  button.addEventListener("click", () => {
    show(t.name);
    scene.scrollIntoView({ block: "nearest" });
  });
  return button;
}

function writeOverview() {
  element("overview").hidden = DATA.length < 2;
  element("cards").replaceChildren(...DATA.map(card));
}

function drawOverview() {
  if (DATA.length > 1) {
    document.querySelectorAll("#cards canvas").forEach((canvas, i) => drawThumbnail(canvas, DATA[i]));
  }
}
