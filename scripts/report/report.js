// The page of scripts/report/page.py: draws what stands in the element `data`, on plain canvases.
(() => {
  "use strict";

  const DATA = JSON.parse(document.getElementById("data").textContent).trajectories;
  const RATE = 20; // targets a second at speed 1
  const VIEW = { azimuth: -0.95, elevation: 0.3 }; // from the front right, a little above
  const element = (id) => document.getElementById(id);
  const scene = element("scene");
  const state = { shown: null, at: 0, playing: false, last: null, view: { ...VIEW }, colours: {} };

  // -- vectors --------------------------------------------------------------------------------

  const sum = (a, b, k = 1) => a.map((v, i) => v + k * b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = (a) => Math.hypot(...a);

  // -- numbers as text ------------------------------------------------------------------------

  const short = (v) => v.toPrecision(5).replace(/\.?0+$/, "");
  const error = (v) => v.toExponential(1);
  const signed = (v) => (v < 0 ? "\u2212" : "+") + Math.abs(v).toFixed(6);

  // -- canvases -------------------------------------------------------------------------------

  function readColours() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["card", "text", "soft", "line", "grid", "upper", "fore", "joint", "goal", "elbow", "plane"]) {
      state.colours[name] = style.getPropertyValue(`--${name}`).trim();
    }
  }

  // A cleared context in CSS pixels, sharp on dense screens.
  function prepare(canvas) {
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    const scale = window.devicePixelRatio || 1;
    const [pixelsW, pixelsH] = [Math.round(w * scale), Math.round(h * scale)];
    if (canvas.width !== pixelsW || canvas.height !== pixelsH) {
      canvas.width = pixelsW;
      canvas.height = pixelsH;
    }
    const g = canvas.getContext("2d");
    g.setTransform(scale, 0, 0, scale, 0, 0);
    g.clearRect(0, 0, w, h);
    g.font = "12.5px system-ui, sans-serif";
    g.lineCap = g.lineJoin = "round";
    return { g, w, h };
  }

  function line(g, points, colour, width, dash = []) {
    g.beginPath();
    points.forEach((p, i) => (i ? g.lineTo(p[0], p[1]) : g.moveTo(p[0], p[1])));
    g.setLineDash(dash);
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.stroke();
    g.setLineDash([]);
  }

  function disc(g, p, radius, colour) {
    g.beginPath();
    g.arc(p[0], p[1], radius, 0, 2 * Math.PI);
    g.fillStyle = colour;
    g.fill();
  }

  function text(g, string, x, y, colour, align = "left") {
    g.textAlign = align;
    g.textBaseline = "middle";
    g.lineWidth = 4;
    g.strokeStyle = state.colours.card; // a halo: legible on whatever lies below
    g.strokeText(string, x, y);
    g.fillStyle = colour;
    g.fillText(string, x, y);
  }

  // -- the arm --------------------------------------------------------------------------------

  // The sphere that holds all the motion and its shadow on the floor. It does not change while the arm moves.
  function bounds(t) {
    const low = [0, 0, 0];
    const high = [0, 0, 0];
    const points = [[0, 0, 0], ...t.target, ...t.elbow, ...t.wrist];
    for (const p of points) {
      p.forEach((v, i) => {
        low[i] = Math.min(low[i], v);
        high[i] = Math.max(high[i], v);
      });
    }
    low[2] -= 0.06 * length(sum(high, low, -1));
    const floor = low[2];
    const centre = sum(low, high).map((v) => v / 2);
    const far = (p) => Math.max(length(sum(p, centre, -1)), length(sum([p[0], p[1], floor], centre, -1)));
    const radius = points.reduce((most, p) => Math.max(most, far(p)), 0);
    const step = 10 ** Math.floor(Math.log10(radius));
    return { centre, radius, floor, step: radius / step < 2.5 ? step / 2 : step };
  }

  function camera(w, h) {
    const { centre, radius } = state.bounds;
    const { azimuth: a, elevation: e } = state.view;
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const distance = 5 * radius;
    const scale = (0.43 * Math.min(w, 1.1 * h)) / radius;
    const depth = (p) => distance - dot(sum(p, centre, -1), toward);
    const project = (p) => {
      const q = sum(p, centre, -1);
      const k = (scale * distance) / depth(p);
      return [w / 2 + k * dot(q, right), h / 2 - k * dot(q, up)];
    };
    const direction = (v) => [dot(v, right), -dot(v, up)];
    return { project, depth, scale, direction };
  }

  function drawFloor(g, project) {
    const { centre, radius, floor, step } = state.bounds;
    const count = Math.ceil((1.1 * radius) / step);
    const middle = [Math.round(centre[0] / step) * step, Math.round(centre[1] / step) * step];
    const reach = count * step;
    for (let i = -count; i <= count; i++) {
      for (const axis of [0, 1]) {
        const ends = [-reach, reach].map((v) => {
          const p = [middle[0] + v, middle[1] + v, floor];
          p[axis] = middle[axis] + i * step;
          return project(p);
        });
        line(g, ends, state.colours.grid, 0.6);
      }
    }
  }

  // Which way x, y and z go, in the corner.
  function drawAxes(g, direction, h) {
    const origin = [44, h - 40];
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, i) => {
      const d = direction(axis);
      line(g, [origin, sum(origin, d, 24)], state.colours.soft, 1.5);
      text(g, "xyz"[i], ...sum(origin, d, 34), state.colours.soft, "center");
    });
  }

  // The part of the swivel plane around the arm: u is the line to the wrist, the elbow is on the side +m of it.
  function drawPlane(g, project, t, n) {
    const p = t.target[n];
    const size = t.lengths[n][0] + t.lengths[n][1];
    const u = length(p) > 0 ? p.map((v) => v / length(p)) : [0, 0, 1];
    const m = cross(t.normal[n], u);
    const along = [0, dot(t.elbow[n], u), dot(t.wrist[n], u)];
    const [from, to] = [Math.min(...along) - 0.08 * size, Math.max(...along) + 0.08 * size];
    const [below, above] = [-0.08 * size, Math.max(0, dot(t.elbow[n], m)) + 0.08 * size];
    const corner = (a, b) => project(u.map((v, i) => a * v + b * m[i]));
    const corners = [corner(from, below), corner(to, below), corner(to, above), corner(from, above)];
    g.beginPath();
    corners.forEach((c) => g.lineTo(c[0], c[1]));
    g.closePath();
    g.globalAlpha = 0.18;
    g.fillStyle = state.colours.plane;
    g.fill();
    g.globalAlpha = 0.7;
    line(g, [...corners, corners[0]], state.colours.plane, 1);
    g.globalAlpha = 0.6;
    line(g, [project([0, 0, 0]), project(p)], state.colours.plane, 1.2, [4, 4]);
    g.globalAlpha = 1;
  }

  function drawPaths(g, project, t, arm, n) {
    const mine = t.arm.map((a, i) => i).filter((i) => t.arm[i] === arm);
    const path = (points, upTo) => mine.filter((i) => i <= upTo).map((i) => project(points[i]));
    line(g, path(t.elbow, t.arm.length), state.colours.elbow, 1, [2, 4]);
    line(g, path(t.elbow, n), state.colours.elbow, 2);
    const targets = path(t.target, t.arm.length);
    if (targets.length <= 400) {
      targets.forEach((p) => disc(g, p, 1.3, state.colours.goal));
    }
    line(g, targets, state.colours.goal, 0.8);
    line(g, path(t.wrist, n), state.colours.goal, 2.5);
  }

  function drawArm(g, { project, depth, scale }, t, n, labelled) {
    const { floor } = state.bounds;
    const joints = [[0, 0, 0], t.elbow[n], t.wrist[n]];
    const points = joints.map(project);
    const thick = Math.max(5, 0.05 * scale * (t.lengths[n][0] + t.lengths[n][1]));
    g.globalAlpha = 0.25; // the shadow, which shows where in depth the arm is
    line(g, joints.map((p) => project([p[0], p[1], floor])), state.colours.joint, 0.6 * thick);
    line(g, [points[2], project([t.wrist[n][0], t.wrist[n][1], floor])], state.colours.joint, 1, [2, 3]);
    g.globalAlpha = labelled ? 1 : 0.4;
    const limbs = [
      { ends: points.slice(0, 2), colour: state.colours.upper, width: thick, far: depth(joints[0]) + depth(joints[1]) },
      { ends: points.slice(1), colour: state.colours.fore, width: 0.8 * thick, far: depth(joints[1]) + depth(joints[2]) },
    ];
    limbs.sort((a, b) => b.far - a.far);
    for (const limb of limbs) {
      line(g, limb.ends, state.colours.card, limb.width + 3);
      line(g, limb.ends, limb.colour, limb.width);
    }
    points.forEach((p, i) => {
      disc(g, p, (i === 2 ? 0.32 : 0.48) * thick, state.colours.card);
      disc(g, p, (i === 2 ? 0.22 : 0.34) * thick, state.colours.joint);
    });
    g.globalAlpha = 1;
    return { points, thick };
  }

  // Names stand off the arm: that of the elbow on the outside of its bend, the others beyond the ends.
  function drawNames(g, w, { points, thick }, goal) {
    const unit = (v) => v.map((c) => c / (length(v) || 1));
    const [shoulder, elbow, wrist] = points;
    const chord = unit(sum(wrist, shoulder, -1));
    const normal = [-chord[1], chord[0]];
    const bend = normal[0] * (elbow[0] - shoulder[0]) + normal[1] * (elbow[1] - shoulder[1]);
    const side = Math.abs(bend) > 2 ? Math.sign(bend) : normal[1] < 0 ? -1 : 1; // a straight arm: below it
    const ways = [unit(sum([-chord[0], -chord[1]], [0, -0.8])), normal.map((v) => side * v), unit(sum(chord, [0, -0.8]))];
    ["shoulder", "elbow", "wrist"].forEach((name, i) => {
      const [x, y] = sum(points[i], ways[i], 0.6 * thick + 14);
      const half = g.measureText(name).width / 2;
      const shifted = x + half * Math.max(-1, Math.min(1, 2 * ways[i][0]));
      text(g, name, Math.max(half + 4, Math.min(w - half - 4, shifted)), y, state.colours.text, "center");
    });
    g.beginPath();
    g.arc(goal[0], goal[1], 0.45 * thick + 3, 0, 2 * Math.PI);
    g.strokeStyle = state.colours.goal;
    g.lineWidth = 2.5;
    g.stroke();
  }

  function drawScene() {
    const { shown: t, at: n } = state;
    const { g, w, h } = prepare(scene);
    const view = camera(w, h);
    drawFloor(g, view.project);
    drawAxes(g, view.direction, h);
    drawPlane(g, view.project, t, n);
    const arms = [...new Set(t.arm)].filter((arm) => arm !== t.arm[n]);
    for (const arm of [...arms, t.arm[n]]) {
      drawPaths(g, view.project, t, arm, n);
    }
    for (const arm of arms) {
      const last = t.arm.lastIndexOf(arm, n); // where the other arm was left
      drawArm(g, view, t, last < 0 ? t.arm.indexOf(arm) : last, false);
    }
    drawNames(g, w, drawArm(g, view, t, n, true), view.project(t.target[n]));
  }

  // -- plots ----------------------------------------------------------------------------------

  const MARGIN = { left: 46, right: 12, top: 22, bottom: 34 };

  function plotFrame(canvas, xMax, xName) {
    const { g, w, h } = prepare(canvas);
    const x = (v) => MARGIN.left + (v / xMax) * (w - MARGIN.left - MARGIN.right);
    const bottom = h - MARGIN.bottom;
    const most = Math.max(2, Math.floor(w / 90));
    const raw = xMax / most;
    const unit = 10 ** Math.floor(Math.log10(raw));
    const step = Math.max(1, unit * [1, 2, 5, 10].find((k) => k * unit >= raw));
    for (let v = 0; v <= xMax; v += step) {
      line(g, [[x(v), MARGIN.top], [x(v), bottom]], state.colours.line, 0.6);
      text(g, String(v), x(v), bottom + 10, state.colours.soft, "center");
    }
    text(g, xName, (MARGIN.left + w - MARGIN.right) / 2, h - 8, state.colours.soft, "center");
    return { g, w, h, x, bottom };
  }

  // series: [{ name, values, colour, width, dash, dots }]
  function drawLog(canvas, series) {
    const count = state.shown.target.length;
    const { g, w, x, bottom } = plotFrame(canvas, Math.max(1, count - 1), "target");
    let [low, high] = [Infinity, 0];
    for (const { values } of series) {
      for (const v of values) {
        low = v > 0 ? Math.min(low, v) : low;
        high = Math.max(high, v);
      }
    }
    // Errors of 0 have no place on a log scale: they lie on its lower edge.
    const from = Number.isFinite(low) ? Math.floor(Math.log10(low)) : -12;
    const to = Math.max(from + 1, high > 0 ? Math.ceil(Math.log10(high) + 0.1) : from + 1);
    const y = (v) => bottom - ((Math.log10(Math.max(v, 10 ** from)) - from) / (to - from)) * (bottom - MARGIN.top);
    const every = Math.ceil((to - from) / ((bottom - MARGIN.top) / 22));
    for (let k = from; k <= to; k += every) {
      line(g, [[MARGIN.left, y(10 ** k)], [w - MARGIN.right, y(10 ** k)]], state.colours.line, 0.6);
      text(g, `1e${k}`, MARGIN.left - 6, y(10 ** k), state.colours.soft, "right");
    }
    for (const { values, colour, width, dash, dots } of series) {
      const points = values.map((v, i) => [x(count > 1 ? i : 0.5), y(v)]);
      line(g, points.length > 1 ? points : [[x(0), points[0][1]], [x(1), points[0][1]]], colour, dots ? 1 : width, dash);
      if (dots && count <= 400) {
        points.forEach((p) => disc(g, p, 2.2, colour));
      }
    }
    const now = x(count > 1 ? state.at : 0.5);
    line(g, [[now, MARGIN.top], [now, bottom]], state.colours.goal, 1);
    series.forEach(({ values, colour }) => disc(g, [now, y(values[state.at])], 4, colour));
    let left = MARGIN.left;
    for (const { name, colour, dash } of series) {
      line(g, [[left, 9], [left + 18, 9]], colour, 2.5, dash);
      text(g, name, left + 24, 9, state.colours.text);
      left += g.measureText(name).width + 38;
    }
  }

  function drawErrors() {
    const { shown: t, colours: c } = state;
    const limits = t.fixedBar
      ? [
          { name: "bar", values: t.bar, colour: c.text, width: 2 },
          { name: "predicted", values: t.predicted, colour: c.elbow, width: 1.5, dash: [5, 4] },
        ]
      : [{ name: "bar = predicted", values: t.bar, colour: c.elbow, width: 2 }];
    drawLog(element("hand"), [...limits, { name: "hand", values: t.hand, colour: c.fore, dots: true }]);
    drawLog(element("angles"), [
      { name: "shoulder", values: t.shoulderAngle, colour: c.upper, dots: true },
      { name: "elbow", values: t.elbowAngle, colour: c.fore, dots: true },
    ]);
  }

  // A line of a target: in at clock i, out `latency` later. What is between the two edges is in the pipeline.
  function drawPipeline() {
    const { shown: t, colours: c, at } = state;
    const count = t.target.length;
    const { g, w, x, bottom } = plotFrame(element("pipeline"), t.cycles, "clock");
    const enters = (i) => i;
    const leaves = (i) => t.latency + (i * (t.cycles - t.latency)) / count;
    const split = bottom - 0.28 * (bottom - MARGIN.top); // above: every target; below: how many are inside
    const top = MARGIN.top + 30;
    const y = (i) => top + ((split - 26 - top) * i) / Math.max(1, count);
    const clock = leaves(at);
    const corners = [[x(enters(0)), y(0)], [x(leaves(0)), y(0)], [x(leaves(count)), y(count)], [x(enters(count)), y(count)]];
    g.beginPath();
    corners.forEach((p) => g.lineTo(...p));
    g.closePath();
    g.globalAlpha = 0.22;
    g.fillStyle = c.upper;
    g.fill();
    g.globalAlpha = 1;
    line(g, [corners[3], corners[0]], c.upper, 2.5);
    line(g, [corners[1], corners[2]], c.fore, 2.5);
    line(g, [[x(enters(at)), y(at + 0.5)], [x(leaves(at)), y(at + 0.5)]], c.goal, 2);
    disc(g, [x(enters(at)), y(at + 0.5)], 4, c.goal);
    disc(g, [x(leaves(at)), y(at + 0.5)], 4, c.goal);

    const arrow = top - 8;
    line(g, [[x(0), arrow], [x(t.latency), arrow]], c.text, 1);
    for (const end of [0, t.latency]) {
      line(g, [[x(end), arrow - 4], [x(end), arrow + 4]], c.text, 1);
    }
    const latency = `latency ${t.latency} clocks`;
    const half = g.measureText(latency).width / 2;
    text(g, latency, Math.max(x(t.latency / 2), MARGIN.left + half), arrow - 10, c.text, "center");

    // Targets inside at a clock: rises until the last is in, falls from the first out.
    const inside = (v) => Math.min(count, v) - Math.max(0, ((v - t.latency) * count) / (t.cycles - t.latency));
    const most = inside(Math.min(count, t.latency));
    const fill = (v) => bottom - (inside(v) / most) * (bottom - split) * 0.8;
    const until = (last) => [0, Math.min(count, t.latency), Math.max(count, t.latency), t.cycles].filter((v) => v < last).concat(last);
    const outline = until(t.cycles).map((v) => [x(v), fill(v)]);
    line(g, outline, c.soft, 1);
    g.beginPath();
    [...until(clock).map((v) => [x(v), fill(v)]), [x(clock), bottom], [x(0), bottom]].forEach((p) => g.lineTo(...p));
    g.globalAlpha = 0.3;
    g.fillStyle = c.upper;
    g.fill();
    g.globalAlpha = 1;
    line(g, [[x(clock), top], [x(clock), bottom]], c.goal, 1);
    text(g, `inside the pipeline: at most ${most}`, MARGIN.left, split - 8, c.text);
    text(g, String(most), MARGIN.left - 6, fill(Math.min(count, t.latency)), c.soft, "right");
    text(g, "0", MARGIN.left - 6, bottom, c.soft, "right");

    line(g, [[MARGIN.left, 9], [MARGIN.left + 18, 9]], c.upper, 2.5);
    text(g, "targets in", MARGIN.left + 24, 9, c.text);
    line(g, [[MARGIN.left + 98, 9], [MARGIN.left + 116, 9]], c.fore, 2.5);
    text(g, "results out", MARGIN.left + 122, 9, c.text);
    text(g, "target", MARGIN.left - 6, top + 4, c.soft, "right");
    text(g, String(count - 1), MARGIN.left - 6, y(count), c.soft, "right");
  }

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
        ["bar, predicted", `${error(t.bar[n])}, ${error(t.predicted[n])}`],
      ]),
    );
  }

  function writeTrajectory() {
    const t = state.shown;
    element("about").textContent = t.about;
    element("scrub").max = t.target.length - 1;
    element("verdict").textContent = t.passed ? "pass" : "FAIL";
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
})();
