// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts canvas.js, arm.js, plots.js and report.js into one function.

// -- text -----------------------------------------------------------------------------------

function rows(list) {
  return list.flatMap(([name, value]) => {
    const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
    dt.textContent = name;
    dd.textContent = value;
    return [dt, dd];
  });
}

function writeNow() {
  const { shown: t, at: n } = state;
  const count = t.target.length;
  element("target").textContent = `target ${n} / ${count - 1}`;
  element("scrub").value = n;
  element("scrub").setAttribute("aria-valuetext", `target ${n}`);
  document.documentElement.dataset.target = n;
  element("now").replaceChildren(
    ...rows([
      ["wrist target", t.target[n].map(short).join(", ")],
      ["swivel angle", `${t.phi[n].toFixed(4)} rad`],
      ["arm lengths", t.lengths[n].map(short).join(", ")],
      ["Qs", ["", "i", "j", "k"].map((unit, i) => signed(t.qs[n][i]) + unit).join(" ")],
      ["Qe", ["", "i"].map((unit, i) => signed(t.qe[n][i]) + unit).join(" ")],
      ["flags", t.flags[n] === "-" ? "none" : t.flags[n]],
      [t.clamped[n] ? "hand error, clamped" : "hand error", `${error(t.hand[n])} of the reach`],
      ["asked, predicted", `${t.bar === null ? "nothing" : error(t.bar)}, ${error(t.predicted[n])}`],
    ]),
  );
}

function writeTrajectory() {
  const t = state.shown;
  element("about").textContent = t.about;
  element("scrub").max = t.target.length - 1;
  element("verdict").textContent = t.outcome;
  element("verdict").className = t.passed ? "good" : "bad";
  element("failures").replaceChildren(
    ...t.failures.map((failure) => Object.assign(document.createElement("li"), { textContent: failure })),
  );
  element("figures").replaceChildren(
    ...t.figures.map((figure) => {
      const row = document.createElement("tr");
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
  element("clamped-note").textContent = t.clamped.includes(true)
    ? "Targets out of reach: the hand against that of the clamped pose."
    : "";
  const count = t.target.length;
  element("pipeline-note").textContent =
    `${count} target${count === 1 ? "" : "s"} in ${t.cycles} clocks: the first result leaves ${t.latency} clocks after its target came in, ` +
    `then ${short(count / (t.cycles - t.latency))} a clock.`;
}

// -- what moves it --------------------------------------------------------------------------

function draw() {
  drawScene();
  drawErrors();
  drawPipeline();
  writeNow();
  const root = document.documentElement;
  root.dataset.fits = root.scrollWidth <= root.clientWidth;
  root.dataset.width = root.clientWidth;
}

function go(n) {
  state.at = Math.max(0, Math.min(state.shown.target.length - 1, Math.round(n)));
  draw();
}

function frame(time) {
  if (!state.playing) {
    return;
  }
  // The clock starts with the first frame; a tab that was hidden does not jump.
  const elapsed = Math.min(0.25, (time - (state.last ?? time)) / 1000);
  state.last = time;
  state.owed += elapsed * RATE * Number(element("speed").value);
  const steps = Math.floor(state.owed);
  if (steps > 0) {
    state.owed -= steps;
    go((state.at + steps) % state.shown.target.length); // the motion starts again at its end
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
  go(state.at + by);
}

function show(name) {
  state.shown = DATA.find((t) => t.name === name) || DATA[0];
  state.bounds = bounds(state.shown);
  element("trajectory").value = state.shown.name;
  writeTrajectory();
  go(0);
}

function listen() {
  element("play").addEventListener("click", () => play(!state.playing));
  element("back").addEventListener("click", () => step(-1));
  element("next").addEventListener("click", () => step(1));
  element("scrub").addEventListener("input", (event) => step(Number(event.target.value) - state.at));
  element("trajectory").addEventListener("change", (event) => show(event.target.value));
  const resetView = () => {
    state.view = { ...VIEW };
    draw();
  };
  element("view").addEventListener("click", resetView);

  const last = () => state.shown.target.length - 1;
  const keys = {
    " ": () => play(!state.playing),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => step(-state.at),
    End: () => step(last()),
    v: resetView,
  };
  document.addEventListener("keydown", (event) => {
    // Fields and buttons have their own use for these keys.
    const taken = event.target.closest?.("select, input") || (event.key === " " && event.target.closest?.("button"));
    if (keys[event.key] && !taken && !event.ctrlKey && !event.altKey && !event.metaKey) {
      event.preventDefault();
      keys[event.key]();
    }
  });

  scene.addEventListener("pointerdown", (event) => scene.setPointerCapture(event.pointerId));
  scene.addEventListener("pointermove", (event) => {
    if (scene.hasPointerCapture(event.pointerId)) {
      state.view.azimuth -= event.movementX * 0.01;
      state.view.elevation = Math.max(-0.2, Math.min(1.55, state.view.elevation + event.movementY * 0.01));
      drawScene();
    }
  });

  const seek = (canvas, target) =>
    canvas.addEventListener("click", (event) => {
      const inside = (event.offsetX - MARGIN.left) / (canvas.clientWidth - MARGIN.left - MARGIN.right);
      step(target(inside) - state.at);
    });
  seek(element("hand"), (inside) => inside * last());
  seek(element("angles"), (inside) => inside * last());
  seek(element("pipeline"), (inside) => inside * state.shown.cycles - state.shown.latency);

  window.addEventListener("resize", draw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    draw();
  });
}

// #trajectory=punch&target=40: there, and at rest; else it plays, unless the reader's system asks for less motion.
function start() {
  const options = new URLSearchParams(location.hash.slice(1));
  element("trajectory").replaceChildren(
    ...DATA.map((t) => new Option(t.passed ? t.name : `${t.name} (FAIL)`, t.name)),
  );
  element("trajectory").disabled = DATA.length === 1;
  readColours();
  listen();
  show(options.get("trajectory"));
  if (options.has("target")) {
    go(Number(options.get("target")) || 0);
  } else {
    play(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
}

start();
