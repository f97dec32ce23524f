// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- a waveform --------------------------------------------------------------------------------

const waves = element("waves");
const ROW = 26;
const WAVES_LEFT = 190;

function drawWaves() {
  const machine = ui.machines[0];
  waves.style.height = `${ui.watched.length * ROW + 30}px`;
  const { g, w, h } = prepare(waves);
  const { colours: c } = state;
  const frames = machine.frames.slice(-ui.zoom);
  const x = (k) => WAVES_LEFT + (k / ui.zoom) * (w - WAVES_LEFT - 8);
  const wide = x(1) - x(0);
  const every = tickStep(ui.zoom, Math.floor((w - WAVES_LEFT) / 60));
  frames.forEach(({ clock }, k) => {
    if (clock % every === 0) {
      line(g, [[x(k), 4], [x(k), h - 22]], c.line, 0.6);
      text(g, String(clock), x(k), h - 12, c.soft, "center");
    }
  });
  ui.watched.forEach((name, i) => {
    const signal = machine.signals.get(name);
    const [top, bottom] = [i * ROW + 6, (i + 1) * ROW - 2];
    text(g, name.replace(/^g_\w+\.u_core\./, ""), 6, (top + bottom) / 2, c.text);
    const node = machine.nodes.find(({ place }) => place === signal);
    const values = frames.map((frame) => machine.bits(signal, frame));
    if (signal.width === 1) {
      const points = values.flatMap((bit, k) => [[x(k), bit ? top : bottom], [x(k + 1), bit ? top : bottom]]);
      line(g, points, c.upper, 1.5);
    } else {
      drawBus(g, values, x, top, bottom, (bits, room) => {
        const decoded = node ? short(machine.valueOf(node, bits)) : `0x${hex(bits, signal.width)}`;
        return g.measureText(decoded).width < room ? decoded : "";
      }, wide);
    }
  });
}

// Draws a word as a bus: two lines that cross at changes, with the value where it fits.
function drawBus(g, values, x, top, bottom, label) {
  const { colours: c } = state;
  for (let from = 0; from < values.length;) {
    let to = from + 1;
    while (to < values.length && values[to] === values[from]) to += 1;
    const [a, b] = [x(from), x(to)];
    const slope = Math.min(4, (b - a) / 2);
    const middle = (top + bottom) / 2;
    line(g, [[a, middle], [a + slope, top], [b - slope, top], [b, middle], [b - slope, bottom], [a + slope, bottom], [a, middle]], c.plane, 1.2);
    const said = label(values[from], b - a - 10);
    if (said) {
      text(g, said, (a + b) / 2, middle, c.text, "center");
    }
    from = to;
  }
}

const VCD_DEPTH = 4; // scopes that `make run WAVES=1` records
const CLOCK_NS = 10;

// Returns the waveform as a VCD, with signals in their Verilog scopes.
function vcd(machine) {
  const scopes = { signals: [], inner: new Map() };
  const codes = [];
  for (const [, signal] of machine.signals) {
    if (signal.path.length > VCD_DEPTH) continue;
    let scope = scopes;
    for (const name of signal.path.slice(0, -1)) {
      if (!scope.inner.has(name)) scope.inner.set(name, { signals: [], inner: new Map() });
      scope = scope.inner.get(name);
    }
    let code = "";
    for (let n = codes.length + 1; n > 0; n = Math.floor((n - 1) / 94)) code += String.fromCharCode(33 + ((n - 1) % 94));
    codes.push({ signal, code });
    scope.signals.push({ signal, code });
  }
  const out = ["$timescale 1ns $end"];
  const declare = (name, { signals, inner }) => {
    out.push(`$scope module ${name} $end`);
    for (const { signal, code } of signals) {
      const range = signal.width > 1 ? ` [${signal.width - 1}:0]` : "";
      out.push(`$var wire ${signal.width} ${code} ${signal.path.at(-1)}${range} $end`);
    }
    inner.forEach((scope, each) => declare(each, scope));
    out.push("$upscope $end");
  };
  declare("ik_axis", scopes);
  out.push("$enddefinitions $end");
  const clocks = codes.filter(({ signal }) => signal.path.at(-1) === "clk");
  const before = new Map();
  machine.frames.forEach((frame, k) => {
    out.push(`#${k * CLOCK_NS}`, ...clocks.map(({ code }) => `1${code}`));
    for (const { signal, code } of codes) {
      if (signal.path.at(-1) === "clk") continue;
      const bits = machine.bits(signal, frame);
      if (before.get(code) !== bits) {
        before.set(code, bits);
        out.push(signal.width === 1 ? `${bits}${code}` : `b${bits.toString(2)} ${code}`);
      }
    }
    out.push(`#${k * CLOCK_NS + CLOCK_NS / 2}`, ...clocks.map(({ code }) => `0${code}`));
  });
  out.push(`#${machine.frames.length * CLOCK_NS}`, "");
  return out.join("\n");
}
