// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A panel of the viewer: a heading, tools, a body, and a way to hide it.

import { h } from '../shared/dom.js';

/**
 * @typedef {{body: HTMLElement, tools: HTMLElement, trace: import('../trace/trace.js').Trace,
 *   timeline: ReturnType<typeof import('../time/timeline.js').createTimeline>}} PanelPlace
 * @typedef {{close: () => void, [name: string]: any}} Panel
 * @typedef {(place: PanelPlace) => Panel} MakePanel
 */

/**
 * @param {string} name @param {string} title @param {() => void} hide
 * @returns {{element: HTMLElement, body: HTMLElement, tools: HTMLElement}}
 */
export function panelFrame(name, title, hide) {
  const body = h('div', { class: 'tv-panel-body' });
  const tools = h('div', { class: 'tv-panel-tools' });
  const id = `panel-${name}`;
  const element = h('section', { class: `tv-panel tv-panel-${name}`, 'aria-labelledby': id },
    h('header', { class: 'tv-panel-head' }, h('h2', { id }, title), tools,
      h('button', { type: 'button', class: 'quiet', 'aria-label': `Hide ${title}`, title: `Hide ${title}`, on: { click: hide } }, '×')),
    body);
  return { element, body, tools };
}
