// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The run at a glance: for each interval of 100 s, 10 s, 1 s and 100 ms how many edges each pin had, between which values
// the machine moved, how long the laser was lit. Coarse levels are read when the trace is opened, finer ones where they are looked at.

/**
 * @typedef {import('./details.js').Details} Details
 * @typedef {{from_s: number, step_s: number, rows: number, pins: {id: number, edges: number[], level: number[]}[],
 *   columns: Record<string, {min: (number | null)[], max: (number | null)[]}>, lit_s: number[]}} OverviewPart
 */

const kRowsOfMessage = 100;
/** @type {[number, string][]} coarse first */
const kLevels = [[100, '/overview/100s'], [10, '/overview/10s'], [1, '/overview/1s'], [0.1, '/overview/100ms']];

export class Overview {
  end_s = 0;

  /** @param {Details} details */
  constructor(details) {
    this.details = details;
    this.levels = kLevels.filter(([, topic]) => details.file.has(topic)).map(([step_s, topic]) => ({ step_s, topic }));
  }

  /** Reads the coarse levels, and of the finest one the end. */
  async open() {
    for (const { step_s, topic } of this.levels) if (step_s >= 10) await this.details.wait(topic, -Infinity, Infinity);
    const finest = this.levels[this.levels.length - 1];
    const { file } = this.details;
    const chunks = finest ? file.chunksOf(finest.topic) : [];
    if (!chunks.length) return;
    for (const part of await this.#wait(finest.topic, file.chunks[chunks[chunks.length - 1]].start_s, Infinity))
      this.end_s = Math.max(this.end_s, part.from_s + part.rows * part.step_s);
  }

  /** The coarsest level whose intervals are no longer than asked, else the finest. @param {number} step_s */
  levelFor(step_s) {
    return this.levels.find((level) => level.step_s <= step_s) ?? this.levels[this.levels.length - 1];
  }

  /**
   * Messages of a level that hold a part of a span of time, as far as they have come; coarser ones stand in where they have not.
   * @param {number} from_s @param {number} to_s @param {number} step_s longest interval that is wanted
   * @returns {OverviewPart[]}
   */
  parts(from_s, to_s, step_s) {
    const wanted = this.levelFor(step_s);
    if (!wanted) return [];
    for (let i = this.levels.indexOf(wanted); i >= 0; --i) {
      const { topic, step_s: step } = this.levels[i];
      const { parts, complete } = this.#peek(topic, from_s - kRowsOfMessage * step, to_s);
      if (complete) return parts.filter((part) => part.from_s < to_s && part.from_s + part.rows * part.step_s > from_s);
    }
    return [];
  }

  /**
   * Levels of all pins just before a time on the grid of the finest level; undefined until they have come.
   * @param {number} t_s @returns {Map<number, number> | undefined}
   */
  levelsAt(t_s) {
    if (t_s <= 0) return new Map(); // All pins are low before their first edge.
    const finest = this.levels[this.levels.length - 1];
    if (!finest) return new Map();
    const { step_s, topic } = finest;
    const { parts, complete } = this.#peek(topic, t_s - (kRowsOfMessage + 1) * step_s, t_s);
    if (!complete) return undefined;
    const part = parts.findLast((one) => one.from_s < t_s - 0.5 * step_s);
    if (!part) return new Map();
    const row = Math.min(part.rows, Math.round((t_s - part.from_s) / step_s)) - 1;
    return new Map(part.pins.map(({ id, level }) => [id, level[row]]));
  }

  /** @param {string} topic @param {number} from_s @param {number} to_s */
  #peek(topic, from_s, to_s) {
    const { parts, complete } = this.details.peek(topic, from_s, to_s);
    return { parts: /** @type {OverviewPart[]} */ (parts.flat()), complete };
  }

  /** @param {string} topic @param {number} from_s @param {number} to_s @returns {Promise<OverviewPart[]>} */
  async #wait(topic, from_s, to_s) {
    return /** @type {OverviewPart[]} */ ((await this.details.wait(topic, from_s, to_s)).flat());
  }
}
