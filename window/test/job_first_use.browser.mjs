// SPDX-License-Identifier: Apache-2.0
// Somebody's first drawing in the window, with all that goes wrong on the way: no unit, a drawing that does not lie in the field, G-code
// that leaves it, a verdict of an earlier job, files of the same name. By mouse and by keyboard.
//   KERFBENCH=build/release/bin/kerfbench KERFBENCH_SHOTS=FOLDER node --test window/test/job_first_use.browser.mjs
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch } from './browser.mjs';
import { contrastsOf } from './contrast_in_page.mjs';
import { serve } from './server.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.KERFBENCH ?? join(root, 'build/release/bin/kerfbench');
const shots = process.env.KERFBENCH_SHOTS ?? join(root, 'build/window-shots');
const kControl = 2;

const svg = (body, attributes = "width='240' height='170'") =>
  `<svg xmlns='http://www.w3.org/2000/svg' ${attributes}>\n${body}\n</svg>\n`;
const bare = svg(
  "<rect x='10' y='10' width='220' height='150' fill='none' stroke='black'/>\n<text x='5' y='5'>Lid</text>",
);

let server;
let browser;
let page;
const inFolder = (...path) => join(server.folder, ...path);
const text = (...path) => readFileSync(inFolder(...path), 'utf8');
const shot = (name) => page.screenshot(join(shots, `${name}.png`));
const settled = () => page.until("() => document.querySelector('.job-page').getAttribute('aria-busy') === 'false'");
const isShown = (selector) => page.run('(s) => Boolean(document.querySelector(s)?.checkVisibility())', selector);
const focus = (selector) => page.run('(s) => document.querySelector(s).focus()', selector);
const drawings = () =>
  readdirSync(server.folder)
    .filter((name) => /\.(svg|dxf|yaml)$/.test(name))
    .sort();
/** Drops a file of these bytes under a name. */
async function drop(name, bytes) {
  const path = join(shots, name);
  writeFileSync(path, bytes);
  await page.drop('.stage', [path]);
}
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
const step = (name, act) =>
  test(name, async () => {
    try {
      await act();
    } catch (fault) {
      await shot('failed').catch(() => {});
      throw fault;
    }
  });

step('a drawing without a unit is asked for it, and what is left out of it is told', async () => {
  await page.open(server.url);
  await page.untilText('.empty h1', 'Drop a drawing here');
  await drop('lid.svg', bare);
  await page.untilText('#unit-question', '1 unit of the drawing is');
  await settled();
  assert.match(await page.text('#unit-size'), /does not say it\. So the drawing is 220\.0 × 150\.0 mm/);
  const findings = await page.text('.findings');
  assert.match(findings, /lid\.svg, line 1: the file does not say how long one unit is/);
  assert.match(findings, /lid\.svg, line 3: text: 1 ignored/);
  await shot('01-no-unit');
});

step('a drawing that is too large is told with what to change, before Start', async () => {
  await page.untilText('#too-large', /220\.0 × 150\.0 mm, the field of .* choose a machine with a larger field/);
  assert.equal(await page.run("() => document.querySelector('#start').disabled"), true);
  assert.equal(await isShown('#place-anew'), false, 'no place would be right for it');
});

step('another unit, by keys, takes marks and start with it, and one undo takes it back', async () => {
  await focus('#unit-mm');
  await page.key('ArrowDown');
  await page.until("() => document.querySelector('#unit-px').checked");
  await page.untilText('#unit-size', '58.2 × 39.7 mm');
  await page.untilText('.findings h2', /^2 notes$/);
  assert.equal(await isShown('#too-large'), false);
  assert.equal(await page.run("() => document.querySelector('#start').disabled"), false);
  await shot('02-px');
  await focus('#canvas');
  await page.key('z', kControl);
  await page.untilText('#unit-size', '220.0 × 150.0 mm');
  await page.click('[aria-label=Redo]');
  await page.untilText('#unit-size', '58.2 × 39.7 mm');
  await settled();
});

step('the frames are drawn with a legend in plain words, and can be left out', async () => {
  const legend = await page.text('.legend');
  for (const words of ['field: what the beam reaches', 'sheet', 'print marks', 'axes x, y of the sheet', 'beam at rest: x_W'])
    assert.ok(legend.includes(words), `${words} in ${legend}`);
  assert.match(await page.text('#frame-words'), /x_W and y_W are places under the machine, from the beam at rest\. Now x_W is x − [\d.]+ mm/);
  await focus('#canvas');
  await page.key('a');
  await page.until("() => !document.querySelector('.legend').innerText.includes('field')");
  assert.equal(await page.run("() => document.querySelector('#frames').getAttribute('aria-pressed')"), 'false');
  await page.key('a');
});

step('a drawing that was laid beside the field is laid anew by one click', async () => {
  await page.fillIn('#key-belt-start_x_mm', '300');
  await page.untilText('.offer', 'outside of the field');
  await settled();
  assert.equal(await page.run("() => document.querySelector('#start').disabled"), true);
  await shot('03-beside');
  await focus('#place-anew');
  await page.key('Enter');
  await page.untilText('.findings h2', /^2 notes$/);
  await page.until("() => !document.querySelector('#place-anew').checkVisibility()");
});

step('a verdict is marked as one of the earlier job at the first change, and no more when that is taken back', async () => {
  await page.run("() => document.querySelector('#add-parameter').focus()");
  await page.type('twin');
  await page.untilText('#found', /^twin\b/m);
  await page.key('Enter');
  await page.until("() => document.activeElement?.id === 'key-twin'");
  await page.choose('#key-twin', 'fast');
  await settled();
  await page.click('#start', 'Save and start');
  assert.equal(await verdict(), 'PASS');
  assert.equal(await isShown('#earlier-job'), false);
  await page.fillIn('#key-planner-mark_speed_mm_s', '150');
  await page.untilText('#earlier-job', 'Of the job before it was changed');
  await shot('04-earlier');
  await page.click('[aria-label=Undo]');
  await page.until("() => !document.querySelector('#earlier-job').checkVisibility()");
  await settled();
});

step('G-code that leaves the drawing is told with its line and place, before Start', async () => {
  const lines = await page.run(
    "() => [...document.querySelectorAll('#gcode .cm-line')].map((line) => line.textContent)",
  );
  const at = lines.findIndex((line) => /^G01 .*Z1\b/.test(line));
  await page.click(`#gcode .cm-line:nth-child(${at + 1})`);
  await page.key('Home');
  // X60.85 becomes X80.85.
  for (let i = 0; i < lines[at].indexOf('X6') + 1; ++i) await page.key('ArrowRight');
  await page.key('Delete');
  await page.key('8');
  await page.untilText('.findings', new RegExp(`G-code, line ${at + 1}: its cut leaves the drawing by`));
  const words = await page.text('.findings');
  assert.doesNotMatch(words, /G-code line \d/, 'each line is told once');
  assert.match(words, /G-code: E\d+: [\d.]+ mm of it are cut by no line/);
  assert.equal(await page.run("() => document.querySelector('#start').disabled"), false, 'it may be meant so');
  await page.until("() => Boolean(document.querySelector('#gcode .cm-lint-marker-warning'))");
  // By the keyboard to the line, and to the place in the drawing.
  await page.run(
    "() => [...document.querySelectorAll('.findings li button')].find((b) => b.innerText.includes('leaves the drawing')).focus()",
  );
  await page.key('Enter');
  await page.until(
    '(n) => [...document.querySelectorAll("#gcode .cm-line")][n].classList.contains("of-chosen")',
    at,
  );
  await shot('05-leaves');
});

step('a check that failed leads to its place in drawing and G-code, by mouse and by keys', async () => {
  await page.click('#start', 'Save and start');
  assert.equal(await verdict(), 'FAIL');
  await page.click('[data-show=machine]');
  await page.until("() => Boolean(document.querySelector('.run .to-place'))");
  await focus('.run .to-place');
  await page.key('Enter');
  await page.until("() => document.querySelector('[data-show=drawing]').getAttribute('aria-pressed') === 'true'");
  await page.untilText('#readout', /Entity\s*E\d/);
  await page.until("() => Boolean(document.querySelector('#gcode .of-chosen'))");
  assert.match(await page.text('#readout'), /Drawn\s*lid\.svg, line 2/);
  // Each that has a place of its own gets a ring there.
  let rings = 0;
  for (const i of Array(await page.run("() => document.querySelectorAll('.run .to-place').length")).keys()) {
    await page.run("(i) => document.querySelectorAll('.run .to-place')[i].click()", i);
    await page.run('() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))');
    rings += (await page.run("() => document.querySelector('#canvas').dataset.place")) === '' ? 0 : 1;
  }
  assert.ok(rings > 0, 'no check had a place');
  const said = await page.text('.run .checks');
  assert.match(said, /±/);
  await shot('06-check');
  await page.click('.run .to-place');
  await page.untilText('#readout', /Entity\s*E\d/);
});

step('from the trace the link Job leads back to the job and its verdict', async () => {
  const summary = await page.text('.run .words');
  await page.click('.run .links a', 'Trace at this moment');
  await page.until("() => location.pathname === '/view' && Boolean(document.querySelector('.viewer'))");
  await page.click('nav a', 'Job');
  await page.until("() => location.pathname === '/' && document.querySelector('.run .verdict')?.checkVisibility()");
  assert.equal(await verdict(), 'FAIL');
  assert.equal(await page.text('.run .words'), summary);
  await settled();
  assert.equal(await isShown('#earlier-job'), false, 'nothing was changed');
  assert.match(await page.run('() => location.hash'), /scenario=lid\.yaml&results=results%2Flid%2F/);
  await shot('07-back');
  // So does it from the other pages; and an earlier verdict is shown by a click on it.
  await page.click('nav a', 'Service');
  await page.untilText('h1', 'Service');
  await page.click('nav a', 'Job');
  await page.until("() => document.querySelector('.run .verdict')?.checkVisibility()");
  await settled();
  await page.click('.earlier button', 'PASS');
  await page.untilText('.run .verdict', 'PASS');
  await page.untilText('#earlier-job', 'Of the job before it was changed');
});

step('a drawing of fills alone is refused in words and leaves nothing behind', async () => {
  const before = drawings();
  await drop('fills.svg', svg("<rect width='20' height='20' fill='red'/>", "width='60mm' height='40mm'"));
  await page.untilText('#notice', 'fills.svg: it holds no line that could be cut');
  await page.untilText('#notice', 'fills.svg:2: rect without a stroke');
  assert.deepEqual(drawings(), before);
  await shot('08-fills');
});

step('the same drawing again is not written twice, and another one of its name is asked for', async () => {
  const before = drawings();
  await drop('lid.svg', bare);
  await page.untilText('#notice', 'lid.svg is in the folder already, byte for byte: its scenario lid.yaml is open');
  assert.deepEqual(drawings(), before);
  const other = bare.replace("width='220'", "width='200'");
  await drop('lid.svg', other);
  await page.untilText('#notice', 'There is another file lid.svg in the folder. Nothing was written yet.');
  assert.equal(text('lid.svg'), bare);
  await shot('09-which');
  await page.click('#notice button', 'Keep both: lid-2.svg');
  await page.until("() => location.hash.includes('lid-2.yaml')");
  assert.equal(text('lid-2.svg'), other);
  assert.equal(text('lid.svg'), bare);
  await settled();
  const third = bare.replace("width='220'", "width='210'");
  await drop('lid-2.svg', third);
  await page.untilText('#notice', 'another file lid-2.svg');
  await page.run("() => document.querySelector('#notice button').focus()");
  await page.key('Enter');
  await page.untilText('#notice', 'lid-2.svg was replaced');
  await page.untilText('#unit-size', '210.0 × 150.0 mm');
  assert.equal(text('lid-2.svg'), third);
  assert.ok(!existsSync(inFolder('lid-3.svg')) && !existsSync(inFolder('lid-2-2.svg')));
});

step('what is new has names, is reached by Tab, and is not lost at 200 %', async () => {
  const { nodes } = await page.send('Accessibility.getFullAXTree');
  const unnamed = nodes.filter(
    (n) => !n.ignored && ['button', 'radio', 'link', 'group'].includes(n.role?.value) && !n.name?.value,
  );
  assert.deepEqual(
    unnamed.map((n) => `${n.role.value} ${JSON.stringify(n.properties)}`).filter((words) => !/^group/.test(words)),
    [],
  );
  assert.ok(
    nodes.some((n) => ['group', 'radiogroup'].includes(n.role?.value) && /1 unit of the drawing is/.test(n.name?.value ?? '')),
    'the question is a group with a name',
  );
  await focus('.skip');
  const seen = new Set();
  for (let i = 0; i < 150; ++i) {
    await page.key('Tab');
    const now = await page.run(
      '() => { const e = document.activeElement; return e === document.body ? null : e.id || e.className || e.textContent; }',
    );
    if (now === null) break;
    seen.add(now);
  }
  for (const id of ['frames', 'unit-mm']) assert.ok(seen.has(id), `${id} is not reached: ${[...seen]}`);
  await page.look({ width: 640, height: 900 });
  const lost = await page.run(`() => [...document.querySelectorAll('#unit-question, #unit-question label, .offer, .frame-words, #notice button, #too-large, .legend > span, #frames')]
    .filter((e) => e.checkVisibility())
    .filter((e) => { const r = e.getBoundingClientRect(); return r.right > 641 || r.left < -1 || r.width === 0; }).map((e) => e.id || e.textContent)`);
  assert.deepEqual(lost, []);
  assert.equal(await page.run('() => document.documentElement.scrollWidth'), 640);
  await shot('10-640');
  await page.look({});
});

step('the words of all this have a contrast of 4.5 in both schemes, as they are painted', async () => {
  for (const dark of [false, true]) {
    await page.look({ dark });
    const found = await contrastsOf(
      page,
      '#unit-question legend, #unit-question label, #unit-size, .offer, #too-large, .frame-words, #notice p, #notice button, #earlier-job, .run .to-place, .earlier button, .legend > span',
    );
    assert.ok(found.length >= 10, `${found.length} were there`);
    assert.deepEqual(
      found.filter(({ contrast }) => contrast < 4.5),
      [],
    );
    await shot(dark ? '12-dark' : '11-light');
  }
  await page.look({});
});

step('nothing was logged as an error', async () => {
  assert.deepEqual(
    page.errors.filter((line) => !/status of 4\d\d/.test(line)),
    [],
  );
});
