// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Panels beside or above each other, with bars between them that can be dragged or moved by the arrow keys.

import { h, fill, mark } from '../shared/dom.js';

/** @typedef {{element: HTMLElement, weight: number, hidden?: boolean, title: string}} Pane */

const kLeast = 0.08; // Share of the two neighbours that a pane keeps.
const kStep = 0.04;

/**
 * @param {'row' | 'column'} direction @param {Pane[]} panes @param {() => void} changed after sizes were changed by hand
 */
export function split(direction, panes, changed) {
  const element = h('div', { class: `tv-split tv-split-${direction}` });

  /** Moves the border of two panes. @param {Pane} before @param {Pane} after @param {number} share of both that the first gets */
  function give(before, after, share) {
    const both = before.weight + after.weight;
    before.weight = both * Math.min(Math.max(share, kLeast), 1 - kLeast);
    after.weight = both - before.weight;
    weigh();
    changed();
  }

  /** @param {Pane} before @param {Pane} after */
  function bar(before, after) {
    const share = () => before.weight / (before.weight + after.weight);
    const separator = h('div', {
      class: 'tv-bar', role: 'separator', tabindex: '0', 'aria-orientation': direction === 'row' ? 'vertical' : 'horizontal',
      'aria-label': `Border between ${before.title} and ${after.title}`, 'aria-valuemin': 8, 'aria-valuemax': 92,
    });
    const tell = () => mark(separator, 'aria-valuenow', Math.round(100 * share()));
    separator.addEventListener('pointerdown', (/** @type {PointerEvent} */ down) => {
      separator.setPointerCapture(down.pointerId);
      const [a, b] = [before.element.getBoundingClientRect(), after.element.getBoundingClientRect()];
      const [from, to] = direction === 'row' ? [a.left, b.right] : [a.top, b.bottom];
      const move = (/** @type {PointerEvent} */ event) => {
        give(before, after, ((direction === 'row' ? event.clientX : event.clientY) - from) / (to - from));
        tell();
      };
      separator.addEventListener('pointermove', move);
      separator.addEventListener('pointerup', () => separator.removeEventListener('pointermove', move), { once: true });
    });
    separator.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
      const by = { ArrowLeft: -kStep, ArrowUp: -kStep, ArrowRight: kStep, ArrowDown: kStep }[event.key];
      if (!by) return;
      event.preventDefault();
      event.stopPropagation();
      give(before, after, share() + by);
      tell();
    });
    tell();
    return separator;
  }

  function weigh() {
    for (const pane of panes) pane.element.style.flex = `${100 * pane.weight} 1 0`;
  }

  function lay() {
    const seen = panes.filter((pane) => !pane.hidden);
    fill(element, seen.flatMap((pane, i) => (i > 0 ? [bar(seen[i - 1], pane), pane.element] : [pane.element])));
    weigh();
  }
  lay();
  return { element, lay };
}
