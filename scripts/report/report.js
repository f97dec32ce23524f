// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/__main__.py, which puts the scripts of this folder into one function.

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
    line(g, mine.map((i) => project((t.hands?.goal ?? t.target)[i])), c.goal, 1.5);
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
    write("span", run.outcome.slice(0, 4), run.outcome.startsWith("pass") ? "good" : "bad");
    write("small", `hand error ${error(largest(run.hand))}`, "wide");
    write("small", run.tolerance === null ? "no tolerance" : `tolerance ${error(run.tolerance)}`, "wide");
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

// -- text -----------------------------------------------------------------------------------

const degrees = (v) => `${v.toFixed(1).replace("-", "\u2212")}\u00b0`;

function writeNow() {
  const { shown: t, at: n, frame } = state;
  const last = framesIn(t) - 1;
  const place = t.clip ? `frame ${frame} of 0 to ${last}, ${(frame / t.clip.rate).toFixed(2)} s` : `target ${n} of 0 to ${last}`;
  element("target").textContent = place;
  element("scrub").value = frame;
  element("scrub").setAttribute("aria-valuetext", place);
  document.documentElement.dataset.target = n;
  document.documentElement.dataset.frame = frame;
  element("now").replaceChildren(
    ...rows([
      ["wrist target", t.target[n].map(short).join(", ")],
      ["swivel angle", `${t.phi[n].toFixed(4)} rad (${degrees(t.angles[n][2])})`],
      ...(t.hands ? hand(t.hands, n) : []),
      ["arm lengths", t.lengths[n].map(short).join(", ")],
      ...state.runs.flatMap((run, i) => [...(several ? [[run.datapath, "", i]] : []), ...answer(run, n)]),
    ]),
  );
}

// Returns the rows of a hand pose.
const hand = ({ goal, free, branch, steps, jumps }, n) => [
  ...(goal ? [["hand", goal[n].map(short).join(", ")]] : []),
  ...(free ? [["swivel within limits", free[n].map(([from, to]) => `${degrees(from)} to ${degrees(to)}`).join("; ") || "none"]] : []),
  ...(steps ? [["branch", branch[n]], ["largest step", (steps[n] === null ? "no joints" : `${short(steps[n])} rad`) + (jumps.includes(n) && steps[n] !== null ? ": jumps" : "")]] : []),
];

// Returns the names of the joints of a pose that are outside their limits.
const beyond = ({ over, names }, n) => names.filter((_, k) => (over[n] >> k) & 1).join(", ");

// Returns the rows of a target's result.
const answer = (t, n) => [
  ["upper arm", `azimuth ${degrees(t.angles[n][0])}, elevation ${degrees(t.angles[n][1])}`],
  ["elbow flexion", degrees(t.angles[n][3])],
  ["Qs", ["", "i", "j", "k"].map((unit, i) => signed(t.qs[n][i]) + unit).join(" ")],
  ["Qe", ["", "i"].map((unit, i) => signed(t.qe[n][i]) + unit).join(" ")],
  ["flags", t.flags[n] === "-" ? "none" : t.flags[n]],
  [t.clamped[n] ? "hand error, clamped" : "hand error", `${error(t.hand[n])} of the reach`],
  [t.predicted ? "tolerance, predicted" : "tolerance", [t.tolerance, ...(t.predicted ? [t.predicted[n]] : [])].map((v) => (v === null ? "none" : error(v))).join(", ")],
  ...(t.hands ? [["orientation error", `${error(t.hands.error[n])} rad`]] : []),
  ...(t.hands?.free ? [["joints outside limits", beyond(t.hands, n) || "none"]] : []),
  ...(t.clip ? [["elbow error", `${error(t.elbowError[n])} of the reach`]] : []),
];

const KINDS = { csv: "results (CSV)", npz: "results (NumPy)", json: "score (JSON)", bvh: "clip (BVH)", glb: "clip (glTF)" };

function link(path) {
  const item = document.createElement("li");
  const of = several && path.includes("/") ? `${path.split("/")[0]}: ` : "";
  const a = Object.assign(document.createElement("a"), { href: path, textContent: of + KINDS[path.split(".").at(-1)] });
  a.setAttribute("download", "");
  item.append(a);
  return item;
}

function writeTrajectory() {
  const t = state.shown;
  element("about").textContent = t.about;
  element("arm-title").textContent = t.clip
    ? "The figure, its limbs from the core's quaternions"
    : "The arm, from the core's quaternions";
  element("scrub").max = framesIn(t) - 1;
  document.documentElement.dataset.clip = Boolean(t.clip);
  element("arm").replaceChildren(...(t.clip?.arms ?? []).map(({ side }, i) => new Option(side, i)));
  element("arm").value = state.arm;
  element("arm").disabled = armsIn(t) === 1;
  document.documentElement.dataset.hands = Boolean(t.hands);
  document.documentElement.dataset.limits = Boolean(t.hands?.free);
  element("joints-note").textContent = t.clip
    ? "Azimuth of the upper arm from forward to the left and elevation from the horizontal, as the torso sees them; " +
      "of an arm that hangs straight down azimuth means little. Swivel angle of the target."
    : "Azimuth of the upper arm from x towards y, elevation from the xy plane; swivel angle of the target.";
  t.beside.forEach((run, i) => {
    element("joints-note").textContent += ` ${DASHES[i + 1].name}: the ${run.datapath} datapath.`;
  });
  element("files").replaceChildren(...[...FILES[t.name], ...FILES[""]].map(link));
  document.querySelectorAll("#cards button").forEach((b) => b.setAttribute("aria-pressed", b.dataset.name === t.name));
  document.querySelectorAll(".badge.several").forEach((badge) => {
    badge.textContent = state.runs[Number(badge.dataset.run)].datapath;
  });
  state.runs.forEach(writeScore);
}

function writeScore(t, i) {
  const mine = (name) => element(name + PLACES[i]);
  mine("verdict").textContent = t.outcome;
  mine("verdict").className = t.outcome.startsWith("pass") ? "good" : "bad";
  mine("failures").replaceChildren(
    ...t.failures.map((failure) => Object.assign(document.createElement("li"), { textContent: failure })),
  );
  mine("figures").replaceChildren(
    ...t.figures.map((figure) => {
      const row = document.createElement("tr");
      row.className = / jump /.test(figure[0]) && figure[1] !== "none" ? "bad" : "";
      for (let i = 0; i < 4; i++) {
        const cell = document.createElement(i ? "td" : "th");
        cell.textContent = figure[i] || "";
        cell.className = /^\S+$/.test(cell.textContent) ? "number" : "";
        if (!i) {
          cell.scope = "row";
        }
        row.append(cell);
      }
      return row;
    }),
  );
  mine("clamped-note").textContent = t.clamped.includes(true)
    ? "Targets out of reach: the hand against that of the clamped pose."
    : "";
  const count = t.target.length;
  const period = periodOf(t);
  mine("pipeline-note").textContent =
    `${count} target${count === 1 ? "" : "s"} in ${t.cycles} clocks: the first result leaves ${t.latency} clocks after its target came in, ` +
    (period > 1 ? `then one in ${short(period)} clocks.` : `then ${short(1 / period)} a clock.`) +
    (clocks(t) < longest() ? " Time has another scale than beside it." : "");
}

// -- motion ---------------------------------------------------------------------------------

function draw() {
  drawScene();
  drawPaper();
  drawJoints();
  drawSeven();
  drawSteps();
  drawCircle();
  drawErrors();
  state.runs.forEach(drawPipeline);
  writeNow();
  const root = document.documentElement;
  root.dataset.fits = root.scrollWidth <= root.clientWidth;
  root.dataset.width = root.clientWidth;
}

function go(frame) {
  state.frame = Math.max(0, Math.min(framesIn(state.shown) - 1, Math.round(frame)));
  state.at = state.frame * armsIn(state.shown) + state.arm;
  draw();
}

function frame(time) {
  if (!state.playing) {
    return;
  }
  // Time starts with the first frame; the limit prevents a jump after the tab was hidden.
  const elapsed = Math.min(0.25, (time - (state.last ?? time)) / 1000);
  state.last = time;
  state.owed += elapsed * rateOf(state.shown) * Number(element("speed").value);
  const steps = Math.floor(state.owed);
  if (steps > 0) {
    state.owed -= steps;
    go((state.frame + steps) % framesIn(state.shown)); // restart after the last frame
  }
  requestAnimationFrame(frame);
}

function play(on) {
  const start = on && !state.playing;
  state.playing = on;
  element("play").textContent = on ? "Pause" : "Play";
  document.documentElement.dataset.playing = on;
  if (start) {
    Object.assign(state, { last: null, owed: 0 });
    requestAnimationFrame(frame);
  }
}

function step(by) {
  play(false);
  go(state.frame + by);
}

function resetView() {
  const { clip } = state.shown;
  state.view = clip ? { ...VIEW, azimuth: clip.facing - FRONT } : { ...VIEW };
}

function show(name) {
  state.shown = DATA.find((t) => t.name === name) || DATA[0];
  state.runs = runsOf(state.shown);
  state.arm = 0;
  state.bounds = bounds(state.shown);
  resetView();
  element("trajectory").value = state.shown.name;
  writeTrajectory();
  go(0);
}

function listen() {
  element("play").addEventListener("click", () => play(!state.playing));
  element("back").addEventListener("click", () => step(-1));
  element("next").addEventListener("click", () => step(1));
  element("scrub").addEventListener("input", (event) => step(Number(event.target.value) - state.frame));
  element("arm").addEventListener("change", (event) => {
    state.arm = Number(event.target.value);
    go(state.frame);
  });
  element("trajectory").addEventListener("change", (event) => show(event.target.value));
  const viewAgain = () => {
    resetView();
    draw();
  };
  element("view").addEventListener("click", viewAgain);

  const last = () => framesIn(state.shown) - 1;
  const keys = {
    " ": () => play(!state.playing),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => step(-state.frame),
    End: () => step(last()),
    v: viewAgain,
  };
  document.addEventListener("keydown", (event) => {
    // Fields and buttons handle these keys themselves.
    const taken = event.target.closest?.("select, input") || (event.key === " " && event.target.closest?.("button"));
    if (keys[event.key] && !taken && !event.ctrlKey && !event.altKey && !event.metaKey) {
      event.preventDefault();
      keys[event.key]();
    }
  });

  for (const canvas of [scene, element("paper")]) {
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) {
        state.view.azimuth -= event.movementX * 0.01;
        state.view.elevation = Math.max(-0.2, Math.min(1.55, state.view.elevation + event.movementY * 0.01));
        drawScene();
        drawPaper();
      }
    });
  }

  const seek = (canvas, target) =>
    canvas.addEventListener("click", (event) => {
      const inside = (event.offsetX - MARGIN.left) / (canvas.clientWidth - MARGIN.left - MARGIN.right);
      step(target(inside) - state.frame);
    });
  seek(element("joints"), (inside) => inside * last());
  seek(element("seven"), (inside) => inside * last());
  seek(element("steps"), (inside) => inside * last());
  PLACES.forEach((place, i) => {
    seek(element("hand" + place), (inside) => inside * last());
    seek(element("angles" + place), (inside) => inside * last());
    seek(element("pipeline" + place), (inside) => {
      const run = state.runs[i];
      return (inside * clocks(run) - run.latency) / periodOf(run) / armsIn(run);
    });
  });

  const anew = () => {
    draw();
    drawOverview();
  };
  window.addEventListener("resize", anew);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    anew();
  });
}

// Clones the first run's elements for each further run, with new ids.
function makePlaces() {
  const root = document.documentElement;
  root.dataset.several = several;
  root.style.setProperty("--runs", PLACES.length);
  document.querySelectorAll(".runs").forEach((runs) => {
    const first = runs.firstElementChild;
    runs.append(...PLACES.slice(1).map((place, i) => {
      const block = first.cloneNode(true);
      block.querySelectorAll("[id]").forEach((e) => (e.id += place));
      block.querySelector(".badge").dataset.run = i + 1;
      return block;
    }));
    [...runs.children].forEach((block, i) => {
      const of = several ? `, ${runsOf(DATA[0])[i].datapath}` : "";
      block.querySelectorAll("canvas").forEach((canvas) => (canvas.ariaLabel += of));
    });
  });
}

// #trajectory=punch&target=40&figure=2 (for a clip #frame=40) opens the page there, stopped. Otherwise it plays, unless
// the system prefers reduced motion.
function start() {
  const options = new URLSearchParams(location.hash.slice(1));
  element("trajectory").replaceChildren(
    ...DATA.map((t) => new Option(runsOf(t).every((run) => run.passed) ? t.name : `${t.name} (FAIL)`, t.name)),
  );
  element("trajectory").disabled = DATA.length === 1;
  makePlaces();
  readColours();
  listen();
  writeOverview();
  state.figure = Math.max(0, Math.min(PAPER.length, Number(options.get("figure")) || 1) - 1);
  writePaper();
  show(options.get("trajectory"));
  drawOverview();
  const at = options.get("frame") ?? options.get("target");
  if (at !== null) {
    go(Number(at) || 0);
  } else {
    play(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
}

start();
