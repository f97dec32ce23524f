// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/__main__.py, which puts its scripts into one function.

// -- double precision -------------------------------------------------------------------------

// Returns the flags and the pose of input words by the equations of model/dataflow/lean.py.
// Flags and sums prone to cancellation are computed exactly from the words.
function solve(words, width) {
  const [x, y, z, , d1, d2] = words.map(BigInt);
  const [wide, thin, s] = [(d1 + d2) ** 2n, (d1 - d2) ** 2n, x * x + y * y + z * z];
  const bad = d1 <= 0n || d2 <= 0n;
  const flag = {
    too_far: !bad && s > wide, too_near: !bad && s < thin, on_axis: x === 0n && y === 0n, at_shoulder: s === 0n, bad_length: bad,
  };
  const p = Math.sqrt(Number(s));
  const rho = Math.sqrt(Number(x * x + y * y));
  const [u_x, u_y] = flag.on_axis ? [1, 0] : [Number(x) / rho, Number(y) / rho];
  const [sin_el, cos_el] = flag.at_shoulder ? [1, 0] : [Number(z) / p, rho / p];

  let [qe_w, qe_i, cos_a, sin_a] = [1, 0, 1, 0]; // folded
  if (flag.too_far || bad) {
    [qe_w, qe_i] = [0, -1];
  } else if (flag.too_near || flag.at_shoulder) {
    cos_a = flag.too_near && d1 < d2 ? -1 : 1;
  } else {
    const [far, near] = [Math.sqrt(Number(wide - s)), Math.sqrt(Number(s - thin))];
    const root = 2 * Math.sqrt(Number(d1 * d2));
    [qe_w, qe_i] = [far / root, -near / root];
    const law = 2 * Number(d1) * p;
    [cos_a, sin_a] = [Number(s + (d1 + d2) * (d1 - d2)) / law, (far * near) / law];
  }
  const half = (c, s) => (c >= 0 ? [(1 + c) / 2, s / 2] : [s / 2, (1 - c) / 2]);
  const [azimuth, tilt, arm] = [half(-u_y, u_x), half(sin_el, cos_el), half(cos_a, sin_a)];
  const phi = (words[3] / 2 ** width) * Math.PI; // phi / 2
  const turns = [[azimuth[0], 0, 0, azimuth[1]], [tilt[0], tilt[1], 0, 0], [Math.cos(phi), 0, 0, Math.sin(phi)], [arm[0], -arm[1], 0, 0]];
  const product = turns.reduce(multiply);
  const norm = (product[3] < 0 ? -1 : 1) / Math.hypot(...product);
  return { flag, qs: product.map((v) => v * norm), qe: [qe_w, qe_i] };
}

// -- quaternions ------------------------------------------------------------------------------

const multiply = (a, b) => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
  a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
  a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];
const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
const rotate = (q, v) => multiply(multiply(q, [0, ...v]), conjugate(q)).slice(1);

// Returns the positions of elbow and wrist; at rest the forearm is folded back onto the upper arm.
function forward(qs, qe, d1, d2) {
  const bent = rotate([...qe, 0, 0], [0, 0, -d2]);
  return { elbow: rotate(qs, [0, 0, d1]), wrist: rotate(qs, sum([0, 0, d1], bent)) };
}

// Returns the angles of the seven joints (rad, -pi to pi), branch 0; hand: orientation Q_h in the core's frame.
function sevenAngles(qs, [qe_w, qe_i], hand) {
  const zxz = ([w, i, j, k]) => {
    const [s, d] = [Math.atan2(k, w), Math.atan2(j, i)];
    return [s + d, 2 * Math.atan2(Math.hypot(i, j), Math.hypot(w, k)), s - d];
  };
  const fore = multiply(qs, [-qe_i, qe_w, 0, 0]); // Q_s R_x(th4)
  return [...zxz(qs), 2 * Math.atan2(qe_w, -qe_i), ...zxz(multiply(conjugate(fore), hand))].map(wrap);
}
const wrap = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

// Returns the angle of the rotation from a to b (rad); signs and lengths are ignored.
function angleBetween(a, b) {
  const [w, ...v] = multiply(conjugate(a), b);
  return 2 * Math.atan2(length(v), Math.abs(w));
}
