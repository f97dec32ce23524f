// SPDX-License-Identifier: Apache-2.0
// Vectors, text, canvases and the drawn arm for report and playground. Each page defines `state` with its colours, view and runs.

const VIEW = { azimuth: -0.95, elevation: 0.3 }; // from the front right, a little above
const element = (id) => document.getElementById(id);
const scene = element("scene");

// -- vectors --------------------------------------------------------------------------------

const sum = (a, b, k = 1) => a.map((v, i) => v + k * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => a.map((v) => v / (length(a) || 1));

// -- numbers as text ------------------------------------------------------------------------

const short = (v) => v.toPrecision(5).replace(/\.?0+$/, "");
const error = (v) => v.toExponential(1);
const signed = (v) => (v < 0 ? "\u2212" : "+") + Math.abs(v).toFixed(6);

// Returns the elements of a list of names and values; an entry with a run number is the heading of that run's entries.
function rows(list) {
  return list.flatMap(([name, value, run]) => {
    const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
    if (run !== undefined) { // datapath name
      dt.className = "badge";
      dt.dataset.run = run;
    }
    dt.textContent = name;
    dd.textContent = value;
    return [dt, dd];
  });
}

// Returns a round tick step that gives at most `most` ticks.
function tickStep(range, most) {
  const raw = range / Math.max(1, most);
  const unit = 10 ** Math.floor(Math.log10(raw));
  return unit * [1, 2, 5, 10].find((k) => k * unit >= raw * 0.9999);
}

// -- canvases -------------------------------------------------------------------------------

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["card", "text", "soft", "line", "grid", "upper", "fore", "joint", "goal", "elbow", "plane", "ghost", "body", "middle", "good", "bad", "run0", "run1", "run2"]) {
    state.colours[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

// Returns a cleared context in CSS pixels at the screen's resolution.
function prepare(canvas) {
  const [w, h] = [canvas.clientWidth, canvas.clientHeight];
  const scale = window.devicePixelRatio || 1;
  const [pixelsW, pixelsH] = [Math.round(w * scale), Math.round(h * scale)];
  if (canvas.width !== pixelsW || canvas.height !== pixelsH) {
    canvas.width = pixelsW;
    canvas.height = pixelsH;
  }
  const g = context(canvas, scale);
  g.clearRect(0, 0, w, h);
  return { g, w, h };
}

function context(canvas, scale) {
  const g = canvas.getContext("2d");
  g.setTransform(scale, 0, 0, scale, 0, 0);
  g.font = "12.5px system-ui, sans-serif";
  g.lineCap = g.lineJoin = "round";
  return g;
}

// Draws the static part of a canvas once with still(g, w, h), and caches the picture and the returned values.
const stills = new Map();
function prepareOver(canvas, still) {
  const { g, w, h } = prepare(canvas);
  const key = [state.shown.name, state.arm, canvas.width, canvas.height, w, state.colours.card].join();
  if (stills.get(canvas)?.key !== key) {
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    stills.set(canvas, { key, copy, found: still(context(copy, canvas.width / w), w, h) });
  }
  const { copy, found } = stills.get(canvas);
  if (copy.width && copy.height) { // empty before the page is laid out
    g.drawImage(copy, 0, 0, w, h);
  }
  return { g, w, h, ...found };
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

// Draws a part of the picture per run with part(w, h, run), side by side or stacked.
function eachRun(g, w, h, part) {
  const count = state.runs.length;
  const top = count > 1 ? 32 : 0;
  const beside = w > 1.2 * h;
  const [width, height] = beside ? [w / count, h] : [w, h / count];
  state.runs.forEach((t, i) => {
    const [x, y] = beside ? [i * width, 0] : [0, i * height];
    state.parts[i] = { x, y: y + top, w: width, h: height - top };
    g.save();
    g.translate(x, y);
    if (top) {
      badge(g, `${t.datapath}, ${t.latency} clocks, hand error ${error(t.hand[state.at])}`, i);
    }
    g.translate(0, top);
    g.beginPath();
    g.rect(0, 0, width, height - top);
    g.clip();
    part(width, height - top, t);
    g.restore();
  });
}

function badge(g, string, run) {
  g.fillStyle = state.colours[`run${run}`];
  g.fillRect(4, 4, g.measureText(string).width + 16, 24);
  g.textAlign = "left";
  g.textBaseline = "middle";
  g.fillStyle = "#ffffff";
  g.fillText(string, 12, 16.5);
}

// Draws the ring around the target.
function ring(g, p, radius) {
  g.beginPath();
  g.arc(p[0], p[1], radius, 0, 2 * Math.PI);
  g.strokeStyle = state.colours.goal;
  g.lineWidth = 2.5;
  g.stroke();
}

function text(g, string, x, y, colour, align = "left") {
  g.textAlign = align;
  g.textBaseline = "middle";
  g.lineWidth = 4;
  g.strokeStyle = state.colours.card; // halo, for legibility on any background
  g.strokeText(string, x, y);
  g.fillStyle = colour;
  g.fillText(string, x, y);
}

// -- the arm --------------------------------------------------------------------------------

// Returns the corners of the bounding box of points.
function box(points) {
  const low = [...points[0]];
  const high = [...points[0]];
  for (const p of points) {
    p.forEach((v, i) => {
      low[i] = Math.min(low[i], v);
      high[i] = Math.max(high[i], v);
    });
  }
  return [low, high];
}

// Returns the bounding sphere of the whole motion and its shadow on the floor; constant during the motion.
function bounds(t) {
  const points = [[0, 0, 0], ...t.target, ...t.elbow, ...t.wrist, ...(t.hands?.goal ?? []), ...(t.hands?.point ?? [])];
  const [low, high] = box(points);
  low[2] -= 0.06 * length(sum(high, low, -1));
  const floor = low[2];
  const centre = sum(low, high).map((v) => v / 2);
  const far = (p) => Math.max(length(sum(p, centre, -1)), length(sum([p[0], p[1], floor], centre, -1)));
  const radius = points.reduce((most, p) => Math.max(most, far(p)), 0);
  const step = 10 ** Math.floor(Math.log10(radius));
  return { centre, radius, floor, step: radius / step < 2.5 ? step / 2 : step };
}

function camera(w, h, bounds, view) {
  const { centre, radius } = bounds;
  const { azimuth: a, elevation: e } = view;
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
  const eye = sum(centre, toward, distance);
  return { project, depth, scale, direction, bounds, eye, right, up, distance };
}

function drawFloor(g, project, { centre, radius, floor, step }) {
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

// Draws the target's x, y and z axes in the corner.
function drawAxes(g, direction, h, place) {
  const origin = [44, h - 40];
  [0, 1, 2].forEach((i) => {
    const d = direction(place.map((row) => row[i]));
    line(g, [origin, sum(origin, d, 24)], state.colours.soft, 1.5);
    text(g, "xyz"[i], ...sum(origin, d, 34), state.colours.soft, "center");
  });
}

function patch(g, corners, colour) {
  g.beginPath();
  corners.forEach((c) => g.lineTo(c[0], c[1]));
  g.closePath();
  g.globalAlpha = 0.18;
  g.fillStyle = colour;
  g.fill();
  g.globalAlpha = 0.7;
  line(g, [...corners, corners[0]], colour, 1);
  g.globalAlpha = 1;
}

// Draws the swivel plane around the arm: u points to the wrist, the elbow is on the +m side.
function drawPlane(g, project, t, n) {
  const p = t.target[n];
  const size = t.lengths[n][0] + t.lengths[n][1];
  const u = length(p) > 0 ? p.map((v) => v / length(p)) : [0, 0, 1];
  const m = cross(t.normal[n], u);
  const along = [0, dot(t.elbow[n], u), dot(t.wrist[n], u)];
  const [from, to] = [Math.min(...along) - 0.08 * size, Math.max(...along) + 0.08 * size];
  const [below, above] = [-0.08 * size, Math.max(0, dot(t.elbow[n], m)) + 0.08 * size];
  const corner = (a, b) => project(u.map((v, i) => a * v + b * m[i]));
  patch(g, [corner(from, below), corner(to, below), corner(to, above), corner(from, above)], state.colours.plane);
  g.globalAlpha = 0.6;
  line(g, [project([0, 0, 0]), project(p)], state.colours.plane, 1.2, [4, 4]);
  g.globalAlpha = 1;
}

// Draws the circle on which the elbow swivels, thick where all joints are within their limits.
function drawSwivel(g, project, t, n) {
  const u = unit(t.target[n]);
  const m = cross(t.normal[n], u);
  const centre = u.map((v) => v * dot(t.elbow[n], u));
  const radius = dot(t.elbow[n], m);
  const at = (phi) => {
    const angle = (phi * Math.PI) / 180 - t.phi[n];
    return project(sum(sum(centre, m, radius * Math.cos(angle)), cross(u, m), radius * Math.sin(angle)));
  };
  const path = (from, to) => Array.from({ length: 73 }, (_, i) => at(from + ((to - from) * i) / 72));
  line(g, path(-180, 180), state.colours.bad, 1.2, [3, 4]);
  t.hands.free[n].forEach(([from, to]) => line(g, path(from, to), state.colours.good, 3));
}

// Draws the hand from wrist to point with its x, y and z axes.
function drawHand(g, project, t, n, thick) {
  const { goal, point, turn: [[w, ...v]] } = { ...t.hands, turn: [t.hands.turn[n]] };
  const { colours: c } = state;
  const size = 0.22 * (t.lengths[n][0] + t.lengths[n][1]);
  const rotated = (p) => {
    const twice = cross(v, p).map((x) => 2 * x);
    return sum(sum(p, twice, w), cross(v, twice));
  };
  for (const [width, colour] of [[0.55 * thick + 3, c.card], [0.55 * thick, c.body]]) {
    line(g, [t.wrist[n], point[n]].map(project), colour, width);
  }
  [[c.bad, [1, 0, 0]], [c.good, [0, 1, 0]], [c.upper, [0, 0, 1]]].forEach(([colour, axis], i) => {
    const end = rotated(axis);
    line(g, [point[n], sum(point[n], end, size)].map(project), colour, 2.5);
    text(g, "xyz"[i], ...project(sum(point[n], end, 1.2 * size)), colour, "center");
  });
  ring(g, project(goal[n]), 0.35 * thick + 3);
}

function drawPaths(g, project, t, arm, n) {
  const mine = t.arm.map((a, i) => i).filter((i) => t.arm[i] === arm);
  const path = (points, upTo) => mine.filter((i) => i <= upTo).map((i) => project(points[i]));
  line(g, path(t.elbow, t.arm.length), state.colours.elbow, 1, [2, 4]);
  line(g, path(t.elbow, n), state.colours.elbow, 2);
  const targets = path(t.hands?.goal ?? t.target, t.arm.length);
  if (targets.length <= 400) {
    targets.forEach((p) => disc(g, p, 1.3, state.colours.goal));
  }
  line(g, targets, state.colours.goal, 0.8);
  line(g, path(t.hands?.point ?? t.wrist, n), state.colours.goal, 2.5);
}

function drawArm(g, view, t, n, labelled) {
  const { project, scale, bounds: { floor } } = view;
  const joints = [[0, 0, 0], t.elbow[n], t.wrist[n]];
  const thick = Math.max(5, 0.05 * scale * (t.lengths[n][0] + t.lengths[n][1]));
  g.globalAlpha = 0.25; // shadow, as a depth cue
  line(g, joints.map((p) => project([p[0], p[1], floor])), state.colours.joint, 0.6 * thick);
  line(g, [joints[2], [t.wrist[n][0], t.wrist[n][1], floor]].map(project), state.colours.joint, 1, [2, 3]);
  return { points: drawLimbs(g, view, joints, thick, labelled ? 1 : 0.4), thick };
}

function drawLimbs(g, { project, depth }, joints, thick, alpha) {
  const points = joints.map(project);
  g.globalAlpha = alpha;
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
  return points;
}

// Draws the joint names: the elbow's on the outside of the bend, the others beyond the ends of the arm.
function drawNames(g, w, { points, thick }, goal) {
  const [shoulder, elbow, wrist] = points;
  const chord = unit(sum(wrist, shoulder, -1));
  const normal = [-chord[1], chord[0]];
  const bend = normal[0] * (elbow[0] - shoulder[0]) + normal[1] * (elbow[1] - shoulder[1]);
  const side = Math.abs(bend) > 2 ? Math.sign(bend) : normal[1] < 0 ? -1 : 1; // below a straight arm
  const ways = [unit(sum([-chord[0], -chord[1]], [0, -0.8])), normal.map((v) => side * v), unit(sum(chord, [0, -0.8]))];
  ["shoulder", "elbow", ...(goal ? ["wrist"] : [])].forEach((name, i) => { // a hand has its own axes there
    const [x, y] = sum(points[i], ways[i], 0.6 * thick + 14);
    const half = g.measureText(name).width / 2;
    const shifted = x + half * Math.max(-1, Math.min(1, 2 * ways[i][0]));
    text(g, name, Math.max(half + 4, Math.min(w - half - 4, shifted)), y, state.colours.text, "center");
  });
  if (goal) {
    ring(g, goal, 0.45 * thick + 3);
  }
}

function drawScene() {
  const { g, w, h } = prepare(scene);
  eachRun(g, w, h, (w, h, t) => (t.clip ? drawFigure : drawMotion)(g, w, h, t));
}

function drawMotion(g, w, h, t) {
  const { at: n } = state;
  const view = camera(w, h, state.bounds, state.view);
  drawFloor(g, view.project, view.bounds);
  drawAxes(g, view.direction, h, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
  drawPlane(g, view.project, t, n);
  const arms = [...new Set(t.arm)].filter((arm) => arm !== t.arm[n]);
  for (const arm of [...arms, t.arm[n]]) {
    drawPaths(g, view.project, t, arm, n);
  }
  if (t.hands?.free) {
    drawSwivel(g, view.project, t, n);
  }
  for (const arm of arms) {
    const last = t.arm.lastIndexOf(arm, n); // last pose of the other arm
    drawArm(g, view, t, last < 0 ? t.arm.indexOf(arm) : last, false);
  }
  const drawn = drawArm(g, view, t, n, true);
  if (t.hands) {
    drawHand(g, view.project, t, n, drawn.thick);
  }
  drawNames(g, w, drawn, t.hands ? null : view.project(t.target[n]));
}
