// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import * as R from '../src/job/run.js';
import { runsOf, whenWords } from '../src/job/earlier.js';
import { resultPath } from '../src/job/actions.js';

const begun = () => R.runBegun({ id: 4, state: 'running', command: 'kerfbench run a.yaml' }, 'a.yaml');

test('progress says what goes on, how far, and how long yet', () => {
  const run = R.runProgressed(begun(), { now_s: 1.2, share: 0.417, what: 'Cutting unit 2', left_s: 83 });
  assert.equal(R.progressWords(run), 'Cutting unit 2 · 41 % · about 1 min 23 s left');
  assert.equal(R.progressWords(R.runProgressed(begun(), { what: 'Planning' })), 'Planning');
});

test('a run that tells a percentage itself is not told another', () => {
  const run = R.runProgressed(begun(), { share: 0.3, what: 'running, 23 % of the program sent', left_s: 0.2 });
  assert.equal(R.progressWords(run), 'Running, 23 % of the program sent');
});

test('what is spoken changes by quarters alone', () => {
  const at = (share) => R.spokenProgress(R.runProgressed(begun(), { share, what: 'Cutting' }));
  assert.equal(at(0.26), at(0.49));
  assert.notEqual(at(0.49), at(0.5));
});

test('a share that is 1 is not more than 100 %', () => {
  assert.match(R.progressWords(R.runProgressed(begun(), { share: 1, what: 'x' })), /100 %$/);
});

test('a stop is told while it is under way, and as the end', () => {
  assert.match(R.progressWords({ ...begun(), stopping: true }), /laser/);
  const ended = R.runTold(begun(), { state: 'stopped', exit_code: 130 });
  assert.match(R.endWords(ended), /stopped/);
  assert.equal(R.verdictKind(ended.verdict), 'none');
});

test('the last lines are kept, and not more than fit', () => {
  let run = begun();
  for (let i = 0; i < 700; ++i) run = R.runSaid(run, { line: `line ${i}` });
  assert.equal(run.log.length, 500);
  assert.equal(run.log[499], 'line 699');
});

test('checks that are not good, the failed ones first', () => {
  const judged = {
    checks: [
      { name: 'a', verdict: 'NOT PROVEN' },
      { name: 'b', verdict: 'PASS' },
      { name: 'c', verdict: 'FAIL' },
    ],
  };
  assert.deepEqual(
    R.badChecks(judged).map((c) => c.name),
    ['c', 'a'],
  );
  assert.deepEqual(R.badChecks(null), []);
});

test('figures with unit and limit', () => {
  assert.equal(
    R.figureWords({ value: 0.0795, unit: 'mm', limit: 0.15, limit_is: 'upper', value_is: 'measured' }),
    '0.0795 mm, limit 0.15 mm',
  );
  assert.equal(R.figureWords({ value: 4.5, unit: 'µs', limit: 0, limit_is: 'lower' }), '4.5 µs, limit at least 0 µs');
  assert.equal(R.figureWords({ value: null }), '');
  assert.equal(
    R.figureWords({ value: 0.7812, unit: 'ms', limit: 0.5, limit_is: 'upper', expanded_uncertainty: 0.7309 }),
    '0.781 ± 0.731 ms, limit 0.5 ms',
  );
});

test('a refused input is told as such', () => {
  assert.match(R.endWords(R.runTold(begun(), { state: 'ended', exit_code: 65 })), /refused/);
  assert.match(R.endWords(R.runTold(begun(), { state: 'ended', exit_code: 2 })), /exit code 2/);
});

test('addresses of results hold every name', () => {
  assert.equal(resultPath('label/2026-x', 'verdict.json'), '/results/label/2026-x/verdict.json');
  assert.equal(resultPath('results/label/2026-x', 'verdict.json'), '/results/label/2026-x/verdict.json');
  assert.equal(resultPath('my label/a#b', 'report.html'), '/results/my%20label/a%23b/report.html');
  assert.equal(resultPath('/results/my%20label', 'report.html'), '/results/my%20label/report.html');
});

test('durations', () => {
  assert.deepEqual([0, 7.6, 60, 3725].map(R.duration), ['0 s', '8 s', '1 min 0 s', '1 h 2 min']);
});

test('earlier runs are those of the scenario, as many as one looks at', () => {
  const runs = Array.from({ length: 20 }, (_, i) => ({
    path: `r${i}`,
    scenario: i % 2 ? 'a' : 'b',
    verdict: 'PASS',
    when: '',
  }));
  assert.deepEqual(
    runsOf({ runs }, 'a').map((run) => run.path),
    ['r1', 'r3', 'r5', 'r7', 'r9', 'r11', 'r13', 'r15'],
  );
  assert.deepEqual(runsOf({}, undefined), []);
  assert.match(whenWords('2026-11-28T16:05:12Z'), /^2026-11-2\d \d\d:\d\d$/);
  assert.equal(whenWords('?'), '?');
});

const bad = (name, verdict, along_with = '') => ({ name, verdict, along_with, title: `Title of ${name}` });

test('one fault is one entry: what it brings along is folded under it, also by way of another', () => {
  const judged = {
    checks: [
      bad('depth', 'NOT PROVEN'),
      bad('joints', 'FAIL', 'path'),
      bad('stray', 'INVALID', 'joints'),
      bad('path', 'FAIL'),
      bad('finish', 'PASS'),
      bad('belt', 'FAIL', 'finish'),
    ],
  };
  assert.deepEqual(
    R.groupedChecks(judged).map(({ check, along }) => [check.name, along.map((c) => c.name).join(' ')]),
    [
      ['path', 'joints stray'],
      ['belt', ''],
      ['depth', ''],
    ],
  );
  const circle = { checks: [bad('a', 'FAIL', 'b'), bad('b', 'FAIL', 'a')] };
  assert.equal(R.groupedChecks(circle).length, 2, 'nothing is lost');
  assert.deepEqual(R.groupedChecks(null), []);
});

test('sentences have the titles of checks, and words of the language stay', () => {
  const judged = { checks: [bad('stray', 'PASS'), bad('stillness_peak', 'FAIL')], not_judged: [bad('belt', '')] };
  assert.equal(
    R.withTitles('  PASS       stray          0.1 mm\nThe belt ran; stillness_peak failed, as other_name did.', judged),
    '  PASS       Title of stray          0.1 mm\nThe belt ran; Title of stillness_peak failed, as other_name did.',
  );
  assert.equal(R.withTitles('PASS stray', null), 'PASS stray');
});
