// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/report/page.py, which puts the scripts of this folder into one function.

const { trajectories: DATA, files: FILES } = JSON.parse(document.getElementById("data").textContent);
const RATE = 20; // targets a second at speed 1; a clip has its own

// shown: a trajectory; runs: that, and the same with what each further machine made of it. frame: a step of the player, in which every arm of a clip has a target; arm: the one that is looked at, by its number;
// parts: where the picture of each run is; at: the target of that arm in that frame. What is no clip has one target a frame. figure: of the paper, from 0.
const state = { shown: null, runs: [], frame: 0, arm: 0, at: 0, figure: 0, playing: false, last: null, view: { ...VIEW }, colours: {}, parts: [] };
const armsIn = (t) => (t.clip ? t.clip.arms.length : 1);
const framesIn = (t) => t.target.length / armsIn(t);
const runsOf = (t) => [t, ...t.beside.map((run) => ({ ...t, ...run }))];
const PLACES = runsOf(DATA[0]).map((_, i) => (i ? String(i + 1) : "")); // what the elements of each run are called by
const several = PLACES.length > 1;
const rateOf = (t) => (t.clip ? t.clip.rate : RATE);
