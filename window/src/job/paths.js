// SPDX-License-Identifier: Apache-2.0
// Names of files: as the window's lists have them (relative to the folder, shipped ones below `shipped/`), and as a scenario has
// them (relative to its own folder).
// @ts-check

/** @typedef {{ folder: string, shipped?: string }} Places absolute folders: the one that is served, and what `shipped/` stands for */

/** @param {Places} places @param {string} path of a list @returns {string[]} parts of the absolute path */
function absolute(places, path) {
  const of_shipped = path.startsWith('shipped/') && places.shipped;
  const whole = of_shipped
    ? `${places.shipped}/${path.slice('shipped/'.length)}`
    : path.startsWith('/')
      ? path
      : `${places.folder}/${path}`;
  /** @type {string[]} */
  const parts = [];
  for (const part of whole.split('/')) {
    if (part === '..') parts.pop();
    else if (part !== '' && part !== '.') parts.push(part);
  }
  return parts;
}

/**
 * How a scenario names a file.
 * @param {Places} places @param {string} scenario path of a list @param {string} file path of a list
 */
export function nameInScenario(places, scenario, file) {
  const from = absolute(places, scenario).slice(0, -1);
  const to = absolute(places, file);
  let same = 0;
  while (same < from.length && same < to.length - 1 && from[same] === to[same]) ++same;
  return [...from.slice(same).map(() => '..'), ...to.slice(same)].join('/');
}

/**
 * The path in a list that a scenario's name of a file means; the name itself if none fits.
 * @param {Places} places @param {string} scenario @param {string} name @param {string[]} paths of the list
 */
export function pathOfName(places, scenario, name, paths) {
  const folder = scenario.slice(0, scenario.lastIndexOf('/') + 1);
  const wanted = name.startsWith('/')
    ? absolute(places, name).join('/')
    : absolute(places, `${folder}${name}`).join('/');
  return paths.find((path) => absolute(places, path).join('/') === wanted) ?? name;
}
