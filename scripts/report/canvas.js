// SPDX-License-Identifier: Apache-2.0
// Vectors, text and canvases for report and playground. Each page defines `state` with its colours, view and runs.

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
  for (const name of ["card", "text", "soft", "line", "grid", "upper", "fore", "joint", "goal", "elbow", "plane", "ghost", "body", "middle", "run0", "run1", "run2"]) {
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
