// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/__main__.py, which puts the scripts of this folder into one function.

// -- figures 1 to 5 of the paper ------------------------------------------------------------

const SHOULDER = [0, 0, 0];
const scaled = (a, k) => a.map((v) => k * v);
const onto = (v, axis) => scaled(unit(axis), dot(v, unit(axis)));

// Returns the entities of model.reference.geometry for a target by name, relative to the shoulder: points and lengths
// in the targets' unit, directions scaled to the reach, angles in rad. Entities that do not exist are undefined.
function entities(t, n) {
  const [vectors, angles, lengths] = t.paper;
  const [d1, d2] = t.lengths[n];
  const reach = d1 + d2;
  const turned = (p) => (t.clip ? t.clip.place.map((axis) => dot(axis, p)) : p);
  const found = { reach, d1, d2, phi: t.phi[n], wrist: turned(t.target[n]) };
  const take = (named, read) => Object.entries(named).forEach(([name, values]) => {
    const value = values[n];
    found[name] = value === null || value[0] === null ? undefined : read(value);
  });
  take(vectors, (p) => turned(scaled(p, reach)));
  take(angles, (angle) => angle);
  take(lengths, (length) => length * reach);
  return found;
}

// Rotates v about an axis through the shoulder, right-handed.
function turn(v, axis, angle) {
  const a = unit(axis);
  const part = scaled(a, dot(a, v) * (1 - Math.cos(angle)));
  return sum(sum(part, v, Math.cos(angle)), cross(a, v), Math.sin(angle));
}

// Returns the path of a point rotating about an axis through `centre`.
function arc(centre, axis, from, angle) {
  const spoke = sum(from, centre, -1);
  return Array.from({ length: 65 }, (_, i) => sum(centre, turn(spoke, axis, (angle * i) / 64)));
}

const beside = (axis) => unit(cross(axis, Math.abs(unit(axis)[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));

// -- drawing in space -----------------------------------------------------------------------

// Draws a name such as P_e with the part after _ as a subscript. Returns its width; without y, only measures.
function marked(g, string, x = 0, y, colour) {
  const font = g.font;
  let end = x;
  string.split(/_(\w+)/).forEach((part, i) => {
    g.font = i % 2 ? font.replace("12.5px", "9.5px") : font;
    if (y !== undefined) {
      text(g, part, end, y + (i % 2 ? 4 : 0), colour);
    }
    end += g.measureText(part).width;
  });
  g.font = font;
  return end - x;
}

// Places names next to their points without overlapping each other or the arm; prefers the previous position.
const lastPlace = new Map();
function writeNames(g, w, h, names, limbs, thick) {
  const r = 0.5 * thick + 1;
  const taken = limbs.flatMap(([a, b]) =>
    Array.from({ length: 13 }, (_, i) => sum(a, sum(b, a, -1), i / 12)).map(([x, y]) => [x - r, y - r, x + r, y + r]));
  taken.push([0, h - 84, 92, h]); // the axes in the corner
  for (const { name, point, colour } of names) {
    const width = marked(g, name);
    const boxes = [14, 26, 40].flatMap((far) =>
      [1, -1, 3, -3, 0, 4, 2, -2].map((k) => {
        const [dx, dy] = [Math.cos((k * Math.PI) / 4), -Math.sin((k * Math.PI) / 4)];
        const x = point[0] + dx * far + ((dx - 1) / 2) * width;
        return [x, point[1] + dy * far - 8, x + width, point[1] + dy * far + 8];
      }),
    );
    const free = ([a, b, c, d]) =>
      a > 2 && b > 2 && c < w - 2 && d < h - 2 && taken.every((o) => c < o[0] || o[2] < a || d < o[1] || o[3] < b);
    const before = lastPlace.get(name) ?? 0;
    const found = free(boxes[before]) ? before : Math.max(0, boxes.findIndex(free));
    lastPlace.set(name, found);
    taken.push(boxes[found]);
    marked(g, name, boxes[found][0], boxes[found][1] + 8, colour);
  }
}

// Returns the drawing functions of the figures; points are 3D.
function pen(g, view, w, h, e) {
  const { colours: c } = state;
  const { project, eye } = view;
  const [names, limbs] = [[], []];
  const thick = Math.max(5, 0.045 * view.scale * e.reach);
  const path = (points, colour, width = 1.8, dash = []) => line(g, points.map(project), colour, width, dash);
  const name = (string, point, colour = c.text) => names.push({ name: string, point: project(point), colour });
  return {
    path,
    name,
    arm: (points, alpha = 1) => {
      const [shoulder, elbow, wrist] = drawLimbs(g, view, points, thick, alpha);
      limbs.push([shoulder, elbow], [elbow, wrist]);
    },
    dot: (point, colour) => disc(g, project(point), 4.5, colour),
    goal: () => ring(g, project(e.wrist), 0.45 * thick + 3),
    // Draws a line from `back` behind a point to `forth` ahead of it, with its name at the end.
    line: (string, from, way, back, forth, colour, dash) => {
      path([sum(from, unit(way), -back), sum(from, unit(way), forth)], colour, 1.8, dash);
      name(string, sum(from, unit(way), forth), colour);
    },
    patch: (corners, colour) => patch(g, corners.map(project), colour),
    turns: (points, colour, string) => {
      path(points, colour, 2.2);
      const flat = points.map(project);
      const end = flat.at(-1);
      const way = unit(sum(end, flat.at(-5), -1));
      const wing = (side) => sum(sum(end, way, -8), [-way[1], way[0]], side);
      if (length(sum(end, flat.at(-5), -1)) > 1) {
        line(g, [wing(4), end, wing(-4)], colour, 2.2);
      }
      name(string, points[32], colour);
    },
    // Draws the visible outline and a great circle; the name is on the side away from `other`.
    sphere: (string, centre, radius, other, colour) => {
      const toward = sum(eye, centre, -1);
      const middle = sum(centre, toward, (radius / length(toward)) ** 2);
      const rim = radius * Math.sqrt(1 - (radius / length(toward)) ** 2);
      const outline = arc(middle, toward, sum(middle, beside(toward), rim), 2 * Math.PI);
      const away = outline.map((point) => length(sum(project(point), project(other), -1)));
      path(outline, colour, 1.5);
      name(string, outline[away.indexOf(Math.max(...away))], colour);
      g.globalAlpha = 0.1;
      g.fillStyle = colour;
      g.fill();
      g.globalAlpha = 0.5;
      path(arc(centre, e.axis, sum(centre, beside(e.axis), radius), 2 * Math.PI), colour, 1, [3, 4]);
      g.globalAlpha = 1;
    },
    write: () => writeNames(g, w, h, names, limbs, thick),
  };
}

// -- the figures ----------------------------------------------------------------------------

const wrap = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
const inDegrees = (angle) => degrees((angle * 180) / Math.PI);

const WIDE = 0.42; // width of a drawn half plane, relative to the reach
const MORE = 0.16; // extension of a line beyond its points, relative to the reach

// Returns the corners of a parallelogram spanned by a and b.
const corners = (from, a, b) => [from, sum(from, a), sum(sum(from, a), b), sum(from, b)];

// Returns the part of L_sw along the arm: its start, and the vector to its end.
function span(e) {
  const at = [0, length(e.wrist), e.elbow ? dot(e.elbow, unit(e.along)) : 0];
  const low = Math.min(...at);
  return [scaled(unit(e.along), low), scaled(unit(e.along), Math.max(...at) - low)];
}

// Half planes of the swivel plane at phi = 0 and at phi, on the elbow's side of L_sw.
const swivelPlanes = (e) =>
  [e.vertical, e.swivel].filter(Boolean).map((normal) =>
    corners(...span(e), scaled(unit(cross(normal, e.along)), WIDE * e.reach)));

// Elbow before the half turn, and L_m from the shoulder towards the midpoint of both elbow positions.
const elbowAtRest = (e) => scaled(unit(e.axis), e.d1);
const middleLine = (e) => scaled(e.middle, Math.sign(dot(e.middle, sum(elbowAtRest(e), e.elbow))) || 1);

// Half planes of the forearm after the half turn and in the final pose.
const turnedPlanes = (e) =>
  (e.yz2 ? [[e.yz2, e.half], [e.swivel, e.wrist]] : []).map(([normal, point]) => {
    const side = scaled(cross(unit(normal), unit(e.elbow)), WIDE * e.reach);
    return corners(SHOULDER, scaled(e.elbow, 1.15), scaled(side, Math.sign(dot(side, point)) || 1));
  });

// needs: entities a target must have; holds: points that must be visible; says: text of the note.
const PAPER = [
  {
    title: "Swivel plane",
    needs: ["swivel"],
    holds: (e) => [scaled(e.axis, 0.7), sum(e.wrist, unit(e.wrist), MORE * e.reach), ...swivelPlanes(e).flat()],
    says: (e) =>
      `Equations (10), (11). L_sw is the line from shoulder to wrist. The swivel plane \u03c0_swivel is that through L_sw ` +
      `and the reference axis L_z, turned about L_sw by \u03c6 = ${inDegrees(wrap(e.phi))}.`,
    draw: (p, e, c) => {
      const [vertical, swivel] = swivelPlanes(e);
      p.line("L_z", SHOULDER, e.axis, 0, 0.7 * e.reach, c.soft, [6, 4]);
      p.patch(vertical, c.soft);
      p.patch(swivel, c.plane);
      p.line("L_sw", SHOULDER, e.along, 0, length(e.wrist) + MORE * e.reach, c.middle);
      const half = scaled(e.wrist, 0.5);
      p.name("\u03c0_swivel", swivel[2], c.plane);
      if (e.elbow) {
        p.arm([SHOULDER, e.elbow, e.wrist]);
        p.name("P_e", e.elbow);
      }
      p.turns(arc(half, e.along, sum(half, sum(vertical[3], vertical[0], -1), 0.75), wrap(e.phi)), c.text, "\u03c6");
      p.name("P_w", e.wrist);
    },
  },
  {
    title: "Elbow point",
    needs: [],
    holds: (e) => [[SHOULDER, e.d1], [e.wrist, e.d2]].flatMap(([centre, radius]) =>
      [-radius, radius].flatMap((r) => [[r, 0, 0], [0, r, 0], [0, 0, r]].map((v) => sum(centre, v)))),
    says: (e) =>
      `Equations (12), (13). The elbow is on the sphere S_2 about the shoulder with radius d_1 = ${short(e.d1)} and on S_1 about ` +
      `the wrist with d_2 = ${short(e.d2)}, ` + (e.radius === undefined
        ? "which do not meet: the target is out of reach."
        : "so on their circle Z_e. " + (e.elbow
          ? "The swivel plane cuts it in the point pair PP, of which P_e is taken."
          : "With the wrist on the reference axis there is no swivel plane to cut it.")),
    draw: (p, e, c) => {
      p.sphere("S_2", SHOULDER, e.d1, e.wrist, c.upper);
      p.sphere("S_1", e.wrist, e.d2, SHOULDER, c.fore);
      if (e.elbow) {
        const out = scaled(unit(sum(e.elbow, e.centre, -1)), Math.max(1.25 * e.radius, 0.2 * e.reach));
        const [from, way] = span(e);
        p.patch(corners(sum(from, out, -1), way, scaled(out, 2)), c.plane);
      }
      if (e.radius !== undefined) {
        const rim = arc(e.centre, e.along, sum(e.centre, beside(e.along), e.radius), 2 * Math.PI);
        p.path(rim, c.elbow, 2.5);
        p.name("Z_e", rim[8], c.elbow);
      }
      if (e.elbow) {
        p.path([e.elbow, e.other], c.elbow, 1.2, [3, 4]);
        p.arm([SHOULDER, e.elbow, e.wrist]);
        [e.elbow, e.other].forEach((point) => p.dot(point, c.elbow));
        p.name("P_e", e.elbow);
        p.name("PP", e.other, c.elbow);
      }
      p.name("P_w", e.wrist);
    },
  },
  {
    title: "Elbow quaternion",
    needs: ["theta4"],
    holds: (e) => (e.elbow
      ? [scaled(unit(e.elbow), -MORE * e.reach), sum(e.wrist, unit(sum(e.wrist, e.elbow, -1)), MORE * e.reach)]
      : []),
    says: (e) =>
      `Equation (14). Q_e turns the forearm, which at rest lies folded on the upper arm, about the elbow by the angle ` +
      `\u03b8_4 = ${inDegrees(e.theta4)} between the lines L_se and L_ew.`,
    draw: (p, e, c) => {
      const more = MORE * e.reach;
      const fore = sum(e.wrist, e.elbow, -1);
      p.line("L_se", SHOULDER, e.elbow, more, e.d1 + more, c.middle);
      p.line("L_ew", e.elbow, fore, more, e.d2 + more, c.middle);
      p.arm([SHOULDER, e.elbow, e.wrist]);
      p.path([e.elbow, e.folded], c.card, 5);
      p.path([e.elbow, e.folded], c.fore, 3);
      p.turns(arc(e.elbow, e.swivel, e.folded, e.theta4), c.text, "\u03b8_4");
      p.name("P_e", e.elbow);
      p.name("P_w", e.wrist);
    },
  },
  {
    title: "Rotate to the elbow position",
    needs: ["middle"],
    holds: (e) => [sum(elbowAtRest(e), unit(e.axis), MORE * e.reach), e.rest, e.half, e.middle && scaled(middleLine(e), 0.75)],
    says: () =>
      `Equation (15). L_m is midway between the elbow P_e and P_ze, where the elbow is while the upper arm lies on the ` +
      `reference axis L_z. A half turn about L_m, which is the quaternion Q_12, takes one to the other.`,
    draw: (p, e, c) => {
      const [from, axis] = [elbowAtRest(e), middleLine(e)];
      p.line("L_z", SHOULDER, e.axis, 0.1 * e.reach, e.d1 + MORE * e.reach, c.soft, [6, 4]);
      p.path(arc(onto(e.rest, axis), axis, e.rest, Math.PI), c.fore, 1.2, [3, 4]);
      p.arm([SHOULDER, from, e.rest], 0.4);
      p.line("L_m", SHOULDER, axis, 0.1 * e.reach, 0.75 * e.reach, c.middle);
      p.arm([SHOULDER, e.elbow, e.half]);
      p.path([from, e.elbow], c.middle, 1.2, [3, 4]);
      p.turns(arc(onto(from, axis), axis, from, Math.PI), c.text, "\u03c0");
      p.name("P_ze", from);
      p.name("P_e", e.elbow);
      p.goal();
      p.name("P_w", e.wrist);
    },
  },
  {
    title: "Rotate to the wrist location",
    needs: ["yz2"],
    holds: (e) => [e.half, ...turnedPlanes(e).flat()],
    says: (e) =>
      `Equations (16) to (18). After the half turn the arm lies in \u03c0_yz2, the yz plane turned by Q_12. Q_3 turns it about the ` +
      `upper arm by \u03b8_3 = ${inDegrees(e.theta3)} into the swivel plane, and the wrist to P_w. Q_s = Q_12 Q_3.`,
    draw: (p, e, c) => {
      const foot = onto(e.wrist, e.elbow);
      const [yz2, swivel] = turnedPlanes(e);
      p.patch(yz2, c.elbow);
      p.patch(swivel, c.plane);
      p.arm([SHOULDER, e.elbow, e.half], 0.4);
      p.arm([SHOULDER, e.elbow, e.wrist]);
      p.turns(arc(foot, e.elbow, e.half, e.theta3), c.text, "\u03b8_3");
      p.name("P_e", e.elbow);
      p.name("P_w", e.wrist);
      p.name("\u03c0_yz2", yz2[3], c.elbow);
      p.name("\u03c0_swivel", swivel[3], c.plane);
    },
  },
];

// Returns the bounding sphere of an arm's figure over the whole trajectory.
const held = new Map();
function boundsOfPaper(t, arm, k) {
  const key = [t.name, arm, k].join();
  if (!held.has(key)) {
    const mine = t.arm.flatMap((a, n) => (a === arm ? [entities(t, n)] : []));
    const points = mine.flatMap((e) => [SHOULDER, e.wrist, e.elbow, ...PAPER[k].holds(e)].filter(Boolean));
    const centre = scaled(sum(...box(points)), 0.5);
    const radius = points.reduce((most, p) => Math.max(most, length(sum(p, centre, -1))), 0);
    held.set(key, { centre, radius: 1.1 * radius }); // room for names
  }
  return held.get(key);
}

function drawPaper() {
  const { shown: t, at: n, figure: k } = state;
  const { g, w, h } = prepare(element("paper"));
  const e = entities(t, n);
  const view = camera(w, h, boundsOfPaper(t, t.arm[n], k), state.view);
  drawAxes(g, view.direction, h, t.clip?.place ?? [[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
  const found = PAPER[k].needs.every((name) => e[name]);
  if (found) {
    const p = pen(g, view, w, h, e);
    PAPER[k].draw(p, e, state.colours);
    p.write();
  }
  const why = t.clamped[n] ? "the target is out of reach" : "the pose is a singular one";
  const says = found ? PAPER[k].says(e) : `Not here: ${why}.`;
  element("paper-note").replaceChildren(...says.split(/_(\w+)/).map((part, i) =>
    (i % 2 ? Object.assign(document.createElement("sub"), { textContent: part }) : part)));
  element("paper").setAttribute("aria-label", `Figure ${k + 1} of the paper, in three dimensions: ${PAPER[k].title}`);
}

function writePaper() {
  element("paper-choice").replaceChildren(...PAPER.map(({ title }, k) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: `${k + 1} ${title}` });
    button.setAttribute("aria-pressed", k === state.figure);
    button.addEventListener("click", () => {
      state.figure = k;
      document.querySelectorAll("#paper-choice button").forEach((b, i) => b.setAttribute("aria-pressed", i === k));
      drawPaper();
    });
    return button;
  }));
}
