// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts canvas.js, arm.js, plots.js and report.js into one function.

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
  const asked = t.bar === null ? [] : [{ name: "asked", values: t.hand.map(() => t.bar), colour: c.text, width: 2 }];
  const predicted = { name: "predicted", values: t.predicted, colour: c.elbow, width: 1.5, dash: [5, 4] };
  const limits = [...asked, predicted];
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
