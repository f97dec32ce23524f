// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/page.py, which puts its scripts into one function.

const DATA = JSON.parse(element("data").textContent);

// runs: results of each core, as drawn in the scene; at: index of the last result; parts: place of each run's picture.
const state = { runs: [], at: -1, view: { ...VIEW }, bounds: null, colours: {}, parts: [] };
