// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Which traces there are to look at: those of the folder that is served, the newest first.

/** @typedef {{ path: string, title: string, verdict: string, when: string }} Choice `when`: ISO, UTC; empty: not known */

/** Folder of a path. @param {string} path */
const folderOf = (path) => path.slice(0, Math.max(0, path.lastIndexOf('/')));

/** When results were made, by the name of their folder, "20261129T120509Z-0123abcd". @param {string} folder */
function whenOf(folder) {
  const found = /(?:^|\/)(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)Z-[^/]*$/.exec(folder);
  return found ? `${found[1]}-${found[2]}-${found[3]}T${found[4]}:${found[5]}:${found[6]}Z` : '';
}

/**
 * Traces of the folder with what is known of their runs, the newest first; those of which no time is known are last, by name.
 * @param {{ traces?: { path: string }[], runs?: { path: string, scenario: string, verdict: string | null, when: string }[] }} files answer of /api/files
 * @returns {Choice[]}
 */
export function choicesOf({ traces = [], runs = [] }) {
  const byFolder = new Map(runs.map((run) => [run.path, run]));
  return traces
    .map(({ path }) => {
      const run = byFolder.get(folderOf(path));
      return { path, title: run?.scenario || path, verdict: run?.verdict ?? '', when: run?.when || whenOf(folderOf(path)) };
    })
    .sort((a, b) => (a.when === b.when ? a.path.localeCompare(b.path) : a.when < b.when ? 1 : -1));
}
