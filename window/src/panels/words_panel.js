// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What controller and bench said to each other around the cursor.

import { h, mark, say } from '../shared/dom.js';
import { timeOfFrame } from '../time/steps.js';
import { countUpTo } from '../trace/search.js';
import { moment } from '../view/format.js';
import { rowsList } from './rows_list.js';

/** @typedef {{timestamp: {sec: number, nsec: number}, level: number, name: string, message: string, hex?: string}} Word */

const kChunks = 2; // So many are looked at before the cursor, of about a second each.

/** @type {import('../view/panel.js').MakePanel} */
export function wordsPanel({ body, tools, trace, timeline }) {
  const where = h('span', { class: 'mute', role: 'status' });
  tools.append(where);
  /** @type {Word | undefined} */
  let current;
  const list = rowsList(body, 'Words of controller and bench', {
    make: () => h('button', { type: 'button', class: 'tv-row tv-word' }, h('span', { class: 'number mute' }), h('span', { class: 'tv-who' }), h('span', { class: 'tv-said' }), h('code', { class: 'mute' })),
    update: (element, /** @type {Word} */ word) => {
      const [time, who, said, bytes] = /** @type {HTMLElement[]} */ ([...element.children]);
      say(time, moment(timeOfFrame(word)));
      say(who, word.name);
      say(said, word.message);
      say(bytes, (word.hex ?? '').replace(/(..)(?=.)/g, '$1 '));
      element.title = word.hex ?? '';
      element.onclick = () => timeline.go(timeOfFrame(word));
      mark(element, 'data-level', word.level >= 4 ? 'error' : word.level === 3 ? 'warning' : word.name);
      mark(element, 'aria-current', word === current ? 'true' : null);
    },
  });
  const empty = h('p', { class: 'tv-empty', hidden: true }, 'Nobody spoke in this run.');
  empty.hidden = trace.file.has('/uart');
  body.append(empty);
  const update = () => {
    if (body.hidden) return; // Nobody reads them: they are not read from the file either.
    const { t_s } = timeline.get();
    const words = wordsAround(trace, t_s);
    const index = countUpTo(words.map(timeOfFrame), t_s + 1e-9) - 1;
    current = words[index];
    list.give(words);
    if (index >= 0) list.reveal(index);
    say(where, words.length ? `${index + 1} of the ${words.length} around the cursor` : '');
  };
  update();
  const shown = new MutationObserver(update);
  shown.observe(body, { attributes: true, attributeFilter: ['hidden'] });
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update)];
  return { current: () => current, close: () => { for (const end of stop) end(); shown.disconnect(); list.close(); } };
}

/** @param {import('../trace/trace.js').Trace} trace @param {number} t_s @returns {Word[]} */
function wordsAround(trace, t_s) {
  const chunks = trace.file.chunksOf('/uart');
  if (!chunks.length) return [];
  const at = countUpTo(chunks.map((index) => trace.file.chunks[index].start_s), t_s);
  const from = chunks[Math.max(0, at - kChunks)];
  const to = chunks[Math.max(0, at - 1)];
  return trace.messages('/uart', trace.file.chunks[from].start_s, trace.file.chunks[to].end_s);
}
