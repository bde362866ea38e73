// SPDX-License-Identifier: Apache-2.0
// The machine as it runs, in the place of the drawing.
// @ts-check
import { fill, h } from '../../shared/dom.js';
import { watch } from '../../shared/store.js';
import * as S from '../state.js';

/** @param {Element} stage @param {import('../page.js').Store} store */
export function mountMachine(stage, store) {
  const holder = h('div', { class: 'machine' });
  const words = h('p', { class: 'hint' });
  const box = h(
    'section',
    { class: 'live', id: 'live', 'aria-label': 'The machine as it runs', hidden: true },
    holder,
    words,
  );
  stage.append(box);
  let id = '';
  let turn = 0;
  /** @type {{ close: () => void } | null} */
  let view = null;
  watch(
    store,
    (s) => [s.stage.show, s.run?.id, s.run?.state],
    async ({ stage: { show }, run }) => {
      box.hidden = show !== 'machine';
      // What was shown while it ran stays; a run that has ended is in its trace.
      const wanted = run && (S.isGoing(run) || run.id === id) ? run.id : '';
      words.hidden = wanted !== '';
      fill(
        words,
        !run
          ? 'Start a run to see the machine cut.'
          : S.isGoing(run)
            ? ''
            : run.trace
              ? 'The run has ended. '
              : 'There is no trace of this run.',
        run?.trace && !S.isGoing(run)
          ? h(
              'a',
              { href: `/view?trace=${encodeURIComponent(run.trace)}` },
              'Its trace shows the machine at any moment.',
            )
          : '',
      );
      if (box.hidden || id === wanted) return;
      id = wanted;
      view?.close();
      view = null;
      fill(holder);
      const mine = ++turn;
      const made = id === '' ? null : await showLive(holder, id, store);
      if (mine === turn) view = made;
      else made?.close();
    },
  );
}

/**
 * three.js is fetched only when somebody wants to see the machine.
 * @param {HTMLElement} holder @param {string} id @param {import('../page.js').Store} store
 */
async function showLive(holder, id, store) {
  try {
    const { mountLive } = await import('../../live.js');
    return await mountLive(holder, id);
  } catch (fault) {
    store.update(S.failed(`The machine cannot be shown: ${fault instanceof Error ? fault.message : fault}`));
    return null;
  }
}
