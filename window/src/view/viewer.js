// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The trace viewer: all panels of one trace around one time.

import { h, fill, say } from '../shared/dom.js';
import { checksPanel, aroundMoment, toneOf } from '../panels/checks_panel.js';
import { dielinePanel } from '../panels/dieline_panel.js';
import { framesPanel } from '../panels/frames_panel.js';
import { gcodePanel } from '../panels/gcode_panel.js';
import { machinePanel } from '../panels/machine_panel.js';
import { plotsPanel } from '../panels/plots_panel.js';
import { wordsPanel } from '../panels/words_panel.js';
import { createTimeline } from '../time/timeline.js';
import { Trace } from '../trace/trace.js';
import { Waveform } from '../waveform/waveform.js';
import { kHelp, listenToKeys } from './keyboard.js';
import { layoutStore } from './layout_store.js';
import { panelFrame } from './panel.js';
import { split } from './split.js';
import { strip } from './strip.js';
import { tabs } from './tabs.js';
import { transport } from './transport.js';

/** @typedef {import('./panel.js').Panel} Panel */

/** @type {Record<string, string>} */
const kTitles = {
  machine: 'Machine', pins: 'Pins', plots: 'Plots', dieline: 'Dieline', frames: 'Camera', text: 'Checks, program, words',
};

/** Shows a trace. */
export class Viewer {
  /** @type {Panel[]} */
  panels = [];

  /** @param {HTMLElement} element that it fills @param {Trace} trace @param {{t_s?: number, name?: string}} [options] */
  constructor(element, trace, { t_s, name = '' } = {}) {
    this.trace = trace;
    this.timeline = createTimeline(trace.extent_s, t_s ?? startOf(trace));
    if (t_s !== undefined) this.timeline.update((state) => aroundMoment(state, t_s));
    this.layout = layoutStore(Object.keys(kTitles));
    this.bar = transport(trace, this.timeline);
    this.strip = strip(trace, this.timeline);
    this.help = helpDialog();
    this.root = h('div', { class: 'viewer' }, this.#head(name), this.strip.element, this.#body(), this.help);
    /** @type {any} For tests, and for who looks from the browser's console. */ (this.root).viewer = this;
    fill(element, this.root);
    this.#fillPanels();
    this.stopKeys = listenToKeys({
      timeline: this.timeline, step: this.bar.step, least_s: this.waveform.least_s, nextView: () => this.machine.nextView(),
      follow: () => this.machine.toggleFollow(), help: () => this.help.showModal(),
    });
  }

  /** @param {string} name */
  #head(name) {
    const { machine, checks, file } = this.trace;
    const worst = /** @type {const} */ (['FAIL', 'INVALID', 'NOT PROVEN', 'PASS']).find((outcome) => checks.some((check) => check.outcome === outcome));
    const fault = h('span', { class: 'fault', role: 'status' });
    this.trace.onLoad(() => {
      const [first] = this.trace.details.failures.values();
      if (first) say(fault, `${this.trace.details.failures.size} parts of the trace cannot be read: ${first.message}`);
    });
    return h('header', { class: 'viewer-head' },
      h('div', { class: 'viewer-title' }, h('h1', { title: name || null }, machine.scenario),
        h('span', { class: 'mute' }, machine.machine), worst ? h('span', { class: `outcome ${toneOf(worst)}` }, worst) : null,
        file.complete ? null : h('span', { class: 'outcome np', title: 'The file has no end: its run was killed, or goes on' }, 'cut off'), fault),
      this.bar.element, h('div', { class: 'viewer-menu' }, this.#panelsMenu(),
        h('button', { type: 'button', title: 'Keys (?)', 'aria-label': 'Keys', on: { click: () => this.help.showModal() } }, '?')));
  }

  #panelsMenu() {
    this.boxes = Object.fromEntries(Object.keys(kTitles).map((name) => [name, h('input', { type: 'checkbox', checked: this.layout.shown(name), on: {
      change: (/** @type {any} */ event) => this.#show(name, event.target.checked),
    } })]));
    return h('details', { class: 'tv-menu' }, h('summary', {}, 'Panels'),
      h('div', { class: 'tv-menu-body' }, Object.entries(kTitles).map(([name, title]) => h('label', {}, this.boxes[name], title))));
  }

  #body() {
    this.frames = Object.fromEntries(Object.entries(kTitles).filter(([name]) => name !== 'text')
      .map(([name, title]) => [name, panelFrame(name, title, () => this.#show(name, false))]));
    this.pages = ['checks', 'gcode', 'words'].map((name) => ({
      name, title: { checks: 'Checks', gcode: 'Program', words: 'Words' }[name] ?? name, body: h('div', { class: 'tv-panel-body' }), tools: h('div'),
    }));
    this.tabs = tabs('Checks, program and words', this.pages);
    const element = (/** @type {string} */ name) => (name === 'text' ? this.tabs.element : this.frames[name].element);
    /** @type {Record<string, import('./split.js').Pane>} */
    this.panes = Object.fromEntries(Object.keys(kTitles).map((name) => [name,
      { element: element(name), title: kTitles[name], weight: this.layout.weight(name), hidden: !this.layout.shown(name) }]));
    const changed = () => this.layout.keep(this.panes, [this.left, this.right]);
    const { machine, pins, plots, dieline, frames, text } = this.panes;
    this.columns = [split('column', [machine, pins, plots], changed), split('column', [dieline, frames, text], changed)];
    this.left = { element: this.columns[0].element, title: 'machine and time', weight: this.layout.weight('left') };
    this.right = { element: this.columns[1].element, title: 'places and words', weight: this.layout.weight('right') };
    this.rows = split('row', [this.left, this.right], changed);
    this.#hideEmpty();
    return h('main', { class: 'viewer-body' }, this.rows.element);
  }

  #hideEmpty() {
    const { machine, pins, plots, dieline, frames, text } = this.panes;
    this.left.hidden = [machine, pins, plots].every((pane) => pane.hidden);
    this.right.hidden = [dieline, frames, text].every((pane) => pane.hidden);
    this.rows.lay();
  }

  /** @param {string} name @param {boolean} on */
  #show(name, on) {
    this.panes[name].hidden = !on;
    this.boxes[name].checked = on;
    for (const column of this.columns) column.lay();
    this.#hideEmpty();
    this.layout.keep(this.panes, [this.left, this.right]);
    // Who has hidden a panel by its button is not left nowhere.
    if (!on && document.activeElement === document.body) this.root.querySelector('summary')?.focus();
  }

  #fillPanels() {
    const { trace, timeline } = this;
    const place = (/** @type {{body: HTMLElement, tools: HTMLElement}} */ { body, tools }) => ({ body, tools, trace, timeline });
    this.machine = machinePanel(place(this.frames.machine));
    this.waveform = new Waveform(place(this.frames.pins));
    this.camera = framesPanel(place(this.frames.frames));
    const [checks, gcode, words] = this.pages;
    this.program = gcodePanel(place(gcode));
    this.words = wordsPanel(place(words));
    this.panels = [this.machine, this.waveform, plotsPanel(place(this.frames.plots)), dielinePanel(place(this.frames.dieline)), this.camera,
      checksPanel(place(checks)), this.program, this.words];
    if (!trace.checks.length) this.tabs.show('gcode');
  }

  close() {
    this.stopKeys();
    this.timeline.play(false);
    for (const panel of [...this.panels, this.bar, this.strip]) panel.close();
    this.root.remove();
  }
}

/** The moment that a trace is opened at: the worst check's, else the first light. @param {Trace} trace */
function startOf(trace) {
  const failed = trace.checks.find((check) => check.outcome === 'FAIL' && check.time_s !== null) ?? trace.checks.find((check) => check.outcome !== 'PASS' && check.time_s !== null);
  if (failed?.time_s) return failed.time_s;
  for (const part of trace.overview.parts(trace.extent_s.from, trace.extent_s.to, 10)) {
    const row = part.lit_s.findIndex((lit_s) => lit_s > 0);
    if (row >= 0) return Math.max(0, part.from_s + (row + 0.5) * part.step_s);
  }
  return trace.extent_s.from;
}

function helpDialog() {
  const dialog = h('dialog', { class: 'tv-help', 'aria-labelledby': 'keys-title' }, h('h2', { id: 'keys-title' }, 'Keys'),
    h('dl', {}, kHelp.map(([key, words]) => [h('dt', {}, h('kbd', {}, key)), h('dd', {}, words)])),
    h('p', { class: 'mute' }, 'Waveform: click sets the cursor, dragging moves, the wheel zooms, dragging with Shift sets both marks. Machine: drag to turn, wheel to come nearer, right button to move.'),
    h('button', { type: 'button', class: 'primary', on: { click: () => dialog.close() } }, 'Close'));
  return dialog;
}
