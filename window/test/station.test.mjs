// SPDX-License-Identifier: Apache-2.0
// What a station says of its runs.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  classOf,
  currentOf,
  firstScenario,
  leftWords,
  nextStep,
  outcomeOf,
  overOf,
  queueWords,
  rateWords,
  stationName,
  testedOf,
  timeWords,
} from '../src/station/words.js';

const run = (state, more = {}) => ({
  id: '1',
  scenario: 'a.yaml',
  state,
  serial_number: '',
  progress: { what: '' },
  live: { problems: [] },
  ...more,
});

test('the run that goes on comes before those that wait, and of these the first', () => {
  const runs = [run('waiting', { id: '4' }), run('waiting', { id: '3' }), run('running', { id: '2' }), run('ended')];
  assert.equal(currentOf(runs).id, '2');
  assert.equal(currentOf(runs.slice(0, 2)).id, '3');
  assert.equal(currentOf([run('ended')]), undefined);
  assert.deepEqual(overOf(runs).map(({ id }) => id), ['1']);
});

test('the operator is told what the run says, and then what the verdict asks for', () => {
  const live = { operator: 'Start the job at the machine.', problems: [] };
  assert.equal(nextStep(run('running', { live }), run('ended')), 'Start the job at the machine.');
  assert.match(nextStep(undefined, run('ended', { verdict: 'PASS', serial_number: 'K-7' })), /^PASS: number K-7 may go on/);
  assert.match(nextStep(undefined, run('ended', { verdict: 'FAIL' })), /^FAIL: set this one apart/);
  for (const verdict of ['INVALID', 'NOT PROVEN'])
    assert.match(nextStep(undefined, run('ended', { verdict })), new RegExp(`^${verdict}: test this one again`));
  assert.match(nextStep(undefined, run('stopped')), /^No verdict/);
  assert.match(nextStep(undefined, undefined), /serial number/);
});

test('a run without a verdict is never shown as one that has passed', () => {
  assert.equal(outcomeOf(run('ended', { exit_code: 0 })), 'no verdict');
  assert.equal(outcomeOf(run('stopped')), 'stopped');
  assert.equal(classOf('no verdict'), 'none');
  assert.equal(classOf('PASS'), 'pass');
});

test('figures are read at a glance', () => {
  assert.deepEqual([0, 999, 1000, 12_345, 1_500_000].map(rateWords), ['0 /s', '999 /s', '1.00 k/s', '12.3 k/s', '1.50 M/s']);
  assert.deepEqual([undefined, 4.4, 125, -3].map(leftWords), ['', '4 s left', '2 min 5 s left', '0 s left']);
});

test('the scenario of the last run comes first, as long as it is there', () => {
  const scenarios = [{ path: 'b.yaml' }, { path: 'a.yaml' }];
  assert.equal(firstScenario(scenarios, [run('ended')]), 'a.yaml');
  assert.equal(firstScenario(scenarios, [run('ended', { scenario: 'gone.yaml' })]), 'b.yaml');
  assert.equal(firstScenario([], []), '');
});

test('runs of scenarios are not taken for tested units', () => {
  const runs = [run('ended', { id: '3' }), run('ended', { id: '2', serial_number: 'K-7' }), run('ended', { id: '1' })];
  assert.deepEqual(
    testedOf(runs, new Set(['1'])).map(({ id }) => id),
    ['2', '1'],
  );
});

test('a run tells when it was, a run without results does not', () => {
  const at = new Date(Date.UTC(2026, 10, 29, 12, 5, 9));
  const results = 'results/label/20261129T120509Z-0123abcd';
  const clock = timeWords(run('ended', { results }), at);
  assert.match(clock, /^\d\d:05$/);
  assert.match(timeWords(run('ended', { results }), new Date(Date.UTC(2026, 11, 9))), /^2026-11-\d\d \d\d:05$/);
  assert.equal(timeWords(run('stopped'), at), '');
});

test('whoever starts while a run goes on is told of the queue', () => {
  assert.match(queueWords(run('running')), /queue/);
  assert.equal(queueWords(undefined), '');
});

test('a station is called by its folder', () => {
  assert.equal(stationName({ name: 'vm', folder: 'line-3' }), 'line-3');
  assert.equal(stationName({ name: 'vm', folder: '' }), 'vm');
});
