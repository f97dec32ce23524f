// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- the pipeline, stage by stage -------------------------------------------------------------

const CELL = 9;
const LANE = { left: 84, right: 178, top: 22 };
const lane = element("lane");
const colourOf = (target) => `hsl(${(target.number * 47) % 360} 75% 50%)`;

// Layout of a core's nodes: one row per section, clocks to the right, nodes of a clock stacked.
function layLane(machine) {
  const { table, nodes } = machine;
  const rows = new Map();
  const place = new Map();
  const most = new Map();
  for (const node of nodes) {
    const key = `${node.section} ${node.time}`;
    rows.set(key, (rows.get(key) ?? 0) + 1);
    place.set(node.name, rows.get(key) - 1);
    most.set(node.section, Math.max(most.get(node.section) ?? 0, rows.get(key)));
  }
  let y = LANE.top;
  const sections = table.sections.map(({ name }) => {
    const section = { name, y, h: Math.max(1.4 * CELL, most.get(name) * CELL) };
    y += section.h + 8;
    return section;
  });
  const top = new Map(sections.map((section) => [section.name, section.y]));
  const last = Math.max(...nodes.map((node) => node.time));
  return { sections, height: y + 34, last, yOf: (node) => top.get(node.section) + place.get(node.name) * CELL };
}

const laneX = (laid, w) => (time) => LANE.left + (time / (laid.last + 1)) * (w - LANE.left - LANE.right);

function drawLane() {
  const machine = ui.machines[0];
  const laid = ui.laid;
  lane.style.height = `${laid.height}px`;
  const { g, w } = prepare(lane);
  const { colours: c } = state;
  const x = laneX(laid, w);
  const wide = Math.max(2, x(1) - x(0) - 1);
  for (const { name, y, h } of laid.sections) {
    g.globalAlpha = 0.35;
    g.fillStyle = c.line;
    g.fillRect(LANE.left, y - 3, x(laid.last + 1) - LANE.left, h + 5);
    g.globalAlpha = 1;
    text(g, name, LANE.left - 8, y + h / 2 - 1, c.soft, "right");
  }
  const bottom = laid.height - 34;
  const step = Math.max(1, tickStep(laid.last + 1, Math.floor(w / 90)));
  for (let v = 0; v <= laid.last; v += step) {
    text(g, String(v), x(v) + wide / 2, bottom + 8, c.soft, "center");
  }
  text(g, "clocks since the target came in", (LANE.left + x(laid.last)) / 2, bottom + 20, c.soft, "center");

  const inside = new Map(machine.flying.map((target) => [machine.ageOf(target), target]));
  for (const node of machine.nodes) {
    const target = inside.get(node.time);
    const [left, top] = [x(node.time), laid.yOf(node)];
    g.fillStyle = target ? colourOf(target) : c.card;
    g.fillRect(left, top, wide, CELL - 2);
    g.lineWidth = node === ui.node ? 2.5 : 0.6;
    g.strokeStyle = node === ui.node ? c.text : c.soft;
    g.strokeRect(left, top, wide, CELL - 2);
  }
  for (const target of machine.flying) {
    const age = machine.ageOf(target);
    if (age <= laid.last) {
      line(g, [[x(age) + wide / 2, 14], [x(age) + wide / 2, bottom]], colourOf(target), target === ui.followed ? 2.5 : 0.7);
    }
    if (target === ui.followed) {
      text(g, `target ${target.number}`, Math.max(LANE.left + 30, Math.min(x(Math.min(age, laid.last)), w - 160)), 8, c.text, "center");
    }
  }
  drawWaiting(g, w, machine, laid);
}

// Draws the output FIFO: results waiting for the receiver, and the remaining credits.
function drawWaiting(g, w, machine, laid) {
  const { colours: c } = state;
  const left = w - LANE.right + 18;
  const waiting = machine.flying.filter((target) => machine.waits(target));
  const credits = machine.places ? Number(machine.live("g_fifo.u_credits.credits")) : null;
  const lines = [
    `inside ${machine.flying.length - waiting.length}, waiting ${waiting.length}`,
    credits === null ? "no FIFO" : `credits ${credits} of ${machine.places}`,
    `sent ${machine.sent}, answered ${machine.left}`,
    machine.lost ? `LOST ${machine.lost}` : "none lost",
  ];
  lines.forEach((string, i) => text(g, string, left, LANE.top + 6 + 17 * i, c.text));
  waiting.forEach((target, i) => {
    g.fillStyle = colourOf(target);
    g.fillRect(left + (i % 10) * 12, LANE.top + 76 + Math.floor(i / 10) * 12, 10, 10);
  });
}

// Returns the node nearest to a point of the lane, if it is close enough.
function nodeAt(px, py) {
  const x = laneX(ui.laid, lane.clientWidth);
  const wide = Math.max(2, x(1) - x(0) - 1);
  let [best, far] = [null, 14];
  for (const node of ui.machines[0].nodes) {
    const away = Math.hypot(px - x(node.time) - wide / 2, py - ui.laid.yOf(node) - CELL / 2);
    if (away < far) {
      [best, far] = [node, away];
    }
  }
  return best;
}

// -- one node, one target ----------------------------------------------------------------------

const hex = (bits, width) => bits.toString(16).padStart(Math.ceil(width / 4), "0");
const shownValue = (node, bits) => short(ui.machines[0].valueOf(node, bits));

function writeNode() {
  const [machine, node] = [ui.machines[0], ui.node];
  const now = machine.flying.find((target) => machine.ageOf(target) === node.time);
  const seen = now ?? (ui.followed?.values.has(node.name) ? ui.followed : null);
  const bits = seen?.values.get(node.name);
  const about = machine.table.sections.find(({ name }) => name === node.section).about;
  element("node").replaceChildren(...rows([
    ["node", `${node.name}${node.equation ? `, ${node.equation}` : ""}`],
    ["equation", node.of],
    ["format", `${node.format}, ${node.width} bits`],
    ["valid", `${node.time} clocks after its target came in`],
    ["section", `${node.section}: ${about}`],
    ["word", bits === undefined ? "\u2013" : `0x${hex(bits, node.width)}`],
    ["value", bits === undefined ? "\u2013" : shownValue(node, bits)],
    ["of target", seen ? String(seen.number) : "\u2013"],
  ]));
}

function makeColumn() {
  element("column").replaceChildren(...ui.machines[0].nodes.map((node) => {
    const row = document.createElement("tr");
    row.dataset.node = node.name;
    for (const content of [node.time, node.name, node.equation, "", ""]) {
      row.insertCell().textContent = content;
    }
    row.addEventListener("click", () => {
      ui.node = node;
      drawAll();
    });
    return row;
  }));
}

function writeColumn() {
  const { followed, machines: [machine] } = ui;
  element("followed").textContent = followed
    ? `Target ${followed.number}, admitted in clock ${followed.at}` + (followed.result ? `, answered ${followed.latency} clocks later.` : ".")
    : "No target is followed: click on one in the lane, or send one.";
  const age = followed && !followed.result ? machine.ageOf(followed) : null;
  [...element("column").rows].forEach((row, i) => {
    const node = machine.nodes[i];
    const bits = followed?.values.get(node.name);
    const [word, value] = bits === undefined ? ["", ""] : [hex(bits, node.width), shownValue(node, bits)];
    if (row.cells[3].textContent !== word) {
      row.cells[3].textContent = word;
      row.cells[4].textContent = value;
    }
    row.className = `${node.time === age ? "now" : ""} ${node === ui.node ? "chosen" : ""}`;
  });
}
