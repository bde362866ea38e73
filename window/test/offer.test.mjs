// SPDX-License-Identifier: Apache-2.0
// Which traces the page offers.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { choicesOf } from '../src/view/offer.js';

test('traces come newest first with what is known of their runs, and none is left out', () => {
  const files = {
    traces: [
      { path: 'kept/run.mcap' },
      { path: 'results/label/20261128T090000Z-aa/run.mcap' },
      { path: 'results/label/20261129T120509Z-bb/run.mcap' },
    ],
    runs: [{ path: 'results/label/20261128T090000Z-aa', scenario: 'label', verdict: 'FAIL', when: '2026-11-28T09:00:00Z' }],
  };
  assert.deepEqual(
    choicesOf(files).map(({ title, verdict, when }) => [title, verdict, when]),
    [
      ['results/label/20261129T120509Z-bb/run.mcap', '', '2026-11-29T12:05:09Z'],
      ['label', 'FAIL', '2026-11-28T09:00:00Z'],
      ['kept/run.mcap', '', ''],
    ],
  );
  assert.deepEqual(choicesOf({}), []);
});
