// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/__main__.py, which puts the scripts of this folder into one function.

// -- plots ----------------------------------------------------------------------------------

const MARGIN = { left: 66, right: 14, top: 24, bottom: 36 };

const tickText = (v, step) => v.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));

// Returns the horizontal axis: target number, or the time of a clip.
function across() {
  const t = state.shown;
  const frames = framesIn(t);
  return t.clip
    ? { count: frames, unit: 1 / t.clip.rate, name: "time (s)", least: 0 }
    : { count: frames, unit: 1, name: "target (number)", least: 1 };
}

function upright(g, string, x, y) {
  g.save();
  g.translate(x, y);
  g.rotate(-Math.PI / 2);
  text(g, string, 0, 0, state.colours.soft, "center");
  g.restore();
}

// Draws axes with names, x from 0 to xMax. Returns the mapping of x to the canvas and the bottom edge.
function plotAxes(g, w, h, xMax, xName, yName, least = 1) {
  const x = (v) => MARGIN.left + (v / xMax) * (w - MARGIN.left - MARGIN.right);
  const bottom = h - MARGIN.bottom;
  const step = Math.max(least, tickStep(xMax, Math.floor(w / 90)));
  for (let v = 0; v <= xMax * 1.0001; v += step) {
    line(g, [[x(v), MARGIN.top], [x(v), bottom]], state.colours.line, 0.6);
    text(g, tickText(v, step), x(v), bottom + 11, state.colours.soft, "center");
  }
  text(g, xName, (MARGIN.left + w - MARGIN.right) / 2, h - 9, state.colours.soft, "center");
  if (yName) {
    upright(g, yName, 10, (MARGIN.top + bottom) / 2);
  }
  return { x, bottom };
}

function writeKey(g, series) {
  let left = MARGIN.left;
  for (const { name, colour, dash } of series.filter((one) => one.name)) {
    line(g, [[left, 9], [left + 18, 9]], colour, 2.5, dash);
    text(g, name, left + 24, 9, state.colours.text);
    left += g.measureText(name).width + 38;
  }
}

// Returns the values of the selected arm, one per frame.
const ofArm = (values) => values.filter((_, i) => i % armsIn(state.shown) === state.arm);

// Splits values into connected lines: one per arm; angles also break where they wrap at 180 degrees.
function pieces(values, breaks) {
  const { clip, arm } = state.shown;
  const found = [];
  const open = new Map();
  values.forEach((v, i) => {
    const mine = clip ? 0 : arm[i];
    const piece = open.get(mine);
    if (piece && !(breaks && Math.abs(v - values[piece.at(-1)]) > 180)) {
      piece.push(i);
    } else {
      open.set(mine, [i]);
      found.push(open.get(mine));
    }
  });
  return found;
}

// series: [{ name, values, colour, width, dash, dots }]; scale(series, bottom) returns the y mapping and the ticks.
function drawSeries(canvas, yName, series, scale) {
  const { count, unit, name, least } = across();
  const still = (g, w, h) => {
    const mine = series.map((one) => ({ ...one, values: ofArm(one.values) }));
    const { x, bottom } = plotAxes(g, w, h, Math.max(1, count - 1) * unit, name, yName, least);
    const { y, ticks } = scale(mine, bottom);
    for (const [v, label] of ticks) {
      line(g, [[MARGIN.left, y(v)], [w - MARGIN.right, y(v)]], state.colours.line, 0.6);
      text(g, label, MARGIN.left - 6, y(v), state.colours.soft, "right");
    }
    const at = (i) => x((count > 1 ? i : 0.5) * unit);
    for (const { values, colour, width, dash, dots, breaks } of mine) {
      for (const piece of pieces(values, breaks)) {
        const points = piece.map((i) => [at(i), y(values[i])]);
        line(g, count > 1 ? points : [[x(0), points[0][1]], [x(unit), points[0][1]]], colour, dots ? 1 : width, dash);
        if (dots && count <= 400) {
          points.forEach((p) => disc(g, p, 2.2, colour));
        }
      }
    }
    mine.forEach(({ values, marks }) => (marks ?? []).forEach((i) => disc(g, [at(i), y(values[i])], 3.5, state.colours.bad)));
    writeKey(g, mine);
    return { at, y, bottom, mine };
  };
  const { g, at, y, bottom, mine } = prepareOver(canvas, still);
  const now = at(state.frame);
  line(g, [[now, MARGIN.top], [now, bottom]], state.colours.goal, 1);
  mine.forEach(({ values, colour, marks }) => disc(g, [now, y(values[state.frame])], 4, marks?.includes(state.frame) ? state.colours.bad : colour));
}

function logScale(series, bottom) {
  let [low, high] = [Infinity, 0];
  for (const v of series.flatMap(({ values }) => values)) {
    low = v > 0 ? Math.min(low, v) : low;
    high = Math.max(high, v);
  }
  // Errors of 0 are drawn on the lower edge of the log scale.
  const from = Number.isFinite(low) ? Math.floor(Math.log10(low)) : -12;
  const to = Math.max(from + 1, high > 0 ? Math.ceil(Math.log10(high) + 0.1) : from + 1);
  const y = (v) => bottom - ((Math.log10(Math.max(v, 10 ** from)) - from) / (to - from)) * (bottom - MARGIN.top);
  const every = Math.ceil((to - from) / ((bottom - MARGIN.top) / 22));
  const ticks = [];
  for (let k = from; k <= to; k += every) {
    ticks.push([10 ** k, `1e${k}`]);
  }
  return { y, ticks };
}

function degreeScale(series, bottom) {
  let [low, high] = [0, 0];
  for (const v of series.flatMap(({ values }) => values)) {
    [low, high] = [Math.min(low, v), Math.max(high, v)];
  }
  [low, high] = [Math.floor(low / 45) * 45, Math.max(45, Math.ceil(high / 45) * 45)];
  const y = (v) => bottom - ((v - low) / (high - low)) * (bottom - MARGIN.top);
  const step = 45 * Math.ceil((high - low) / 45 / ((bottom - MARGIN.top) / 24));
  const ticks = [];
  for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
    ticks.push([v, String(v).replace("-", "\u2212")]);
  }
  return { y, ticks };
}

function drawErrors() {
  const { colours: c } = state;
  const hands = state.runs.map(handSeries);
  const angles = state.runs.map((t) => [
    { name: "shoulder", values: t.shoulderAngle, colour: c.upper, dots: true },
    { name: "elbow", values: t.elbowAngle, colour: c.fore, dots: true },
    ...(t.hands ? [{ name: "hand", values: t.hands.error, colour: c.plane, dots: true }] : []),
  ]);
  // All runs share one scale, for comparison.
  const scaleOf = (all) => (_, bottom) => logScale(all.flat().map(({ values }) => ({ values: ofArm(values) })), bottom);
  state.runs.forEach((_, i) => {
    drawSeries(element("hand" + PLACES[i]), "distance / reach", hands[i], scaleOf(hands));
    drawSeries(element("angles" + PLACES[i]), "rotation error (rad)", angles[i], scaleOf(angles));
  });
}

function handSeries(t) {
  const { colours: c } = state;
  const tolerance = t.tolerance === null ? [] : [{ name: "tolerance", values: t.hand.map(() => t.tolerance), colour: c.text, width: 2 }];
  const predicted = t.predicted ? [{ name: "predicted", values: t.predicted, colour: c.elbow, width: 1.5, dash: [5, 4] }] : [];
  return [...tolerance, ...predicted, { name: "hand", values: t.hand, colour: c.fore, dots: true }];
}

const DASHES = [{ dash: [] }, { name: "Dotted", dash: [1, 7] }, { name: "Dashed", dash: [6, 10] }]; // one per run
const JOINTS = ["azimuth", "elevation", "swivel", "elbow flexion"];

function drawJoints() {
  const { colours: c } = state;
  const colours = [c.upper, c.plane, c.elbow, c.fore];
  const series = state.runs.flatMap((t, i) => JOINTS.map((name, k) => {
    const values = t.angles.map((row) => row[k]);
    return { name: i ? "" : name, values, colour: i ? c.text : colours[k], width: 1.8, dash: DASHES[i].dash, breaks: true };
  }));
  drawSeries(element("joints"), "angle (\u00b0)", series, degreeScale);
}

// Draws a strip for each of the seven joints, with a band within the limits, and a strip for the swivel angle, with the
// angles at which all joints are within their limits.
function drawSeven() {
  const { hands, phi } = state.shown;
  if (!hands) {
    return;
  }
  const { colours: c } = state;
  const { count, unit: each, name, least } = across();
  const strips = hands.names.map((joint, k) => ({
    joint,
    values: ofArm(hands.joints.map((row) => row[k])),
    bands: hands.limits[k].includes(null) ? null : ofArm(hands.over).map(() => [hands.limits[k]]),
    outside: ofArm(hands.over).map((over) => (over >> k) & 1),
    colour: [c.upper, c.fore, c.plane][(k > 2) + (k > 3)],
  }));
  const turns = ofArm(phi).map((v) => (v * 180) / Math.PI);
  const swivels = turns.map((v) => v - 360 * Math.round(v / 360));
  const free = hands.free && ofArm(hands.free).map((own) => own.flatMap(([a, b]) => [[a, Math.min(b, 180)], ...(b > 180 ? [[-180, b - 360]] : [])]));
  strips.push({ joint: "swivel", values: swivels, bands: free, outside: ofArm(hands.over), colour: c.elbow });

  const still = (g, w, h) => {
    const { x, bottom } = plotAxes(g, w, h, Math.max(1, count - 1) * each, name, "", least);
    const at = (i) => x((count > 1 ? i : 0.5) * each);
    const height = (bottom - MARGIN.top) / strips.length;
    const columns = x(each) - x(0);
    const places = strips.map(({ values, bands, outside, colour }, k) => {
      const ends = k < hands.names.length && bands ? hands.limits[k] : [-180, 180];
      const [low, high] = [Math.min(...ends, ...values), Math.max(...ends, ...values)];
      const floor = MARGIN.top + (k + 1) * height - 6;
      const y = (v) => floor - ((v - low) / (high - low)) * (height - 24); // the name is above it
      g.globalAlpha = 0.16;
      g.fillStyle = c.good;
      (bands ?? []).forEach((own, i) => own.forEach(([from, to]) => {
        const [left, right] = [Math.max(MARGIN.left, at(i) - columns / 2), Math.min(w - MARGIN.right, at(i) + columns / 2)];
        g.fillRect(left, y(to), right - left, Math.max(1, y(from) - y(to)));
      }));
      g.globalAlpha = 1;
      for (const end of ends) {
        line(g, [[MARGIN.left, y(end)], [w - MARGIN.right, y(end)]], c.line, 0.8);
        text(g, String(Math.round(end)).replace("-", "\u2212"), MARGIN.left - 6, y(end), c.soft, "right");
      }
      for (const piece of pieces(values, true)) {
        line(g, piece.map((i) => [at(i), y(values[i])]), colour, 1.8);
      }
      outside.forEach((over, i) => over && disc(g, [at(i), y(values[i])], 3, c.bad));
      return y;
    });
    return { at, places, bottom, height };
  };
  const { g, at, places, bottom, height } = prepareOver(element("seven"), still);
  const now = at(state.frame);
  line(g, [[now, MARGIN.top], [now, bottom]], c.goal, 1);
  strips.forEach(({ joint, values, outside, colour }, k) => {
    const v = values[state.frame];
    disc(g, [now, places[k](v)], 4, outside[state.frame] ? c.bad : colour);
    text(g, `${joint} ${degrees(v)}`, MARGIN.left, MARGIN.top + k * height + 8, outside[state.frame] ? c.bad : c.text);
  });
}

// Draws the largest step of a joint in each row; rows that jump or have no joints are marked.
function drawSteps() {
  const { hands } = state.shown;
  if (!hands?.steps) {
    return;
  }
  const { colours: c } = state;
  const values = hands.steps.map((v) => v ?? 0);
  const top = 1.15 * Math.max(hands.most, ...values);
  const scale = (_, bottom) => {
    const step = tickStep(top, 5);
    const ticks = Array.from({ length: Math.floor(top / step) + 1 }, (_, i) => [i * step, tickText(i * step, step)]);
    return { y: (v) => bottom - (v / top) * (bottom - MARGIN.top), ticks };
  };
  drawSeries(element("steps"), "step (rad)", [
    { name: `goal ${hands.most} rad`, values: values.map(() => hands.most), colour: c.text, width: 1.5, dash: [5, 4] },
    { name: "largest step", values, colour: c.fore, dots: true, marks: hands.jumps },
  ], scale);
}

// Draws a ring for each branch, branch 0 innermost. Swivel angle 0 is at the top, clockwise as seen from the shoulder.
function drawCircle() {
  const { shown: { hands, phi }, at: n, colours: c } = state;
  if (!hands?.arcs) {
    return;
  }
  const { g, w, h } = prepare(element("circle"));
  const [x, y, outer] = [w / 2, h / 2, Math.min(w - 32, h) / 2 - 22];
  const place = (angle, r) => [x + r * Math.sin((angle * Math.PI) / 180), y - r * Math.cos((angle * Math.PI) / 180)];
  const ring = (r, from, to, colour, width) =>
    line(g, Array.from({ length: 91 }, (_, i) => place(from + ((to - from) * i) / 90, r)), colour, width);
  const radius = (branch) => (outer * (branch + 3)) / 10;
  [0, 90, 180, 270].forEach((angle) => {
    line(g, [place(angle, radius(-0.6)), place(angle, outer + 4)], c.line, 0.8);
    text(g, `${angle > 180 ? "−" : ""}${angle > 180 ? 360 - angle : angle}°`, ...place(angle, outer + (angle % 180 ? 20 : 13)), c.soft, "center");
  });
  const now = (phi[n] * 180) / Math.PI;
  line(g, [place(now, radius(-0.6)), place(now, outer + 4)], c.elbow, 1.5);
  hands.arcs[n].forEach((arcs, branch) => {
    const mine = branch === hands.branch[n];
    ring(radius(branch), 0, 360, mine ? c.soft : c.line, 1);
    arcs.forEach(([from, to]) => ring(radius(branch), from, to, c.good, mine ? 7 : 3));
    text(g, String(branch), ...place(45, radius(branch)), mine ? c.text : c.soft, "center");
  });
  disc(g, place(now, radius(hands.branch[n])), 5, (hands.over[n] ? c.bad : c.elbow));
}

// Returns the clocks between targets.
const periodOf = (t) => (t.target.length > 1 ? (t.cycles - t.latency - 1) / (t.target.length - 1) : 1);

// Time is scaled to the longest run, ignoring runs at least 8 times longer, which would hide this one.
const longest = () => Math.max(...state.runs.map((run) => run.cycles));
const clocks = (t) => Math.max(...state.runs.map((run) => run.cycles).filter((count) => count < 8 * t.cycles));

// Draws each target as a row from entry to exit, which is `latency` clocks later; between them it is in the core.
function drawPipeline(t, i) {
  const { colours: c, at } = state;
  const count = t.target.length;
  const { g, w, h } = prepare(element("pipeline" + PLACES[i]));
  const { x, bottom } = plotAxes(g, w, h, clocks(t), "time (clocks)", "");
  const period = periodOf(t);
  const enters = (i) => i * period;
  const leaves = (i) => t.latency + i * period;
  const split = bottom - 0.28 * (bottom - MARGIN.top); // above: every target; below: number of targets inside
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

  // Average number of targets inside: rises until the last target enters, falls once the first leaves.
  const [filled, emptying] = [enters(count), t.latency].sort((a, b) => a - b);
  const end = leaves(count);
  const inside = (v) => Math.min(count, v / period) - Math.max(0, (v - t.latency) / period);
  const average = inside(filled);
  const most = Math.ceil(average);
  const fill = (v) => bottom - (inside(v) / most) * (bottom - split) * 0.8;
  const until = (last) => [0, filled, emptying, end].filter((v) => v < last).concat(last);
  const outline = until(end).map((v) => [x(v), fill(v)]);
  line(g, outline, c.soft, 1);
  g.beginPath();
  [...until(clock).map((v) => [x(v), fill(v)]), [x(clock), bottom], [x(0), bottom]].forEach((p) => g.lineTo(...p));
  g.globalAlpha = 0.3;
  g.fillStyle = c.upper;
  g.fill();
  g.globalAlpha = 1;
  line(g, [[x(clock), top], [x(clock), bottom]], c.goal, 1);
  const about = most > average ? `${average.toFixed(1)} on average, ` : "";
  text(g, `inside the core: ${about}at most ${most}`, MARGIN.left, split - 8, c.text);
  text(g, String(most), MARGIN.left - 6, bottom - (bottom - split) * 0.8, c.soft, "right");
  text(g, "0", MARGIN.left - 6, bottom, c.soft, "right");

  line(g, [[MARGIN.left, 9], [MARGIN.left + 18, 9]], c.upper, 2.5);
  text(g, "targets in", MARGIN.left + 24, 9, c.text);
  line(g, [[MARGIN.left + 98, 9], [MARGIN.left + 116, 9]], c.fore, 2.5);
  text(g, "results out", MARGIN.left + 122, 9, c.text);
  text(g, "0", MARGIN.left - 6, y(0), c.soft, "right");
  upright(g, "target", 10, (y(0) + y(count)) / 2);
  upright(g, "targets", 10, (split + bottom) / 2);
  text(g, String(count - 1), MARGIN.left - 6, y(count), c.soft, "right");
}
