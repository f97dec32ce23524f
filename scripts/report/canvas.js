// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts canvas.js, arm.js, plots.js and report.js into one function.

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
