// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- state -------------------------------------------------------------------------------------

const TRAIL = 120; // results in the drawn trail
const RATE = 20; // targets of a trajectory per second

// target: in the user's frame, turn: orientation of the hand; flow: run, slow or step; ready: m_axis_tready; dense: one target per clock.
const ui = {
  target: { x: 0.35, y: 0.1, z: -0.15, phi: 2.6, d1: 0.33, d2: 0.27, turn: [0, 1, 0, 1].map((v) => v * Math.SQRT1_2) }, robot: "arm", axis: "z", trajectory: "", at: 0, flow: "run", speed: 8, owed: 0,
  ready: true, dense: true, machines: [], followed: null, node: null, laid: null, watched: [], zoom: 80, last: null, held: false, handle: null, present: null,
};

const axis = () => DATA.axes[ui.axis];
const toCore = (p) => axis().matrix.map((row) => dot(row, p));
const fromCore = (p) => rotate(conjugate(axis().turn), p);

// Returns the input words of a target and the data to check its result.
function asked(target, table) {
  const [x, y, z] = toCore([target.x, target.y, target.z]);
  const { words, exponent, fits } = toWords({ ...target, x, y, z }, table.width);
  return { ...target, words, exponent, fits, place: [target.x, target.y, target.z] };
}

// Compares a result with the exact solution; returns joints in the user's frame, and errors / reach and in rad.
function judged(one, { width }) {
  const scale = 2 ** (2 - width - one.exponent);
  const given = one.words.map((word) => word * scale);
  const [d1, d2] = given.slice(4);
  const values = one.result.map((word) => word / 2 ** (width - 2));
  const [qs, qe] = [values.slice(0, 4), values.slice(4)];
  const exact = solve(one.words, width);
  const [ours, true_] = [forward(qs, qe, d1, d2), forward(exact.qs, exact.qe, d1, d2)];
  const off = (name) => length(sum(ours[name], true_[name], -1)) / (Math.abs(d1) + Math.abs(d2));
  const owed = DATA.flags.reduce((bits, { name, bit }) => bits | (exact.flag[name] ? bit : 0), 0);
  return {
    qs: multiply(conjugate(axis().turn), qs), qe, flags: one.flags, owed, elbow: fromCore(ours.elbow), wrist: fromCore(ours.wrist),
    normal: fromCore(rotate(qs, [-1, 0, 0])), hand: off("wrist"), elbowError: off("elbow"),
    shoulderAngle: angleBetween(qs, exact.qs), elbowAngle: angleBetween([...qe, 0, 0], [...exact.qe, 0, 0]),
    ...jointsOf(qs, qe, multiply(axis().turn, one.turn)),
  };
}

// A run as drawn in the scene; each result extends it.
const emptyRun = (machine) => ({
  datapath: machine.table.name, latency: machine.table.latency, arm: [], target: [], elbow: [], wrist: [], normal: [], lengths: [], hand: [], now: null,
  hands: { goal: [], point: [], turn: [] },
});

function answered(i, one) {
  const [machine, run] = [ui.machines[i], state.runs[i]];
  const found = judged(one, machine.table);
  const add = (name, value, to = run) => {
    to[name].push(value);
    if (to[name].length > TRAIL) to[name].shift();
  };
  const unit = 2 ** (2 - machine.table.width - one.exponent);
  add("arm", 0);
  add("target", one.place);
  add("lengths", [one.words[4] * unit, one.words[5] * unit]);
  ["elbow", "wrist", "normal", "hand"].forEach((name) => add(name, found[name]));
  const hand = { goal: pointOf(one.place, one.turn), point: pointOf(found.wrist, one.turn), turn: one.turn };
  Object.entries(hand).forEach(([name, value]) => add(name, value, run.hands));
  run.latency = one.latency;
  run.now = { ...found, one };
  if (i === 0) ui.present = found.joints.map(({ at }) => at);
  state.at = Math.min(...state.runs.map((each) => each.target.length)) - 1;
}

function forget() {
  state.runs = ui.machines.map(emptyRun);
  state.at = -1;
  const reach = ui.target.d1 + ui.target.d2;
  state.bounds = { centre: [0, 0, 0], radius: 0.86 * reach, floor: -0.8 * reach, step: reach / 4 };
}

// -- the clock ---------------------------------------------------------------------------------

function nextTarget(moves = true) {
  const t = DATA.trajectories.find(({ name }) => name === ui.trajectory);
  if (t && moves) {
    const row = t.rows[ui.at % t.rows.length];
    ui.at += 1;
    FIELDS.forEach((name, i) => (ui.target[name] = row[i]));
    writeFields();
  }
  return ui.target;
}

// Runs one clock of all cores; a target waits at the input until it is admitted.
function clock(offer) {
  ui.machines.forEach((machine, i) => {
    if (offer && !machine.offered) {
      machine.offered = asked(i ? ui.target : nextTarget(), machine.table);
    }
    const { admitted, result } = machine.tick(machine.offered, ui.ready);
    if (admitted) {
      if (!i && (!ui.followed || ui.followed.result)) ui.followed = machine.offered;
      machine.offered = null;
    }
    if (result) answered(i, result);
  });
}

// Sends a target and runs clocks until every core has its result, or would have if the receiver were ready.
function once(moves) {
  const target = nextTarget(moves);
  ui.machines.forEach((machine, i) => {
    let one = machine.offered ?? asked(target, machine.table);
    machine.offered = null;
    for (let k = 0; k <= machine.table.latency + machine.table.period; k++) {
      const { admitted, result } = machine.tick(one, ui.ready);
      if (admitted) {
        if (!i) ui.followed = one;
        one = null;
      }
      if (result) answered(i, result);
      if (!one && !machine.flying.length) break;
    }
    machine.offered = one;
  });
}

function frame(time) {
  const elapsed = Math.min(0.1, (time - (ui.last ?? time)) / 1000);
  ui.last = time;
  if (ui.flow === "run" && ui.machines.length) {
    ui.owed += elapsed * RATE;
    once(ui.owed >= 1);
    ui.owed %= 1;
    drawAll();
  } else if (ui.flow === "slow" && ui.machines.length) {
    ui.owed += elapsed * ui.speed;
    const clocks = Math.floor(ui.owed);
    ui.owed -= clocks;
    for (let k = 0; k < clocks; k++) {
      clock(ui.dense || !ui.machines[0].flying.length);
    }
    if (clocks) drawAll();
  }
  requestAnimationFrame(frame);
}

function step() {
  setFlow("step");
  clock(ui.dense || !ui.machines[0].flying.length);
  drawAll();
}

// -- text --------------------------------------------------------------------------------------

const degrees = (v) => `${((v * 180) / Math.PI).toFixed(1).replace("-", "\u2212")}\u00b0`;

function writeNow() {
  const list = ui.machines.flatMap((machine, i) => {
    const { now } = state.runs[i];
    const head = [machine.table.name, "", i];
    if (!now) return [head, ["answer", "none yet"]];
    const { width } = machine.table;
    const word = (v) => hex(BigInt.asUintN(width, BigInt(v)), width);
    return [
      head,
      ["words in", now.one.words.map(word).join(" ")],
      ["words out", now.one.result.map(word).join(" ")],
      ["Qs", ["", "i", "j", "k"].map((unit, k) => signed(now.qs[k]) + unit).join(" ")],
      ["Qe", ["", "i"].map((unit, k) => signed(now.qe[k]) + unit).join(" ")],
      ["error of the hand", `${error(now.hand)} of the reach`],
      ["of the elbow", `${error(now.elbowError)} of the reach`],
      ["angles", `${error(now.shoulderAngle)}, ${error(now.elbowAngle)} rad`],
      ["latency", `${now.one.latency} clocks, as counted`],
    ];
  });
  element("now").replaceChildren(...rows(list));
  const flags = state.runs[0]?.now?.flags ?? 0;
  writeAngles(state.runs[0]?.now);
  document.querySelectorAll("#flags li").forEach((item) => {
    const on = (flags & Number(item.dataset.bit)) !== 0;
    item.classList.toggle("on", on);
    item.ariaLabel = `${item.dataset.name}: ${on ? "on" : "off"}`;
  });
  const said = DATA.flags.filter(({ bit }) => flags & bit).map(({ meaning }) => meaning).join("; ") || "in reach";
  if (element("plain").textContent !== said) element("plain").textContent = said;
}

// Centres the view between shoulder and floor, or higher if wrist or elbow would leave it; it rests during a drag.
function frameArm() {
  const reach = ui.target.d1 + ui.target.d2;
  const highest = Math.max(ui.target.z, state.runs[0].elbow.at(-1)?.[2] ?? 0);
  if (!ui.held) state.bounds.centre[2] = Math.max(-0.45 * reach, highest - 0.65 * reach);
}

function drawAll() {
  if (!ui.machines.length) return;
  frameArm();
  const { g, w, h } = prepare(scene);
  if (state.at >= 0) { // all cores have a result
    eachRun(g, w, h, (pw, ph, t) => {
      drawMotion(g, pw, ph, t);
      drawRings(g, camera(pw, ph, state.bounds, state.view));
    });
  }
  writeNow();
  drawLane();
  writeNode();
  writeColumn();
  drawWaves();
  element("clock").textContent = `clock ${ui.machines[0].clock}`;
  const root = document.documentElement;
  root.dataset.fits = root.scrollWidth <= root.clientWidth;
}

function writeFields() {
  for (const name of ["phi", "d1", "d2"]) {
    element(name).value = ui.target[name];
    element(`${name}-said`).textContent = name === "phi" ? degrees(ui.target.phi) : `${ui.target[name].toFixed(3)} m`;
  }
  element("wrist").textContent = [ui.target.x, ui.target.y, ui.target.z].map((v) => v.toFixed(3).replace("-", "\u2212")).join(", ");
}

// -- the wrist ---------------------------------------------------------------------------------

const MOST = 1.25; // largest distance of the wrist, relative to the reach

function moveTo(p) {
  const most = MOST * (ui.target.d1 + ui.target.d2);
  const far = length(p);
  const kept = far > most ? p.map((v) => (v * most) / far) : p;
  [ui.target.x, ui.target.y, ui.target.z] = kept;
  choose("trajectory", "");
  writeFields();
}

// Moves wrist and hand by pixels of the picture and by a distance towards the camera.
function moveBy(dx, dy, nearer = 0) {
  const view = viewOf(state.parts[0]);
  const p = place();
  const pixel = view.depth(p) / (view.scale * view.distance);
  const toward = unit(sum(view.eye, p, -1));
  moveTo(sum(sum(sum(p, view.right, dx * pixel), view.up, -dy * pixel), toward, nearer * pixel));
  afterwards();
}

const partAt = (x, y) => state.parts.slice(0, state.runs.length).find((part) => x >= part.x && x < part.x + part.w && y >= part.y - 32 && y < part.y + part.h);

// Redraws the page if it is stopped; a running page redraws itself.
function afterwards() {
  if (ui.flow !== "run") drawAll();
}

// -- the controls ------------------------------------------------------------------------------

const choose = (name, value) => {
  ui[name] = value;
  element(name).value = value;
};

function setFlow(flow) {
  ui.flow = flow;
  document.querySelectorAll("button[data-flow]").forEach((button) => (button.ariaPressed = String(button.dataset.flow === flow)));
  document.documentElement.dataset.flow = flow;
}

const loaded = new Map();

async function machineOf(name) {
  if (!loaded.has(name)) loaded.set(name, Machine.load(DATA.machines.find((table) => table.name === name)));
  return loaded.get(name);
}

// The selected cores; the second only if it differs from the first.
async function useMachines() {
  const names = [...new Set([element("machine").value, element("second").value].filter(Boolean))];
  element("status").textContent = `loading ${names.join(" and ")} \u2026`;
  const machines = await Promise.all(names.map(machineOf));
  ui.machines = machines;
  machines.forEach((machine) => machine.reset());
  const [machine] = machines;
  ui.laid = layLane(machine);
  ui.followed = null;
  ui.node = machine.nodes.find(({ name }) => name === ui.node?.name) ?? machine.nodes.at(-1);
  ui.watched = ["s_axis_tvalid", "s_axis_tready", "m_axis_tvalid", "m_axis_tready", ...(machine.places ? ["g_fifo.u_credits.credits"] : []), "m_axis_tuser", "m_axis_tdata"];
  ui.watched.push(ui.node.signal.join("."));
  element("signals").replaceChildren(...[...machine.signals.keys()].sort().map((name) => new Option(name)));
  makeColumn();
  forget();
  element("status").textContent = "";
  document.documentElement.dataset.ready = names.join(" ");
  drawAll();
}

function save() {
  const url = URL.createObjectURL(new Blob([vcd(ui.machines[0])], { type: "text/plain" }));
  const a = Object.assign(document.createElement("a"), { href: url, download: "waves.vcd" });
  a.click();
  URL.revokeObjectURL(url);
}

function listen() {
  for (const name of ["phi", "d1", "d2"]) {
    element(name).addEventListener("input", (event) => {
      ui.target[name] = Number(event.target.value);
      choose("trajectory", "");
      if (name !== "phi") forget();
      writeFields();
      afterwards();
    });
  }
  element("axis").addEventListener("change", (event) => {
    ui.axis = event.target.value;
    useRobot("arm"); // another arm's joints belong to its own axis
    forget();
    afterwards();
  });
  element("robot").addEventListener("change", (event) => {
    useRobot(event.target.value);
    choose("axis", robot().axis);
    choose("trajectory", "");
    Object.assign(ui.target, robot().target);
    forget();
    writeFields();
    afterwards();
  });
  element("trajectory").addEventListener("change", (event) => {
    Object.assign(ui, { trajectory: event.target.value, at: 0 });
    const t = DATA.trajectories.find(({ name }) => name === ui.trajectory);
    if (t) FIELDS.forEach((name, i) => (ui.target[name] = t.rows[0][i]));
    forget();
    writeFields();
    afterwards();
  });
  for (const name of ["machine", "second"]) element(name).addEventListener("change", useMachines);
  document.querySelectorAll("button[data-flow]").forEach((button) => {
    button.addEventListener("click", () => (button.dataset.flow === "step" ? step() : setFlow(button.dataset.flow)));
  });
  element("speed").addEventListener("change", (event) => (ui.speed = Number(event.target.value)));
  element("ready").addEventListener("change", (event) => (ui.ready = event.target.checked));
  element("dense").addEventListener("change", (event) => (ui.dense = event.target.checked));
  element("zoom").addEventListener("input", (event) => {
    ui.zoom = Number(event.target.value);
    drawWaves();
  });
  element("watch").addEventListener("change", (event) => {
    const name = event.target.value;
    if (!ui.machines[0].signals.has(name)) return;
    ui.watched = ui.watched.includes(name) ? ui.watched.filter((each) => each !== name) : [...ui.watched, name];
    event.target.value = "";
    drawWaves();
  });
  element("save").addEventListener("click", save);
  lane.addEventListener("click", (event) => {
    const node = nodeAt(event.offsetX, event.offsetY);
    if (!node) return;
    const inside = ui.machines[0].flying.find((target) => ui.machines[0].ageOf(target) === node.time);
    Object.assign(ui, { node, followed: inside ?? ui.followed });
    ui.watched = [...ui.watched.slice(0, -1), node.signal.join(".")];
    drawAll();
  });

  let dragged = null; // last position: touch events have no movement
  scene.addEventListener("pointerdown", (event) => {
    dragged = { x: event.clientX, y: event.clientY };
    ui.handle = handleAt(event);
    ui.held = Boolean(ui.handle);
    scene.setPointerCapture(event.pointerId);
  });
  scene.addEventListener("lostpointercapture", () => {
    Object.assign(ui, { held: false, handle: null });
    afterwards();
  });
  scene.addEventListener("pointermove", (event) => {
    if (!scene.hasPointerCapture(event.pointerId)) {
      const last = ui.handle?.ring;
      ui.handle = handleAt(event);
      scene.dataset.over = Boolean(ui.handle);
      if (ui.handle?.ring !== last) afterwards();
      return;
    }
    const [dx, dy] = [event.clientX - dragged.x, event.clientY - dragged.y];
    Object.assign(dragged, { x: event.clientX, y: event.clientY });
    if (ui.handle?.ring !== undefined) {
      turnBy(ui.handle, dx, dy);
    } else if (ui.handle) {
      moveBy(dx, dy);
    } else {
      state.view.azimuth -= dx * 0.01;
      state.view.elevation = Math.max(-0.2, Math.min(1.55, state.view.elevation + dy * 0.01));
      afterwards();
    }
  });
  const [by, turned] = [6, Math.PI / 36];
  const keys = {
    ArrowLeft: [-by, 0], ArrowRight: [by, 0], ArrowUp: [0, -by], ArrowDown: [0, by], PageUp: [0, 0, -by], PageDown: [0, 0, by],
  };
  const turns = {
    ArrowLeft: [2, -turned], ArrowRight: [2, turned], ArrowUp: [0, -turned], ArrowDown: [0, turned], PageUp: [1, -turned], PageDown: [1, turned],
  };
  scene.addEventListener("keydown", (event) => {
    if (keys[event.key]) {
      event.preventDefault();
      if (event.shiftKey) turnHand(...turns[event.key]);
      else moveBy(...keys[event.key]);
    }
  });
  document.addEventListener("keydown", (event) => {
    const taken = event.target.closest?.("select, input, button") || event.ctrlKey || event.altKey || event.metaKey;
    const does = { " ": () => setFlow(ui.flow === "run" ? "step" : "run"), s: step, r: () => element("ready").click() }[event.key];
    if (does && !taken) {
      event.preventDefault();
      does();
    }
  });
  window.addEventListener("resize", drawAll);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    drawAll();
  });
}

// For the console and for tests: results of a core for targets, with every node.
function answer(table, list) {
  return machineOf(table).then((machine) => list.map((given) => {
    machine.reset();
    const words = Array.isArray(given) ? given : asked(given, machine.table).words;
    const one = { words };
    let [offered, out] = [one, null];
    for (let k = 0; k < 2000 && !out; k++) {
      const { admitted, result } = machine.tick(offered);
      if (admitted) offered = null;
      out = result;
    }
    const nodes = Object.fromEntries([...one.values].map(([name, bits]) => [name, bits.toString(16)]));
    return { words, result: one.result, flags: one.flags, latency: one.latency, nodes };
  }));
}

async function start() {
  if (typeof WebAssembly !== "object" || typeof DecompressionStream !== "function") {
    element("status").textContent = "This browser has no WebAssembly, or cannot unpack it: the core cannot run here.";
    return;
  }
  const names = DATA.machines.map(({ name }) => name);
  element("machine").replaceChildren(...names.map((name) => new Option(name)));
  element("second").replaceChildren(new Option("none", ""), ...names.map((name) => new Option(name)));
  element("axis").replaceChildren(...Object.keys(DATA.axes).map((name) => new Option(name)));
  element("robot").replaceChildren(...DATA.robots.map(({ name }) => new Option(name)));
  useRobot(ui.robot);
  element("trajectory").replaceChildren(new Option("by hand", ""), ...DATA.trajectories.map(({ name }) => new Option(name)));
  element("flags").replaceChildren(...DATA.flags.map(({ name, bit, meaning }) => {
    const item = Object.assign(document.createElement("li"), { textContent: name, title: meaning });
    Object.assign(item.dataset, { bit, name });
    return item;
  }));
  element("tools").textContent = Object.entries(DATA.tools).map(([name, version]) => `${name} ${version}`).join(", ");
  setFlow(window.matchMedia("(prefers-reduced-motion: reduce)").matches ? "step" : "run");
  readColours();
  writeFields();
  listen();
  window.playground = { answer, solve, toWords, vcd: () => vcd(ui.machines[0]), camera, laneX, rings, viewOf, pointOf, place, ui, state };
  try {
    await useMachines();
  } catch (error) {
    element("status").textContent = `The core cannot run in this browser: ${error.message}`;
    return;
  }
  requestAnimationFrame(frame);
}

start();
