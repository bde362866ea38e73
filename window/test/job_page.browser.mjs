// SPDX-License-Identifier: Apache-2.0
// The job page in Chromium, against `kerfbench serve`: from the drop of a drawing to a verdict. Each step stands on the one before
// it, as a user's does.
//   KERFBENCH=build/release/bin/kerfbench KERFBENCH_SHOTS=FOLDER node --test window/test/job_page.browser.mjs
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch } from './browser.mjs';
import { serve } from './server.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.KERFBENCH ?? join(root, 'build/release/bin/kerfbench');
const shots = process.env.KERFBENCH_SHOTS ?? join(root, 'build/window-shots');
const kAlt = 1;
const kShift = 8;

let server;
let browser;
let page;
const inFolder = (...path) => join(server.folder, ...path);
const text = (...path) => readFileSync(inFolder(...path), 'utf8');
const shot = (name) => page.screenshot(join(shots, `${name}.png`));
const value = (selector) => page.run('(s) => document.querySelector(s)?.value', selector);
const planned = async () => {
  await page.until("() => document.querySelector('.job-page').getAttribute('aria-busy') === 'false'");
  await page.untilText('.findings h2', 'Nothing is wrong. ');
};
/** Place in the window of a place on the sheet, mm. */
const onSheet = (x, y) =>
  page.run(
    `(x, y) => { const c = document.querySelector('#canvas'), v = JSON.parse(c.dataset.view), r = c.getBoundingClientRect();
  return { x: r.x + v.dx + v.scale * x, y: r.y + v.dy - v.scale * y }; }`,
    x,
    y,
  );
/** The order in the list, as ids. */
const order = () => page.run("() => [...document.querySelectorAll('#order li')].map((row) => Number(row.dataset.id))");
const verdict = async () => {
  await page.until("() => document.querySelector('.run .verdict')?.checkVisibility()");
  return page.text('.run .verdict');
};

before(async () => {
  mkdirSync(shots, { recursive: true });
  server = await serve(program);
  browser = await launch();
  page = await browser.newPage();
});
after(async () => {
  await browser?.close();
  await server?.close();
});
/** A step; a failed one keeps a picture of what the page showed. */
const step = (name, act) =>
  test(name, async () => {
    try {
      await act();
    } catch (fault) {
      await shot('failed').catch(() => {});
      throw fault;
    }
  });

step('an empty page says what to do first', async () => {
  await page.open(server.url);
  await page.untilText('.empty h1', 'Drop a drawing here');
  assert.doesNotMatch(await page.run('() => location.href'), /token/, 'the address in the bar has no token any more');
  assert.match(await page.text('#command'), /^kerfbench serve /);
  assert.equal(await page.run("() => document.querySelector('#start').checkVisibility()"), false);
  await shot('01-empty');
});

step('a dropped DXF becomes a scenario that can be run', async () => {
  await page.drop('.stage', [join(root, 'fixtures/dielines/label-60x40.dxf')]);
  await planned();
  assert.ok(existsSync(inFolder('label-60x40.dxf')));
  assert.match(await page.text('#command'), /^kerfbench run label-60x40\.yaml/);
  assert.equal(
    await page.run("() => document.querySelectorAll('#gcode .cm-lineNumbers .cm-gutterElement').length > 10"),
    true,
  );
  await shot('02-dropped');
});

step('a parameter is found, added and set, with its range', async () => {
  await page.run("() => document.querySelector('#add-parameter').focus()");
  await page.type('twin');
  await page.untilText('#found', /^twin\b/m);
  await page.key('Enter');
  await page.until("() => document.activeElement?.id === 'key-twin'");
  await page.choose('#key-twin', 'fast');
  await page.fillIn('#key-planner-mark_speed_mm_s', '9000');
  await page.untilText('.row .fault', 'At most 5000 mm/s.');
  assert.equal(
    await page.run("() => document.querySelector('#key-planner-mark_speed_mm_s').getAttribute('aria-invalid')"),
    'true',
  );
  await page.fillIn('#key-planner-mark_speed_mm_s', '250');
  await page.until(
    "() => document.querySelector('#key-planner-mark_speed_mm_s').getAttribute('aria-invalid') === null",
  );
  await planned();
});

step('Start saves, runs, and shows PASS; the files say the same', async () => {
  await page.click('#start', 'Save and start');
  await page.until("() => document.querySelector('.run progress')?.checkVisibility()");
  await shot('03-running');
  assert.equal(await verdict(), 'PASS');
  assert.match(await page.text('.run .words'), /all \d+ checks are proven good/);
  const saved = text('label-60x40.yaml');
  assert.match(saved, /^twin: fast$/m);
  assert.match(saved, /mark_speed_mm_s: 250\b/);
  assert.match(saved, /#/, 'comments stay');
  const report = await page.run(
    "() => [...document.querySelectorAll('.run .links a')].find((a) => a.textContent === 'Report').getAttribute('href')",
  );
  assert.ok(existsSync(inFolder(decodeURIComponent(report))), report);
  const judged = JSON.parse(text(decodeURIComponent(dirname(report)), 'verdict.json'));
  assert.equal(judged.verdict, 'PASS');
  await shot('04-pass');
});

step('an entity that is clicked is chosen in drawing, G-code and order', async () => {
  await page.clickAt(await onSheet(0, 0));
  await page.untilText('#readout', /Entity\s*E\d/);
  const id = /E(\d+)/.exec(await page.text('#readout'))[1];
  assert.match(
    await page.run("() => document.querySelector('#gcode .of-chosen').textContent"),
    new RegExp(`\\(E${id} `),
  );
  await page.click('#tab-order');
  assert.equal(await page.run("() => document.querySelector('#order [aria-selected=true]').dataset.id"), id);
  // With Shift another one; a rubber band around all of it.
  await page.clickAt(await onSheet(-60, 0), kShift);
  await page.untilText('#readout', /Entities\s*2/);
  await page.drag(await onSheet(-63, 23), await onSheet(3, -23));
  await page.untilText('#readout', /Entities\s*9/);
  await page.click('#tab-gcode');
  await page.click('#gcode .cm-line:nth-child(6)');
  await page.untilText('#readout', /Entity\s*E\d/);
  await shot('05-chosen');
});

step('the preview goes by periods and by lines, and at the end all is cut', async () => {
  await page.run("() => document.querySelector('#canvas').focus()");
  await page.key('Home');
  await page.untilText('#time', /^0\.0000 s/);
  const period_s = await page.run(
    "async () => { const { text } = { text: await (await fetch('/api/files/content?path=label-60x40.yaml')).text() }; const r = await fetch('/api/plan', { method: 'POST', headers: { 'X-Kerfbench': '1', 'Content-Type': 'application/json' }, body: JSON.stringify({ scenario_text: text, path: 'label-60x40.yaml' }) }); const p = (await r.json()).preview; return p.period_s * (p.stride ?? 1); }",
  );
  await page.key('.');
  await page.untilText('#time', new RegExp(`^${period_s.toFixed(4).replace('.', '\\.')} s`));
  await page.key('PageDown');
  const line = await page.text('.moment span b');
  await page.key('PageDown');
  assert.notEqual(await page.text('.moment span b'), line);
  await page.key('End');
  // Cut lengths of the preview are those of the plan, to what the steps of the mirrors make of them.
  const [, done] = /Cut ([\d.]+) mm/.exec(await page.text('.moment'));
  const [, whole] = /([\d.]+) mm of cuts/.exec(await page.text('.findings h2'));
  assert.ok(Math.abs(Number(done) - Number(whole)) < 0.02 * Number(whole), `${done} of ${whole}`);
  await page.choose('#colour', 'speed');
  await page.untilText('.legend', 'mm/s');
  await shot('06-preview');
});

step('distances are measured by the mouse and by keys', async () => {
  await page.click('[data-tool=measure]');
  await page.clickAt(await onSheet(-60, 17));
  await page.clickAt(await onSheet(-60, -17));
  await page.untilText('#readout', /Distance\s*34\.000 mm/);
  await page.run("() => document.querySelector('#canvas').focus()");
  await page.key('Escape');
  await page.key('Enter');
  for (let i = 0; i < 5; ++i) await page.key('ArrowRight', kShift);
  await page.key('Enter');
  await page.untilText('#readout', /Δy\s*-?0\.000 mm/);
  await page.key('Escape');
  await page.key('v');
});

step('a line of G-code that is edited so that it must FAIL does FAIL, in words', async () => {
  const lines = await page.run(
    "() => [...document.querySelectorAll('#gcode .cm-line')].map((line) => line.textContent)",
  );
  const at = lines.findIndex((line) => /^G01 .*Z1\b/.test(line));
  assert.ok(at >= 0);
  await page.click(`#gcode .cm-line:nth-child(${at + 1})`);
  await page.key('Home');
  for (let i = 0; i < lines[at].indexOf('Z1') + 1; ++i) await page.key('ArrowRight');
  await page.key('Delete');
  for (const key of '0.3') await page.key(key);
  await page.untilText('#panel-gcode .panel-head', 'By hand, not saved');
  await planned();
  await page.click('#start', 'Save and start');
  assert.equal(await verdict(), 'FAIL');
  assert.match(await page.text('.run .checks'), /limit/);
  assert.match(text('label-60x40.gcode'), /Z0\.3/);
  assert.match(text('label-60x40.yaml'), /gcode: label-60x40\.gcode/);
  await page.untilText('#panel-gcode .panel-head', 'By hand: label-60x40.gcode');
  await shot('07-fail');
});

step('G-code that is none is refused at its line, and nothing can be started', async () => {
  await page.click('#gcode .cm-line:nth-child(3)');
  await page.key('End');
  for (const key of ' Q7') await page.key(key);
  await page.untilText('#panel-gcode .fault', /^G-code, line 3: /);
  await page.until("() => document.querySelector('#gcode .of-fault')?.textContent.includes('Q7')");
  await page.until("() => document.querySelector('#start').disabled");
  await shot('08-gcode-fault');
  await page.click('#plan-again');
  await planned();
});

step('the order is changed by keys and by dragging, and written to the scenario', async () => {
  await page.click('#tab-order');
  const before = await order();
  await page.click('#order li:nth-child(3)');
  await page.key('ArrowUp', kAlt);
  const third = before[2];
  await page.until('(id) => document.querySelectorAll("#order li")[1]?.dataset.id === String(id)', third);
  await page.untilText('#order-how', 'By hand');
  const from = await page.place('#order li:nth-child(1)');
  const to = await page.place('#order li:nth-child(4)');
  const first = (await order())[0];
  await page.drag(from, { x: to.x, y: to.y + 4 });
  await page.until('(id) => document.querySelectorAll("#order li")[3]?.dataset.id === String(id)', first);
  await planned();
  const now = await order();
  assert.deepEqual(
    [...now].sort((a, b) => a - b),
    [...before].sort((a, b) => a - b),
  );
  await page.click('#save');
  await page.untilText('.what .state', /^saved$/);
  assert.match(text('label-60x40.yaml'), /order: *\[?/);
  assert.doesNotMatch(text('label-60x40.yaml'), /gcode: label/);
  await shot('09-order');
});

step('what is wrong in the text is marked at its line and keeps the job from starting', async () => {
  await page.click('#tab-text');
  const lines = await page.run(
    "() => [...document.querySelectorAll('#text .cm-line')].map((line) => line.textContent)",
  );
  const at = lines.findIndex((line) => /^name:/.test(line));
  await page.click(`#text .cm-line:nth-child(${at + 1})`);
  await page.key('End');
  await page.key('Enter');
  await page.type('nonsense: 3');
  await page.until("() => document.querySelector('#text .of-fault')?.textContent.includes('nonsense')");
  await page.until("() => document.querySelector('#start').disabled");
  await shot('10-text-fault');
  await page.run("() => document.querySelector('#canvas').focus()");
  await page.click('[aria-label=Undo]');
  await page.until("() => !document.querySelector('#text .of-fault')");
  await planned();
});

step('a run is stopped, and the page says so', async () => {
  await page.run("() => document.querySelector('#key-twin').scrollIntoView()");
  await page.choose('#key-twin', 'reference');
  await planned();
  const before = readdirSync(inFolder('results'), { recursive: true }).length;
  await page.click('#start', 'Save and start');
  await page.click('#stop');
  await page.untilText('.run .verdict', 'Stopped');
  assert.match(await page.text('.run .words'), /was stopped/);
  assert.equal(
    readdirSync(inFolder('results'), { recursive: true }).filter((name) => !/\.part$/.test(name)).length,
    before,
    'no results of it',
  );
  await shot('11-stopped');
  await page.click('[aria-label="Close the result"]');
});

step('names of a drawing are shown as they are and do nothing', async () => {
  const hostile = '<img src=x onerror="document.title=1">';
  const line = (layer, ...ends) =>
    `0\nLINE\n8\n${layer}\n` + ends.map((v, i) => `${[10, 20, 11, 21][i]}\n${v}\n`).join('');
  const square = [
    [0, 0, 40, 0],
    [40, 0, 40, 30],
    [40, 30, 0, 30],
    [0, 30, 0, 0],
  ];
  const entities = [...square.map((ends) => line('CUT', ...ends)), line(hostile, 5, 5, 9, 9)];
  writeFileSync(join(shots, 'hostile.dxf'), `0\nSECTION\n2\nENTITIES\n${entities.join('')}0\nENDSEC\n0\nEOF\n`);
  await page.drop('.stage', [join(shots, 'hostile.dxf')]);
  await page.untilText('.layer .name', 'CUT');
  await page.until(
    '(name) => [...document.querySelectorAll(".layer .name")].some((e) => e.textContent === name)',
    hostile,
  );
  assert.equal(await page.run("() => document.querySelectorAll('.job-page img').length"), 0);
  assert.notEqual(await page.run('() => document.title'), '1');
  await shot('12-hostile');
});

step('every control has a name, and there are landmarks', async () => {
  const { nodes } = await page.send('Accessibility.getFullAXTree');
  const roles = [
    'button',
    'textbox',
    'combobox',
    'slider',
    'checkbox',
    'tab',
    'listbox',
    'link',
    'searchbox',
    'MenuListPopup',
    'application',
  ];
  const unnamed = nodes.filter(
    (n) => !n.ignored && roles.includes(n.role?.value) && n.role.value !== 'MenuListPopup' && !n.name?.value,
  );
  assert.deepEqual(
    unnamed.map((n) => `${n.role.value} ${JSON.stringify(n.properties)}`),
    [],
  );
  const found = new Set(nodes.filter((n) => !n.ignored).map((n) => n.role?.value));
  for (const role of ['banner', 'main', 'navigation', 'contentinfo', 'region', 'status'])
    assert.ok(found.has(role), `no ${role}`);
});

step('all is reached by Tab, with a focus that can be seen', async () => {
  // From the first element on, wherever the step before has left the focus.
  await page.run("() => document.querySelector('.skip').focus()");
  const seen = new Set(['To the drawing']);
  for (let i = 0; i < 150; ++i) {
    await page.key('Tab');
    const focus = await page.run(`() => { const e = document.activeElement;
      if (e === document.body) return null;
      const c = getComputedStyle(e), r = e.getBoundingClientRect();
      return { name: e.id || e.getAttribute('aria-label') || e.textContent.trim().slice(0, 30), shown: r.width > 0,
        ring: (c.outlineStyle !== 'none' && parseFloat(c.outlineWidth) > 0) || e.closest('.cm-editor') !== null }; }`);
    if (!focus) break;
    seen.add(focus.name);
    assert.ok(focus.ring, `no ring around ${focus.name}`);
    assert.ok(focus.shown, `${focus.name} has the focus and cannot be seen`);
  }
  const wanted = ['To the drawing', 'scenario', 'machine', 'release', 'canvas', 'scrub', 'play', 'add-parameter'];
  for (const name of [...wanted, 'copy-command']) assert.ok(seen.has(name), `${name} is not reached: ${[...seen]}`);
});

step('at 640 px, which is 200 % of 1280, nothing is lost', async () => {
  await page.look({ width: 640, height: 900 });
  const wide = await page.run(`() => ({ page: document.documentElement.scrollWidth,
    beyond: [...document.querySelectorAll('button, select, input, canvas, h2')].filter((e) => e.checkVisibility() && !e.closest('.cm-editor, .visually-hidden') && !e.classList.contains('visually-hidden')).filter((e) => { const r = e.getBoundingClientRect(); return r.right > 641 || r.left < -1; }).map((e) => e.id || e.textContent) })`);
  assert.equal(wide.page, 640);
  assert.deepEqual(wide.beyond, []);
  await page.run('() => scrollTo(0, 0)');
  await shot('13-640');
  await page.look({ dark: true });
  await shot('14-dark');
  await page.look({});
});

step('nothing was logged as an error, and nothing was asked for elsewhere', async () => {
  assert.deepEqual(
    page.errors.filter((line) => !/status of 4\d\d/.test(line)),
    [],
  );
  const elsewhere = page.requests.filter(
    (url) => !url.startsWith(new URL(server.url).origin) && !/^(data|blob):/.test(url),
  );
  assert.deepEqual(elsewhere, []);
});
