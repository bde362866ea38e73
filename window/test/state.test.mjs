// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { commandOf, quoted } from '../src/job/command.js';
import { checkChosen, entitiesChosen, entityOfLine, lineChosen, linesOfEntities } from '../src/job/links.js';
import { periodOfLine } from '../src/job/motion.js';
import { idWords, moved, nudged } from '../src/job/order.js';
import { nameInScenario, pathOfName } from '../src/job/paths.js';
import * as R from '../src/job/run.js';
import { headOf, itemsOf } from '../src/job/stage/findings.js';
import { frameWords, framesOf, misplaced, tooLarge, wholeOf } from '../src/job/stage/frames.js';
import * as S from '../src/job/state.js';
import { jobHash, jobHref, jobOfHash, resultsOfTrace } from '../src/shared/job_address.js';
import { createStore, watch } from '../src/shared/store.js';

const open = (path = 'a.yaml', text = 'name: a\n') => S.opened(S.initialState(), path, text);
const good = (state) =>
  S.answered(S.answered(state, 'check', { issues: [], fits: true, drawing: null, values: {} }), 'plan', {
    issues: [],
    gcode: 'G00\n',
  });

test('what was edited is undone and done again', () => {
  let s = S.edited(S.edited(open(), 'b'), 'c');
  assert.ok(S.isChanged(s.job));
  s = S.undone(S.undone(s));
  assert.equal(s.job.text, 'name: a\n');
  assert.ok(!S.isChanged(s.job));
  assert.equal(S.undone(s), s);
  s = S.redone(S.redone(s));
  assert.equal(s.job.text, 'c');
  assert.equal(S.redone(s), s);
  // A new edit forgets what was undone.
  s = S.edited(S.undone(s), 'd');
  assert.equal(S.redone(s).job.text, 'd');
});

test('the same text is no edit', () => {
  const s = open();
  assert.equal(S.edited(s, s.job.text), s);
});

test('G-code by hand is a change until it is saved', () => {
  let s = S.gcodeEdited(good(open()), 'G01 X1\n');
  assert.ok(S.isChanged(s.job));
  assert.ok(S.isByHand(s));
  assert.equal(S.gcodeOf(s), 'G01 X1\n');
  s = S.saved(s, 'a.yaml', s.job.text);
  assert.ok(!S.isChanged(s.job));
  assert.equal(S.gcodeOf(s), 'G00\n');
});

test('a scenario that names its G-code is by hand', () => {
  const s = S.answered(open(), 'check', { issues: [], values: { 'planner.gcode': 'x.gcode' } });
  assert.ok(S.isByHand(s));
});

test('Start needs a job, a check without errors, and no other run', () => {
  assert.notEqual(S.whyNotStart(S.initialState()), '');
  assert.equal(S.whyNotStart(open()), '', 'it waits for the check');
  assert.ok(S.isUnsettled(open()) && !S.isUnsettled(good(open())));
  assert.ok(S.isUnsettled({ ...good(open()), editing: 1 }), 'a field that was just left');
  assert.equal(S.whyNotStart(good(open())), '');
  const bad = S.answered(good(open()), 'check', {
    issues: [
      { message: 'x', severity: 'error' },
      { message: 'y', severity: 'error' },
    ],
  });
  assert.match(S.whyNotStart(bad), /^2 faults/);
  const noted = S.answered(good(open()), 'check', { issues: [{ message: 'x', severity: 'warning' }] });
  assert.equal(S.whyNotStart(noted), '');
  const unfit = S.answered(good(open()), 'plan', {
    issues: [{ message: 'too fast', severity: 'error', line: 3 }],
    gcode: '',
  });
  assert.match(S.whyNotStart(unfit), /^One fault/);
  assert.notEqual(S.whyNotStart({ ...good(open()), run: { state: 'running' } }), '');
  assert.notEqual(S.whyNotStart({ ...good(open()), session: { can_run: false } }), '');
});

test('what is shipped is changed in a copy alone', () => {
  const s = good(open('shipped/scenarios/label.yaml'));
  assert.equal(S.whyNotStart(s), '', 'it runs as it is');
  assert.match(S.whyNotStart(S.edited(s, 'other')), /copy/);
});

test('faults of a scenario are not told twice by the plan that fails for them', () => {
  const s = S.refused(S.answered(open(), 'check', { issues: [{ message: 'bad key', severity: 'error' }] }), 'plan', {
    message: 'bad key',
    issues: [],
  });
  assert.equal(S.obstacles(s).length, 1);
});

test('an answer forgets entities that are gone, and keeps the others chosen', () => {
  let s = { ...open(), selected: [1, 2, 3] };
  s = S.answered(s, 'check', { issues: [], drawing: { entities: [{ id: 3 }, { id: 1 }] } });
  assert.deepEqual(s.selected, [1, 3]);
});

test('the order that was moved is shown until it is planned', () => {
  let s = S.having({ orderDraft: [2, 1] })(S.answered(open(), 'plan', { issues: [], order: [1, 2] }));
  assert.deepEqual(S.orderOf(s), [2, 1]);
  s = S.answered(s, 'plan', { issues: [], order: [2, 1] });
  assert.equal(s.orderDraft, null);
  assert.deepEqual(S.orderOf(s), [2, 1]);
});

const plan = {
  issues: [],
  gcode: '',
  order: [5, 9],
  entity_lines: [
    { entity: 5, line_first: 2, line_last: 3 },
    { entity: 9, line_first: 5, line_last: 5 },
  ],
  preview: {
    x_mm: new Array(11).fill(0),
    line: [
      [2, 3],
      [3, 4],
      [5, 4],
    ],
  },
};

test('entities, lines and periods lead to each other', () => {
  assert.equal(entityOfLine(plan.entity_lines, 3), 5);
  assert.equal(entityOfLine(plan.entity_lines, 4), null);
  assert.deepEqual(linesOfEntities(plan.entity_lines, [9, 5]), [2, 3, 5]);
  assert.equal(periodOfLine(plan.preview, 2), 0);
  assert.equal(periodOfLine(plan.preview, 3), 2);
  assert.equal(periodOfLine(plan.preview, 5), 6);
  assert.equal(periodOfLine(plan.preview, 4), null);
  const s = S.answered(open(), 'plan', plan);
  const byLine = lineChosen(s, 5);
  assert.deepEqual([byLine.selected, byLine.period, byLine.line], [[9], 6, 5]);
  const byEntity = entitiesChosen(s, [9]);
  assert.deepEqual([byEntity.selected, byEntity.period, byEntity.line], [[9], 6, 5]);
  const two = entitiesChosen(byEntity, [5], 'toggle');
  assert.deepEqual([two.selected, two.line], [[9, 5], 2]);
  assert.deepEqual(entitiesChosen(two, [5], 'toggle').selected, [9]);
  assert.deepEqual(entitiesChosen(two, []).selected, []);
});

test('lines of G-code that was edited since are not taken for those of the plan', () => {
  const s = S.asked(S.answered(open(), 'plan', plan), 'plan');
  assert.deepEqual(lineChosen(s, 5).selected, []);
});

test('moving keeps every entity once', () => {
  const order = [4, 7, 1, 9, 3];
  for (let to = 0; to <= order.length; ++to) {
    const next = moved(order, [9, 7], to);
    assert.deepEqual([...next].sort(), [...order].sort());
    assert.equal(next.indexOf(9) - next.indexOf(7), 1, 'they stay together, in their own order');
  }
  assert.deepEqual(moved(order, [3], 0), [3, 4, 7, 1, 9]);
  assert.deepEqual(moved(order, [4], 5), [7, 1, 9, 3, 4]);
});

test('a nudge is one place, and ends at the ends', () => {
  assert.deepEqual(nudged([1, 2, 3, 4], [3], -1), [1, 3, 2, 4]);
  assert.deepEqual(nudged([1, 2, 3, 4], [2, 3], 1), [1, 4, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [1], -1), [1, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [3], 1), [1, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [8], 1), [1, 2, 3]);
});

test('ids are written as lint writes them', () => {
  assert.equal(idWords([3, 5, 6, 7, 9, 10]), '3,5-7,9,10');
  assert.equal(idWords([]), '');
});

test('names of files are relative to the scenario, and found again', () => {
  const places = { folder: '/home/me/jobs', shipped: '/opt/kerfbench/fixtures' };
  const cases = [
    ['a.yaml', 'b.dxf', 'b.dxf'],
    ['x/a.yaml', 'b.dxf', '../b.dxf'],
    ['a.yaml', 'x/b.dxf', 'x/b.dxf'],
    ['a.yaml', 'shipped/machines/m.yaml', '../../../opt/kerfbench/fixtures/machines/m.yaml'],
    ['shipped/scenarios/n/a.yaml', 'shipped/machines/m.yaml', '../../machines/m.yaml'],
  ];
  for (const [scenario, file, name] of cases) {
    assert.equal(nameInScenario(places, scenario, file), name);
    assert.equal(pathOfName(places, scenario, name, ['other', file]), file);
  }
  assert.equal(pathOfName(places, 'a.yaml', 'gone.dxf', ['b.dxf']), 'gone.dxf');
});

test('the command is one that a shell takes as it is', () => {
  assert.equal(quoted('a b.yaml'), "'a b.yaml'");
  assert.equal(quoted("it's"), "'it'\\''s'");
  assert.equal(quoted('shipped/a-1.yaml'), 'shipped/a-1.yaml');
  assert.equal(commandOf(open('my job.yaml')), "kerfbench run 'my job.yaml'");
  assert.equal(
    commandOf({ ...open(), run: { state: 'running', scenario: 'b.yaml', command: 'kerfbench run b.yaml --seed 3' } }),
    'kerfbench run b.yaml --seed 3',
  );
});

test('a store tells changes in their order, and watchers only what they look at', () => {
  const store = createStore({ a: 0, b: 0 });
  const seen = [];
  watch(
    store,
    (s) => [s.a],
    (s) => seen.push(s.a),
  );
  store.subscribe((s) => {
    if (s.a === 1) store.update((t) => ({ ...t, a: 2 }));
  });
  store.update((s) => ({ ...s, b: 5 }));
  store.update((s) => ({ ...s, a: 1 }));
  assert.deepEqual(seen, [0, 1, 2]);
  assert.deepEqual(store.get(), { a: 2, b: 5 });
});

test('a firmware with a job of its own needs no plan', () => {
  let s = S.answered(open(), 'check', { issues: [], fits: true, values: { 'firmware.dialog': 'line-ok' } });
  s = S.refused(s, 'plan', { message: 'no planner serves line-ok', issues: [] });
  assert.equal(S.whyNotStart(s), '');
  assert.match(headOf(s, itemsOf(s)), /no preview/);
});

test('findings of drawing and plan are one list, accepted ones left out', () => {
  const finding = { kind: 'gap', severity: 'error', message: 'a gap', where_mm: [1, 2], entities: [3], line: 9 };
  let s = S.answered(open(), 'check', {
    issues: [],
    fits: true,
    values: {},
    drawing: {
      file: 'mine/a.svg',
      entities: [],
      findings: [finding, { ...finding, accepted: true }, { ...finding, severity: 'warning', entities: [] }],
    },
  });
  s = S.answered(s, 'plan', {
    issues: [{ line: 4, message: 'beyond the field', severity: 'error', source: 'gcode' }],
    gcode: '',
  });
  const items = itemsOf(s);
  assert.deepEqual(
    items.map((i) => [i.number, i.place]),
    [
      [1, 'a.svg, line 9'],
      [2, 'a.svg, line 9'],
      [3, 'G-code, line 4'],
    ],
  );
  assert.equal(headOf(s, items), '2 faults, 1 note');
  assert.notEqual(S.whyNotStart(s), '', 'a fault of the drawing keeps the job from running');
});

test('every error is told somewhere: beside its field, or where the scenario is chosen', () => {
  const reference = [{ title: 'Belt', keys: [{ path: 'belt.speed_mm_s' }] }];
  const issue = (key, file = '') => ({ key, file, severity: 'error', message: key });
  const issues = [
    issue('belt.speed_mm_s'),
    issue('planer'),
    issue('machine'),
    issue(''),
    issue('layers.X'),
    issue('kind', 'm.yaml'),
  ];
  const told = (drawing) =>
    S.unplaced(S.answered({ ...open(), reference }, 'check', { issues, drawing })).map((i) => i.message);
  assert.deepEqual(told({ entities: [] }), ['planer', '', 'kind']);
  assert.deepEqual(told(null), ['planer', '']);
});

test('a line that is looked at is looked at in the next plan, too', () => {
  const s = lineChosen(S.answered(open(), 'plan', plan), 5);
  const later = {
    ...plan,
    preview: {
      ...plan.preview,
      line: [
        [2, 5],
        [3, 5],
        [5, 4],
      ],
    },
  };
  assert.equal(S.answered(s, 'plan', later).period, 9);
});

test('a line is told once, and always of which file', () => {
  const at = (message) => S.withoutLine({ line: 16, message });
  assert.equal(at('G-code line 16: Q is no word'), 'Q is no word');
  assert.equal(at('E3, G-code line 16 spans y 1 … 2 mm'), 'E3 spans y 1 … 2 mm');
  assert.equal(at('from G-code line 16: x_W'), 'from G-code line 16: x_W');
  assert.equal(S.withoutLine({ message: 'G-code line 16: x' }), 'G-code line 16: x');
  const entity = { id: 4, layer: 'CUT', process: 'cut', length_mm: 1, line: 7, points_mm: [], closed: false };
  const drawing = { file: 'mine/a.svg', entities: [entity], findings: [], unsaid_unit: null };
  const warning = { file: 'mine/a.svg', line: 7, severity: 'warning', message: 'text: 1 ignored' };
  let s = S.answered(open(), 'check', { issues: [warning], fits: true, values: {}, drawing });
  s = S.answered(s, 'plan', {
    gcode: '',
    issues: [
      { line: 16, message: 'G-code line 16: its cut leaves the drawing', severity: 'warning', source: 'gcode', where_mm: [1, 2] },
      { line: 0, message: 'from E4: x_W 1 … 2 mm, the field -1 … 1 mm', severity: 'error', source: 'job' },
      { line: 0, message: 'E99: no such', severity: 'error', source: 'job' },
    ],
  });
  const items = itemsOf(s);
  assert.deepEqual(
    items.map((i) => [i.place, i.message.slice(0, 12), i.where, i.entities]),
    [
      ['a.svg, line 7', 'text: 1 igno', null, [4]],
      ['G-code, line 16', 'its cut leav', [1, 2], []],
      ['job', 'from E4: x_W', null, [4]],
      ['job', 'E99: no such', null, []],
    ],
  );
});

test('a verdict is of an earlier job from the first change on, and no more when that is taken back', () => {
  const ended = (of, s) => ({ ...s, run: R.runTold(R.runBegun({ id: 1 }, 'a.yaml', of), { state: 'ended', verdict: 'PASS' }) });
  let s = good(open());
  s = ended(S.runInputOf(s), s);
  assert.ok(!S.isOfEarlierJob(s));
  assert.ok(!S.isOfEarlierJob({ ...S.edited(s, 'b'), run: { ...s.run, state: 'running' } }), 'it is not there yet');
  s = S.edited(s, 'b');
  assert.ok(S.isOfEarlierJob(s));
  s = S.undone(s);
  assert.ok(!S.isOfEarlierJob(s));
  assert.ok(S.isOfEarlierJob(S.gcodeEdited(s, 'G01 X1\n')));
  assert.ok(S.isOfEarlierJob(S.drawingExchanged(s, true)), 'the file of the drawing is another one');
  assert.ok(!S.isOfEarlierJob(S.drawingExchanged(s, false)), 'these very bytes');
  assert.ok(S.isOfEarlierJob(S.saved(s, 'b.yaml', s.job.text)), 'under another name it is another job');
  // By hand: what the run had, against what is in the editor.
  let hand = S.saved(S.gcodeEdited(good(open()), 'G00\n'), 'a.yaml', 'name: a\n');
  hand = ended({ text: hand.job.text, gcode: 'G00\n', outdated: false }, hand);
  assert.ok(!S.isOfEarlierJob(hand));
  assert.ok(S.isOfEarlierJob(S.gcodeEdited(hand, 'G01 X2\n')));
  assert.ok(!S.isOfEarlierJob({ ...s, run: { ...s.run, of: null } }), 'nobody knows');
});

test('a check leads to its entity, its lines and its place', () => {
  assert.equal(R.placeOf({ where: { entity: -1, x_mm: null } }), null);
  assert.equal(R.placeOf({}), null);
  const where = R.placeOf({ where: { unit: 0, entity: 2, x_mm: 3, y_mm: 4 } });
  assert.deepEqual(where, { entity: 2, at: [3, 4] });
  let s = good(open());
  s = { ...s, plan: { ...s.plan, value: { ...s.plan.value, entity_lines: [{ entity: 2, line_first: 5, line_last: 6 }] } } };
  s = checkChosen(S.looking({ show: 'machine' })(s), where);
  assert.deepEqual([s.selected, s.line, s.stage.place, s.stage.show], [[2], 5, [3, 4], 'drawing']);
  assert.equal(entitiesChosen(s, [1]).stage.place, null, 'another choice forgets the place');
});

test('the address of a job leads back to it and its verdict', () => {
  const hash = jobHash({ scenario: 'my jobs/a&b.yaml', results: 'results/a/2026-1' });
  assert.deepEqual(jobOfHash(hash), { scenario: 'my jobs/a&b.yaml', results: 'results/a/2026-1' });
  assert.equal(jobHash({ results: 'results/a' }), '');
  assert.equal(resultsOfTrace('results/a/2026-1/run.mcap'), 'results/a/2026-1');
  assert.equal(resultsOfTrace('elsewhere/run.mcap'), '');
  const kept = { getItem: () => '#scenario=kept.yaml' };
  assert.equal(jobHref('', kept), '/#scenario=kept.yaml');
  assert.equal(jobHref('', null), '/');
  assert.equal(
    jobHref('?trace=results%2Fa%2F1%2Frun.mcap&job=a.yaml', kept),
    `/${jobHash({ scenario: 'a.yaml', results: 'results/a/1' })}`,
  );
});

test('frames: where the field lies on the sheet, and what a click can mend', () => {
  const rect = (w, h) => [
    { id: 0, process: 'cut', closed: true, points_mm: [[0, 0], [w, 0], [w, h], [0, h], [0, 0]] },
  ];
  const check = (w, h, start_mm, marks = [[5, -7]]) => ({
    drawing: { entities: rect(w, h) },
    machine: { name: 'm', field: { min_mm: [-50, -40], max_mm: [50, 40] } },
    sheet: { moves: false, start_x_mm: start_mm, marks: marks.map(([x, y]) => ({ x_mm: x, y_mm: y, diameter_mm: 3 })) },
  });
  const frames = framesOf(check(60, 30, -30), null, 0);
  assert.deepEqual(frames.field, { x0: -20, x1: 80, y0: -40, y1: 40 });
  assert.deepEqual(frames.rest, [30, 0]);
  assert.equal(frames.sheet.y0, -12.5, 'it holds the marks');
  assert.match(frameWords(frames, 'm'), /x_W is x − 30 mm/);
  assert.equal(misplaced(check(60, 30, -30), { fits: true }), '');
  assert.match(misplaced(check(60, 30, 30), null), /outside of the field/);
  assert.match(misplaced(check(10, 8, -5, [[80, 0]]), null), /another size/);
  assert.match(misplaced(check(60, 30, -30, [[60, 10]]), null), /on a line/);
  assert.equal(misplaced({ ...check(60, 30, 30), sheet: { ...check(60, 30, 30).sheet, moves: true } }, null), '', 'a belt brings it');
  assert.equal(misplaced(check(300, 30, 0), null), '', 'no place is right for it');
  assert.match(tooLarge(check(300, 30, 0)), /300\.0 × 30\.0 mm.*m 100\.0 × 80\.0 mm.*larger field/);
  assert.equal(tooLarge(check(60, 30, 0)), '');
  assert.equal(misplaced(null, null) + tooLarge(undefined), '');
  assert.deepEqual(wholeOf(frames), frames.sheet, "the sheet is shown, however large the field is");
  assert.deepEqual(wholeOf({ ...frames, sheet: null }), frames.field);
});
