// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Which panels are shown and how large: kept by the browser for the next trace.

const kKey = 'kerfbench-viewer-layout';
/** @type {Record<string, number>} */
const kWeights = { machine: 0.43, pins: 0.39, plots: 0.18, dieline: 0.38, frames: 0.28, text: 0.34, left: 0.64, right: 0.36 };

/** @param {string[]} names of the panels */
export function layoutStore(names) {
  const kept = read();
  return {
    /** @param {string} name */
    shown: (name) => !kept.hidden.includes(name),
    /** @param {string} name */
    weight: (name) => kept.weights[name] ?? kWeights[name] ?? 1,
    /** @param {Record<string, {weight: number, hidden?: boolean}>} panes @param {{weight: number}[]} columns left and right */
    keep(panes, [left, right]) {
      const weights = Object.fromEntries([...names.map((name) => [name, panes[name].weight]), ['left', left.weight], ['right', right.weight]]);
      try {
        localStorage.setItem(kKey, JSON.stringify({ weights, hidden: names.filter((name) => panes[name].hidden) }));
      } catch {
        // A page from disk may have no store: the layout is that of this visit.
      }
    },
  };
}

/** @returns {{weights: Record<string, number>, hidden: string[]}} */
function read() {
  try {
    const { weights, hidden } = JSON.parse(localStorage.getItem(kKey) ?? '{}');
    return { weights: weights ?? {}, hidden: Array.isArray(hidden) ? hidden : [] };
  } catch {
    return { weights: {}, hidden: [] };
  }
}
