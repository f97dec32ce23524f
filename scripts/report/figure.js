// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/__main__.py, which puts the scripts of this folder into one function.

// -- data -----------------------------------------------------------------------------------

const { trajectories: DATA, files: FILES } = JSON.parse(document.getElementById("data").textContent);
const RATE = 20; // targets per second at speed 1; clips have their own rate

// shown: a trajectory; runs: one entry per datapath. frame: a step of the player, with a target for every arm of a clip
// or a single target; arm: index of the selected arm; at: index of its target in the frame. parts: position of each
// run's picture. figure: figure of the paper, counted from 0.
const state = { shown: null, runs: [], frame: 0, arm: 0, at: 0, figure: 0, playing: false, last: null, view: { ...VIEW }, colours: {}, parts: [] };
const armsIn = (t) => (t.clip ? t.clip.arms.length : 1);
const framesIn = (t) => t.target.length / armsIn(t);
const runsOf = (t) => [t, ...t.beside.map((run) => ({ ...t, ...run }))];
const PLACES = runsOf(DATA[0]).map((_, i) => (i ? String(i + 1) : "")); // id suffix of each run's elements
const several = PLACES.length > 1;
const rateOf = (t) => (t.clip ? t.clip.rate : RATE);

// -- the figure of a clip -------------------------------------------------------------------

const TRAIL = 1; // length of the hands' trails (s)
const FRONT = Math.PI / 5; // angle between the camera and the facing direction

// Returns point k of a flat list of x, y, z. In lists of nodes, point 0 is the root; the others are relative to it.
const triple = (list, k, unit) => [0, 1, 2].map((i) => list[3 * k + i] * unit);

function node(clip, frame, k) {
  const root = triple(clip.nodes[frame], 0, clip.unit);
  return k ? sum(root, triple(clip.nodes[frame], k, clip.unit)) : root;
}

const ownJoint = (clip, frame, k) => sum(node(clip, frame, 0), triple(clip.own[frame], k, clip.unit));

// Returns a function that converts a point relative to an arm's shoulder, in the clip's axes, to the page's frame.
function fromShoulder(clip, frame, arm) {
  const shoulder = node(clip, frame, clip.arms[arm].upper);
  return (p) => sum(shoulder, clip.place.map((row) => dot(row, p)));
}

// Returns bounds that follow the figure, so that it stays large during a long walk; the floor is fixed.
function boundsOfFigure(clip, frame) {
  const root = node(clip, frame, 0);
  const { floor, radius } = clip;
  const step = 10 ** Math.floor(Math.log10(radius));
  const centre = [root[0], root[1], clip.middle ?? root[2]];
  return { centre, radius: 0.92 * radius, floor, step: radius / step < 2.5 ? step / 2 : step };
}

function bonesOf(clip, frame) {
  const points = clip.parents.map((_, k) => node(clip, frame, k));
  return clip.parents.flatMap((parent, k) => (parent < 0 ? [] : [{ ends: [points[parent], points[k]], part: clip.parts[k] }]));
}

function drawTrails(g, project, t, frame) {
  const { clip } = t;
  const from = Math.max(0, Math.round(frame - TRAIL * clip.rate));
  const frames = Array.from({ length: frame - from + 1 }, (_, i) => from + i);
  for (const { hand } of clip.arms) {
    line(g, frames.map((n) => project(node(clip, n, hand))), state.colours.goal, 2);
  }
}

function drawGhost(g, project, clip, frame, thick) {
  g.globalAlpha = 0.45;
  clip.arms.forEach(({ upper }, i) => {
    const joints = [node(clip, frame, upper), ownJoint(clip, frame, 2 * i), ownJoint(clip, frame, 2 * i + 1)];
    line(g, joints.map(project), state.colours.ghost, 2 * thick);
  });
  g.globalAlpha = 1;
}

function drawFigure(g, w, h, t) {
  const { frame, colours } = state;
  const { clip } = t;
  const view = camera(w, h, boundsOfFigure(clip, frame), state.view);
  const { project, depth, scale } = view;
  drawFloor(g, project, view.bounds);
  drawAxes(g, view.direction, h, clip.place);
  drawTrails(g, project, t, frame);
  const bones = bonesOf(clip, frame);
  const { floor } = clip;
  g.globalAlpha = 0.2;
  for (const { ends } of bones) {
    line(g, ends.map((p) => project([p[0], p[1], floor])), colours.joint, Math.max(2, 0.02 * scale * clip.radius));
  }
  g.globalAlpha = 1;
  const thick = Math.max(4, 0.032 * scale * clip.radius);
  const place = fromShoulder(clip, frame, state.arm);
  drawPlane(g, (p) => project(place(p)), t, state.at);
  drawGhost(g, project, clip, frame, thick);
  const looks = [
    { colour: colours.body, width: 0.8 * thick },
    { colour: colours.upper, width: thick },
    { colour: colours.fore, width: 0.85 * thick },
    { colour: colours.body, width: 2.2 * thick },
  ];
  bones.sort((a, b) => depth(b.ends[0]) + depth(b.ends[1]) - depth(a.ends[0]) - depth(a.ends[1]));
  for (const { ends, part } of bones) {
    const points = ends.map(project);
    line(g, points, colours.card, looks[part].width + 2);
    line(g, points, looks[part].colour, looks[part].width);
  }
  for (const { upper, fore, hand } of clip.arms) {
    [upper, fore, hand].forEach((k) => disc(g, project(node(clip, frame, k)), Math.max(2.2, 0.32 * thick), colours.joint));
  }
  ring(g, project(place(t.target[state.at])), 0.45 * thick + 4);
}
