// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts the scripts of this folder into one function.

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
