// SPDX-License-Identifier: Apache-2.0
// Part of the page of scripts/playground/page.py, which puts its scripts into one function.

const DATA = JSON.parse(element("data").textContent);

// runs: of each machine its answers as the scene draws them; at: the last of them; parts: where the picture of each run is.
const state = { runs: [], at: -1, view: { ...VIEW }, bounds: null, colours: {}, parts: [] };
