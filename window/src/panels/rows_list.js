// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A list of very many rows of one height, of which only those in sight are elements.

import { h, keyed } from '../shared/dom.js';

const kRow_px = 22;
const kAround = 8;

/**
 * @template T
 * @param {HTMLElement} parent @param {string} label
 * @param {{make: (item: T) => HTMLElement, update: (element: HTMLElement, item: T, index: number) => void}} row
 */
export function rowsList(parent, label, { make, update }) {
  const inner = h('div', { class: 'tv-rows-inner', role: 'list', 'aria-label': label });
  const outer = h('div', { class: 'tv-rows', tabindex: '0', role: 'group', 'aria-label': label }, inner);
  parent.append(outer);
  /** @type {T[]} */
  let items = [];
  const draw = () => {
    const first = Math.max(0, Math.floor(outer.scrollTop / kRow_px) - kAround);
    const end = Math.min(items.length, Math.ceil((outer.scrollTop + outer.clientHeight) / kRow_px) + kAround);
    const indexes = Array.from({ length: Math.max(0, end - first) }, (_, i) => first + i);
    keyed(inner, indexes, (index) => index, (index) => {
      const element = make(items[index]);
      element.setAttribute('role', 'listitem');
      element.style.top = `${index * kRow_px}px`;
      return element;
    }, (element, index) => update(element, items[index], index));
  };
  /** A row that was to be seen while the list was hidden. @type {number | undefined} */
  let owed;
  const reveal = (/** @type {number} */ index) => {
    owed = outer.clientHeight ? undefined : index;
    const top = index * kRow_px;
    if (top < outer.scrollTop || top + kRow_px > outer.scrollTop + outer.clientHeight) outer.scrollTop = top - 0.4 * outer.clientHeight;
  };
  outer.addEventListener('scroll', draw);
  const resizing = new ResizeObserver(() => {
    if (owed !== undefined) reveal(owed);
    draw();
  });
  resizing.observe(outer);
  return {
    /** @param {T[]} all */
    give(all) {
      items = all;
      inner.style.height = `${all.length * kRow_px}px`;
      draw();
    },
    draw,
    /** Scrolls a row into sight, to the middle if it was not. */
    reveal,
    close: () => resizing.disconnect(),
  };
}
