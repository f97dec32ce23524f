// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- data -----------------------------------------------------------------------------------

const DATA = JSON.parse(element("data").textContent);

// runs: results of each core, as drawn in the scene; at: index of the last result; parts: place of each run's picture.
const state = { runs: [], at: -1, view: { ...VIEW }, bounds: null, colours: {}, parts: [] };

// -- words -----------------------------------------------------------------------------------

const FIELDS = ["x", "y", "z", "phi", "d1", "d2"];
const HEADROOM_BITS = DATA.headroom;
const signedWord = (bits, width) => BigInt.asIntN(width, bits);

function even(v) { // round half to even
  const floor = Math.floor(v);
  return v - floor === 0.5 ? floor + (floor % 2 ? 1 : 0) : Math.round(v);
}

// Returns the words of a target {x, y, z, phi, d1, d2} (one length unit, z along the axis) and the exponent that scales
// the reach to [1, 2), or lower if the position needs it, as in model.io.words. `fits`: true if the format holds them.
function toWords(target, width) {
  let e = 1 - exponentOf(target.d1 + target.d2);
  const lowest = e - HEADROOM_BITS;
  const place = [target.x, target.y, target.z];
  const inside = () => place.every((v) => v * 2 ** e >= -2 && v * 2 ** e < 2);
  while (e > lowest && !inside()) {
    e -= 1;
  }
  const half = 2 ** (width - 1);
  const length = (v) => Math.max(-half, Math.min(half - 1, even(v * 2 ** (e + width - 2))));
  const turns = target.phi / (2 * Math.PI);
  const angle = even((turns - even(turns)) * 2 ** width);
  const phi = ((((angle + half) % (2 * half)) + 2 * half) % (2 * half)) - half;
  const words = FIELDS.map((name) => (name === "phi" ? phi : length(target[name])));
  return { words, exponent: e, fits: inside() && words[4] !== 0 && words[5] !== 0 };
}

// Returns e of a positive number v = m 2^e with m in [1/2, 1).
function exponentOf(v) {
  let e = Math.floor(Math.log2(v)) + 1;
  while (v >= 2 ** e) e += 1;
  while (v < 2 ** (e - 1)) e -= 1;
  return e;
}

// -- the machine -----------------------------------------------------------------------------

const KEPT = 200; // clocks of the waveform

async function inflate(id) {
  const packed = Uint8Array.from(atob(element(id).textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Clocked simulation of a core; `tick` runs one clock. Targets in flight carry the node words computed so far.
class Machine {
  static async load(table) {
    const nothing = new Proxy({}, { get: () => () => 0 }); // stubs of the WASI imports: the core uses no files
    const { instance } = await WebAssembly.instantiate(await inflate(`wasm-${table.name}`), { wasi_snapshot_preview1: nothing });
    return new Machine(table, instance.exports);
  }

  constructor(table, core) {
    core._initialize();
    Object.assign(this, { table, core, clock: 0, age: 0, sent: 0, flying: [], frames: [], lost: 0, left: 0 });
    const bytes = () => new Uint8Array(core.memory.buffer);
    this.signals = new Map();
    let at = 0;
    const count = core.begin();
    for (let k = 0; k < count; k++) {
      const memory = bytes();
      let name = "";
      for (let p = core.name(k); memory[p]; p++) {
        name += String.fromCharCode(memory[p]);
      }
      const width = core.width(k);
      const words = Math.ceil(width / 32);
      const path = name.split(/[ .]/);
      this.signals.set(path.join("."), { path, width, words, at, data: core.data(k) });
      at += words;
    }
    this.words = at;
    this.nodes = table.nodes.map((node) => ({ ...node, place: this.signals.get(node.signal.join(".")) }));
    this.byTime = [];
    this.nodes.forEach((node) => (this.byTime[node.time] ??= []).push(node));
    this.go = table.folded ? this.signals.get("g_fold.u_core.go") : null;
    this.reset();
  }

  reset() {
    Object.assign(this, { flying: [], offered: null });
    for (let k = 0; k < 4; k++) {
      this.put("rst", 1n);
      this.core.settle();
      this.core.edge();
    }
    this.put("rst", 0n);
    this.places = this.table.folded ? 0 : Number(this.live("g_fifo.u_credits.credits"));
  }

  put(name, bits) {
    const { data, words } = this.signals.get(name);
    const memory = new Uint32Array(this.core.memory.buffer, data, words);
    for (let k = 0; k < words; k++) {
      memory[k] = Number((bits >> BigInt(32 * k)) & 0xffffffffn);
    }
  }

  // Returns the bits of a signal in a frame of the waveform, by default the last one.
  bits(signal, frame = this.frames.at(-1)) {
    let bits = 0n;
    for (let k = signal.words - 1; k >= 0; k--) {
      bits = (bits << 32n) | BigInt(frame.words[signal.at + k]);
    }
    return bits;
  }

  live(name) {
    const { data, words } = this.signals.get(name);
    return new Uint32Array(this.core.memory.buffer, data, words).reduceRight((bits, word) => (bits << 32n) | BigInt(word), 0n);
  }

  // Runs one clock. `target` {words, ...}, if any, is driven at the input; a result leaves if the receiver is ready.
  // Returns { admitted, result }: true if the target was accepted, and the target whose result left.
  tick(target, ready = true) {
    const { table: { width } } = this;
    this.put("s_axis_tvalid", target ? 1n : 0n);
    this.put("m_axis_tready", ready ? 1n : 0n);
    if (target) {
      const mask = (1n << BigInt(width)) - 1n;
      const data = target.words.reduceRight((bits, word) => (bits << BigInt(width)) | (BigInt(word) & mask), 0n);
      this.put("s_axis_tdata", data);
      this.put("s_axis_tuser", BigInt(this.sent % 256));
    }
    this.core.settle();
    const frame = { clock: this.clock, words: new Uint32Array(this.core.memory.buffer, this.core.show(), this.words).slice() };
    this.frames.push(frame);
    if (this.frames.length > KEPT) {
      this.frames.shift();
    }

    const high = (name) => this.bits(this.signals.get(name)) === 1n;
    const admitted = Boolean(target) && high("s_axis_tready");
    if (admitted) {
      Object.assign(target, { tag: this.sent % 256, number: this.sent, at: this.clock, since: this.age, values: new Map() });
      this.flying.push(target);
      this.sent += 1;
    }
    for (const one of this.flying) {
      for (const node of this.byTime[this.age - one.since] ?? []) {
        one.values.set(node.name, this.bits(node.place));
      }
    }
    let result = null;
    if (high("m_axis_tvalid") && ready) {
      result = this.flying.shift();
      this.answer(result);
    }
    this.core.edge();
    this.age += !this.go || this.bits(this.go) === 1n;
    this.clock += 1;
    return { admitted, result };
  }

  answer(target) {
    const { width } = this.table;
    const user = this.bits(this.signals.get("m_axis_tuser"));
    const data = this.bits(this.signals.get("m_axis_tdata"));
    this.left += 1;
    this.lost += Number(user & 255n) !== target.tag;
    target.flags = Number(user >> 8n);
    target.latency = this.clock - target.at;
    target.result = FIELDS.map((_, k) => Number(signedWord(data >> BigInt(k * width), width)));
  }

  // ageOf: datapath clocks since a target's admission, at the last clock. waits: true if its result is in the FIFO.
  ageOf(target) {
    return this.age - target.since - 1;
  }

  waits(target) {
    return !this.table.folded && this.ageOf(target) > this.table.latency - 2;
  }

  valueOf(node, bits) {
    return Number(node.signed ? signedWord(bits, node.width) : bits) / 2 ** node.frac;
  }
}
