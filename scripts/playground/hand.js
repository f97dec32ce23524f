// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- the hand ----------------------------------------------------------------------------------

const RING = 0.22; // radius of the rings, relative to the reach: as long as the hand's axes in the picture
const STEPS = 72; // parts of a ring

const robot = () => DATA.robots.find(({ name }) => name === ui.robot);
const place = () => [ui.target.x, ui.target.y, ui.target.z];
const pointOf = (wrist, turn) => sum(wrist, rotate(turn, [0, 0, 1]), robot().tool);
const viewOf = (part) => camera(part.w, part.h, state.bounds, state.view);

// Returns the three rings around the hand's axes: places of their points in the picture, and whether each is behind the hand.
function rings(view) {
  const { turn, d1, d2 } = ui.target;
  const centre = pointOf(place(), turn);
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((e) => rotate(turn, e).map((v) => v * RING * (d1 + d2)));
  return axes.map((_, k) => Array.from({ length: STEPS }, (_, i) => {
    const angle = (2 * Math.PI * i) / STEPS;
    const p = sum(sum(centre, axes[(k + 1) % 3], Math.cos(angle)), axes[(k + 2) % 3], Math.sin(angle));
    return { at: view.project(p), behind: view.depth(p) > view.depth(centre) };
  }));
}

function drawRings(g, view) {
  const { bad, good, upper } = state.colours;
  rings(view).forEach((ring, k) => {
    Object.assign(g, { strokeStyle: [bad, good, upper][k], lineWidth: ui.handle?.ring === k ? 4.5 : 2 });
    for (const behind of [true, false]) {
      g.globalAlpha = behind ? 0.3 : 0.9;
      g.beginPath();
      ring.forEach((point, i) => {
        if (point.behind === behind) {
          g.moveTo(...point.at);
          g.lineTo(...ring[(i + 1) % STEPS].at);
        }
      });
      g.stroke();
    }
  });
  g.globalAlpha = 1;
}

// Returns the handle at the pointer: {} for the hand's point, {ring, i} for point i of a ring, null for none.
function handleAt({ offsetX: x, offsetY: y, pointerType }) {
  const part = partAt(x, y);
  if (!part) return null;
  const view = viewOf(part);
  const away = ([px, py]) => Math.hypot(x - part.x - px, y - part.y - py);
  const own = away(view.project(pointOf(place(), ui.target.turn)));
  const points = rings(view).flatMap((each, ring) => each.map(({ at, behind }, i) => ({ ring, i, off: away(at) + (behind ? 4 : 0) })));
  const nearest = points.reduce((a, b) => (b.off < a.off ? b : a));
  const onRing = own > 20 && nearest.off < (pointerType === "touch" ? 18 : 9);
  return onRing ? nearest : own < 36 ? {} : null;
}

// Turns the hand by an angle about its axis k (0: x); the hand's point does not move.
function turnHand(k, angle) {
  const point = pointOf(place(), ui.target.turn);
  const by = [Math.cos(angle / 2), 0, 0, 0];
  by[k + 1] = Math.sin(angle / 2);
  ui.target.turn = unit(multiply(ui.target.turn, by));
  moveTo(sum(point, rotate(ui.target.turn, [0, 0, 1]), -robot().tool));
  afterwards();
}

// Turns the hand as the pointer drags point i of a ring by (dx, dy) pixels.
function turnBy({ ring, i }, dx, dy) {
  const points = rings(viewOf(state.parts[0]))[ring];
  const along = sum(points[(i + 1) % STEPS].at, points.at(i - 1).at, -1).map((v) => (v * STEPS) / (4 * Math.PI)); // pixels per rad
  const least = 15 ** 2; // where the ring runs away from the camera
  turnHand(ring, (dx * along[0] + dy * along[1]) / Math.max(least, along[0] ** 2 + along[1] ** 2));
}

// Converts joint angles of branch 0 to another branch; bits of a branch: shoulder, elbow, wrist.
function branched(th, branch) {
  const [s, e, w] = [branch & 1, branch >> 1 & 1, branch >> 2];
  const [turned, negated] = [[s, 0, s ^ e, 0, e ^ w, 0, w], [0, s, 0, e, 0, w, 0]];
  return th.map((angle, k) => (negated[k] ? -angle : angle) + Math.PI * turned[k]);
}

// Chooses a branch as ik_choose does: the one whose largest step from the joints shown is smallest. A joint outside its
// limits counts as a step above all others. Returns branch and joints: angle (rad), whether outside, step (rad).
function jointsOf(qs, qe, hand) {
  const th = sevenAngles(qs, qe, multiply(hand, conjugate(robot().tip)));
  let best = { most: Infinity };
  for (let branch = 0; branch < 8; branch++) {
    const joints = branched(th, branch).map((angle, k) => {
      const { sign, offset, middle, half } = robot().joints[k];
      const [from, to] = [wrap((ui.present?.[k] ?? middle) - middle), wrap(sign * angle + offset - middle)];
      const step = Math.abs(half < Math.PI ? to - from : wrap(to - from)); // never across the gap between the limits
      return { at: wrap(to + middle), over: Math.abs(to) > half, step };
    });
    const most = Math.max(...joints.map(({ over, step }) => over ? 1000 : step));
    if (most < best.most) best = { branch, joints, most };
  }
  return best;
}

function writeAngles(now) {
  const { joints: found = [], branch } = now ?? {};
  element("branch").textContent = branch === undefined ? "" : `branch ${branch}`;
  [...element("angles").rows].forEach((row, k) => {
    const { at, over } = found[k] ?? {};
    row.className = over ? "over" : "";
    row.cells[1].textContent = at === undefined ? "\u2013" : degrees(at);
    row.cells[2].textContent = over ? "over limit" : "";
    row.querySelector("b").style.left = `${((at ?? 0) / Math.PI + 1) * 50}%`;
  });
}

function useRobot(name) {
  choose("robot", name);
  ui.present = null;
  element("angles").replaceChildren(...robot().joints.map(({ name: joint, middle, half }) => {
    const row = document.createElement("tr");
    const width = half < Math.PI ? 100 * (half / Math.PI) : 0; // without a limit there is no band
    const band = `left:${(middle / Math.PI + 1) * 50 - width / 2}%;width:${width}%`;
    row.innerHTML = `<th scope="row"></th><td></td><td></td><td><div><i style="${band}"></i><b></b></div></td>`;
    row.cells[0].textContent = joint;
    return row;
  }));
}
