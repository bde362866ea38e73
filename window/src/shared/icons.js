// SPDX-License-Identifier: Apache-2.0
// Signs on buttons, drawn: fonts differ in which signs they have.
// @ts-check
import { svg } from './dom.js';

/** Paths in a field of 16 by 16; those in `filled` are areas, the others lines. */
const kLines = {
  undo: 'M3 7h6.5a3.5 3.5 0 0 1 0 7H6M6 3.5 2.5 7 6 10.5',
  redo: 'M13 7H6.5a3.5 3.5 0 0 0 0 7H10M10 3.5 13.5 7 10 10.5',
  close: 'M4 4l8 8M12 4l-8 8',
  up: 'M8 13V3M4 7l4-4 4 4',
  down: 'M8 3v10M4 9l4 4 4-4',
};
const kAreas = {
  play: 'M4 2.5v11l9.5-5.5z',
  pause: 'M4 3h3v10H4zM9 3h3v10H9z',
  first: 'M3 3h2v10H3zM13.5 3v10L6 8z',
  lineBack: 'M8 3v10L1.5 8zM14.5 3v10L8 8z',
  lineOn: 'M8 3v10l6.5-5zM1.5 3v10L8 8z',
  periodBack: 'M11 3.5v9L5 8z',
  periodOn: 'M5 3.5v9L11 8z',
};

/** @param {keyof typeof kLines | keyof typeof kAreas} name @returns {any} */
export function icon(name) {
  const line = /** @type {any} */ (kLines)[name];
  return svg(
    'svg',
    { class: 'icon', viewBox: '0 0 16 16', 'aria-hidden': 'true' },
    svg(
      'path',
      line
        ? {
            d: line,
            fill: 'none',
            stroke: 'currentColor',
            'stroke-width': 1.6,
            'stroke-linecap': 'round',
            'stroke-linejoin': 'round',
          }
        : { d: /** @type {any} */ (kAreas)[name], fill: 'currentColor' },
    ),
  );
}
