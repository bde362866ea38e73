// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The burnt lines on the sheet. All of a span of time are given to the graphics card once; how many of them are drawn
// follows the time, so that the cut grows and shrinks as the cursor moves. The last moment of it still glows.

import { Color, Group } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { countUpTo } from '../trace/search.js';

/** @typedef {import('../trace/tables.js').Table} Table */

const kAbove_mm = 0.12; // Over the board's face, so that the line is not lost in it.
const kHot_s = 0.06;

/**
 * Segments of burnt paths: pairs of points, in order of time.
 * @param {Table[]} tables of `/burnt`
 * @returns {{ends_s: Float64Array, starts_s: Float64Array, points: Float32Array}} points: x, y, z of both ends of each, in S of unit 0
 */
export function segmentsOf(tables) {
  const rows = tables.reduce((sum, table) => sum + table.t_s.length, 0);
  const starts_s = new Float64Array(rows);
  const ends_s = new Float64Array(rows);
  const points = new Float32Array(6 * rows);
  let n = 0;
  for (const { t_s, columns: { x_mm, y_mm, start } } of tables) {
    for (let i = 1; i < t_s.length; ++i) {
      if (start[i]) continue;
      starts_s[n] = t_s[i - 1];
      ends_s[n] = t_s[i];
      points.set([x_mm[i - 1], y_mm[i - 1], kAbove_mm, x_mm[i], y_mm[i], kAbove_mm], 6 * n);
      ++n;
    }
  }
  return { starts_s: starts_s.subarray(0, n), ends_s: ends_s.subarray(0, n), points: points.subarray(0, 6 * n) };
}

/**
 * Burnt paths as the motion has them, for the time of which the trace does not tell them yet.
 * @param {Table[]} motion @param {number} from_s @param {number} start_x_mm place of S of unit 0 in W at belt 0
 * @returns {Table}
 */
export function burntFrom(motion, from_s, start_x_mm) {
  /** @type {{t: number[], x: number[], y: number[], start: number[]}} */
  const rows = { t: [], x: [], y: [], start: [] };
  let lit = false;
  for (const { t_s, columns } of motion) {
    for (let i = countUpTo(t_s, from_s); i < t_s.length; ++i) {
      const x = columns.spot_x_mm[i] - start_x_mm - (columns.belt_mm?.[i] ?? 0) - (columns.slip_x_mm?.[i] ?? 0);
      const y = columns.spot_y_mm[i] - (columns.slip_y_mm?.[i] ?? 0);
      const burns = columns.lit[i] > 0.5 && Number.isFinite(x + y);
      if (burns) {
        rows.t.push(t_s[i]);
        rows.x.push(x);
        rows.y.push(y);
        rows.start.push(lit ? 0 : 1);
      }
      lit = burns;
    }
  }
  return { t_s: Float64Array.from(rows.t), columns: { x_mm: Float64Array.from(rows.x), y_mm: Float64Array.from(rows.y), start: Float64Array.from(rows.start) } };
}

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
