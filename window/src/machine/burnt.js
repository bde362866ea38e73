// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The burnt lines on the sheet. All of a span of time are given to the graphics card once; how many of them are drawn
// follows the time, so that the cut grows and shrinks as the cursor moves. The last moment of it still glows.

import { Color, Group } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { countUpTo } from '../trace/search.js';
import { segmentsOf } from './burnt_paths.js';

/** @typedef {import('../trace/tables.js').Table} Table */

const kHot_s = 0.06;

export class Burnt {
  constructor() {
    this.group = new Group();
    this.group.matrixAutoUpdate = false;
    this.cold = line(new Color(0.05, 0.022, 0.012), 1.9);
    this.hot = line(new Color(1.0, 0.36, 0.08), 2.6);
    this.hot.renderOrder = 1;
    this.group.add(this.cold, this.hot);
    this.segments = segmentsOf([]);
    /** @type {unknown} */
    this.given = undefined;
  }

  /** @param {Table[]} tables */
  give(tables) {
    const key = tables.map((table) => table.t_s.length).join() + (tables[0]?.t_s[0] ?? '');
    if (key === this.given) return;
    this.given = key;
    this.segments = segmentsOf(tables);
    replace(this.cold, this.segments.points);
  }

  /** @param {number} t_s @param {boolean} glowing */
  show(t_s, glowing) {
    const { starts_s, ends_s, points } = this.segments;
    const done = countUpTo(ends_s, t_s);
    const geometry = /** @type {LineSegmentsGeometry} */ (this.cold.geometry);
    geometry.instanceCount = done;
    this.cold.visible = done > 0;
    // The segment that is burnt right now is as long as it has got.
    const hot = [];
    if (glowing) {
      for (let i = countUpTo(ends_s, t_s - kHot_s); i < done; ++i) hot.push(...points.subarray(6 * i, 6 * i + 6));
    }
    if (done < ends_s.length && starts_s[done] < t_s) {
      const share = (t_s - starts_s[done]) / (ends_s[done] - starts_s[done]);
      const [x, y, z, u, v, w] = points.subarray(6 * done, 6 * done + 6);
      hot.push(x, y, z, x + share * (u - x), y + share * (v - y), w);
    }
    this.hot.visible = hot.length > 0;
    if (hot.length) replace(this.hot, new Float32Array(hot));
  }

  /** @param {number} width_px @param {number} height_px */
  resize(width_px, height_px) {
    for (const lines of [this.cold, this.hot]) lines.material.resolution.set(width_px, height_px);
  }
}

/** @param {Color} color @param {number} width_px */
function line(color, width_px) {
  const lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: width_px, toneMapped: false }));
  lines.material.color.copy(color);
  lines.frustumCulled = false;
  lines.visible = false;
  return lines;
}

/** @param {LineSegments2} lines @param {Float32Array} points */
function replace(lines, points) {
  lines.geometry.dispose();
  lines.geometry = new LineSegmentsGeometry();
  if (points.length) lines.geometry.setPositions(points);
}
