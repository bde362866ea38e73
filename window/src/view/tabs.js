// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Several panels in one place, of which one is seen.

import { h, mark } from '../shared/dom.js';

/**
 * @param {string} label @param {{name: string, title: string, body: HTMLElement, tools: HTMLElement}[]} pages
 * @returns {{element: HTMLElement, show: (name: string) => void}}
 */
export function tabs(label, pages) {
  const buttons = pages.map(({ name, title }) => h('button', {
    type: 'button', role: 'tab', id: `tab-${name}`, 'aria-controls': `page-${name}`, on: { click: () => show(name) },
  }, title));
  const tools = h('div', { class: 'tv-panel-tools' }, pages.map((page) => page.tools));
  const bodies = pages.map(({ name, body }) => {
    body.id = `page-${name}`;
    body.setAttribute('role', 'tabpanel');
    body.setAttribute('aria-labelledby', `tab-${name}`);
    return body;
  });
  const list = h('div', { role: 'tablist', class: 'tv-tabs', 'aria-label': label }, buttons);
  list.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const at = (buttons.indexOf(document.activeElement) + by + pages.length) % pages.length;
    show(pages[at].name);
    buttons[at].focus();
  });
  function show(/** @type {string} */ name) {
    pages.forEach((page, i) => {
      const on = page.name === name;
      mark(buttons[i], 'aria-selected', String(on));
      mark(buttons[i], 'tabindex', on ? '0' : '-1');
      page.body.hidden = !on;
      page.tools.hidden = !on;
    });
  }
  show(pages[0].name);
  return { element: h('section', { class: 'tv-panel tv-panel-tabs', 'aria-label': label }, h('header', { class: 'tv-panel-head' }, list, tools), bodies), show };
}
