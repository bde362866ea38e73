// SPDX-License-Identifier: Apache-2.0
// The machine as it runs, in the place of the drawing.
// @ts-check
import { h } from '../../shared/dom.js';
import { watch } from '../../shared/store.js';
import * as S from '../state.js';

/** @param {Element} stage @param {import('../page.js').Store} store */
export function mountMachine(stage, store) {
  const box = h('div', {
    class: 'live',
    id: 'live',
    hidden: true,
    role: 'region',
    'aria-label': 'The machine as it runs',
  });
  stage.append(box);
  /** @type {{ id: string, view: { close(): void } | null } | null} */
  let shown = null;
  watch(
    store,
    (s) => [s.stage.show, s.run?.id],
    async (s) => {
      const wanted = s.stage.show === 'machine' && s.run ? s.run.id : null;
      box.hidden = wanted === null;
      if (shown?.id === wanted || wanted === null) return;
      shown?.view?.close();
      const mine = { id: wanted, view: /** @type {any} */ (null) };
      shown = mine;
      try {
        // three.js is fetched only when somebody wants to see the machine.
        const { mountLive } = await import('../../live.js');
        const view = await mountLive(box, wanted);
        if (shown === mine) mine.view = view;
        else view?.close();
      } catch (error) {
        store.update(S.failed(`The machine cannot be shown: ${error instanceof Error ? error.message : error}`));
      }
    },
  );
}
