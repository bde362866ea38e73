// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The machine in 3-D while a run goes on.

import { h, fill, say } from './shared/dom.js';
import { arrived, startClock, ticked } from './live/clock.js';
import { follow, LiveTrace } from './live/stream.js';
import { burntFrom } from './machine/burnt_paths.js';
import { machineTools } from './machine/machine_tools.js';
import { MachineView } from './machine/machine_view.js';
import { momentOf } from './trace/rows.js';
import { moment, quantity } from './view/format.js';
import { onTheme, themeOf } from './view/theme.js';

/** @typedef {{url: (from: number) => string} | string} LiveSource a run's id, or the address of a growing trace from a byte on */

/**
 * Shows a run that goes on until it ends or `close()` is called.
 * @param {HTMLElement} element that it fills @param {LiveSource} source @param {{ended?: () => void, failed?: (fault: Error) => void}} [told]
 * @returns {{close: () => void, figures: () => {t_s: number, newest_s: number, rate: number, pictures: number, frames_ms: number[]}}}
 */
export function mountLive(element, source, { ended, failed } = {}) {
  const live = new LiveMachine(element);
  const urlFrom = typeof source === 'string' ? (/** @type {number} */ from) => `/api/runs/${encodeURIComponent(source)}/trace?from=${from}` : source.url;
  const stop = new AbortController();
  follow(urlFrom, live.trace, { news: () => live.news(), signal: stop.signal }).then(() => {
    live.end();
    ended?.();
  }, (fault) => {
    live.tell(`The run cannot be shown: ${fault.message}`);
    failed?.(fault);
  });
  return {
    close() {
      stop.abort();
      live.close();
    },
    figures: () => ({
      t_s: live.clock.t_s, newest_s: live.trace.newest_s, rate: live.clock.rate, pictures: live.view?.stage.pictures ?? 0,
      frames_ms: live.view?.stage.frames_ms ?? [],
    }),
  };
}

class LiveMachine {
  trace = new LiveTrace();
  clock = startClock();
  /** @type {MachineView | undefined} */
  view;
  #over = false;
  #closed = false;
  #last_ms = 0;

  /** @param {HTMLElement} element */
  constructor(element) {
    this.stage = h('div', { class: 'tv-stage', role: 'img', 'aria-label': 'The machine while it runs' });
    this.tools = h('div', { class: 'tv-panel-tools' });
    this.words = h('output', { class: 'tv-live-words number' }, 'Waiting for the machine …');
    this.root = h('div', { class: 'viewer tv-live' }, this.tools, this.stage, this.words);
    fill(element, this.root);
    this.stopTheme = onTheme(() => this.#dress());
  }

  #dress() {
    this.view?.stage.background(themeOf().room);
  }

  /** Something has come. */
  news() {
    if (this.#closed || !this.trace.machine) return;
    this.clock = arrived(this.clock, performance.now() / 1000, this.trace.newest_s);
    if (this.view) return;
    this.view = new MachineView(this.stage, this.trace.machine);
    this.#dress();
    fill(this.tools, machineTools(this.view).elements);
    this.#last_ms = performance.now();
    requestAnimationFrame((now_ms) => this.#frame(now_ms));
  }

  /** @param {number} now_ms */
  #frame(now_ms) {
    if (this.#closed || !this.view || !this.trace.machine) return;
    this.clock = ticked(this.clock, Math.max(0, now_ms - this.#last_ms) / 1000, this.#over);
    this.#last_ms = now_ms;
    const { t_s } = this.clock;
    const { motion, burnt, burnt_s, machine } = this.trace;
    this.view.show(t_s, momentOf(motion, t_s), burnt, [burntFrom(motion, burnt_s, machine.web.start_x_mm)]);
    if (this.#over && t_s >= this.trace.newest_s) return this.tell(`Ended at ${moment(t_s)} s`);
    this.tell(`${moment(t_s)} s · ${quantity(this.clock.rate, 2)}× real time`);
    requestAnimationFrame((later_ms) => this.#frame(later_ms));
  }

  end() {
    this.#over = true;
    if (!this.view) this.tell('The run has ended before the machine moved.');
  }

  /** @param {string} words */
  tell(words) {
    say(this.words, words);
  }

  close() {
    this.#closed = true;
    this.stopTheme();
    this.view?.close();
    this.root.remove();
  }
}
