// SPDX-License-Identifier: Apache-2.0
// The page in headless Chromium, worked by its keys as a person would. Skipped, and said so, where there is none.
'use strict';
const assert = require('assert');
const {spawnSync} = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');
const {jobs, run} = require('./pages.js');

const chromium = ['chromium', 'chromium-browser', 'google-chrome'].find((name) => spawnSync('which', [name]).status === 0);
if (!chromium) {
  console.log('SKIPPED: no Chromium on this machine');
  process.exit(77);
}

// Runs in the page after its own script.
async function drive() {
  const $ = (id) => document.getElementById(id), out = {errors: window.pageErrors};
  const key = (name, shiftKey = false) => document.dispatchEvent(new KeyboardEvent('keydown', {key: name, shiftKey, bubbles: true}));
  const selected = () => Number(document.querySelector('[aria-selected=true] b').textContent);
  const time = () => Number($('scrub').value);
  const painted = () => {
    const view = $('view'), d = view.getContext('2d').getImageData(0, 0, view.width, view.height).data;
    let warm = 0;  // colours of a ramp: grey, blue and white have no such red
    for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 200 && d[i] > d[i + 2] + 60) ++warm;
    return warm;
  };
  out.hash = {time: time(), line: selected()};
  key('Home');
  out.home = {time: time(), painted: painted()};
  key('ArrowRight');
  out.one_on = {time: time(), line: selected()};
  key('ArrowRight', true);
  out.period_s = time() - out.one_on.time;
  key('ArrowLeft', true);
  key('ArrowLeft');
  out.one_back = time();
  key('End');
  out.end = {time: time(), painted: painted(), cut: $('r-cut').textContent, max: Number($('scrub').max)};
  key('Home');
  key(' ');
  out.pressed = $('play').getAttribute('aria-pressed');
  // The browser's time is virtual: how many frames it draws meanwhile is left to the computer.
  for (let waits = 0; waits < 200 && time() === 0; ++waits) await new Promise((resolve) => setTimeout(resolve, 100));
  key(' ');
  out.played_s = time();
  await new Promise((resolve) => setTimeout(resolve, 200));
  out.paused_s = time();
  key('+');
  out.speeds = [$('speed').value];
  key('-');
  out.speeds.push($('speed').value);
  const row = document.querySelectorAll('.row:not(.still)')[5];
  out.wanted = Number(row.querySelector('b').textContent);
  row.click();
  out.clicked = selected();
  key('j');
  key('n');
  out.toggles = [$('jumps').getAttribute('aria-pressed'), $('numbers').getAttribute('aria-pressed')];
  out.loaded = performance.getEntriesByType('resource').map((r) => r.name);
  out.focusable = [...document.querySelectorAll('button,select,input,[tabindex]')].filter((e) => e.tabIndex >= 0).length;
  out.nameless = [...document.querySelectorAll('button')].filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim())).length;
  document.body.innerHTML = '<pre id=result></pre>';
  document.getElementById('result').textContent = JSON.stringify(out);
}

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'kerfplan-'));
const html = run('preview', jobs['carton on the belt'])
  .replace('<style>', `<script>window.pageErrors=[];addEventListener('error',(e)=>pageErrors.push(e.message))</script><style>`)
  .replace('</body>', `<script>(${drive})()</script></body>`);
fs.writeFileSync(path.join(folder, 'job.html'), html);
const {stdout, stderr} = spawnSync(chromium, ['--headless', '--no-sandbox', '--disable-gpu', '--window-size=1400,900',
  '--user-data-dir=' + path.join(folder, 'profile'), '--virtual-time-budget=30000', '--dump-dom',
  'file://' + path.join(folder, 'job.html') + '#t=2.5'], {encoding: 'utf8', maxBuffer: 1 << 26});
fs.rmSync(folder, {recursive: true, force: true});
const match = /<pre id="result">(.*?)<\/pre>/s.exec(stdout);
assert.ok(match, 'the page did not get to its end: ' + stderr);
const seen = JSON.parse(match[1].replace(/&lt;/g, '<').replace(/&gt;/g, '>').replace(/&amp;/g, '&'));
assert.deepStrictEqual(seen.errors, []);
assert.deepStrictEqual(seen.loaded, [], 'nothing is loaded');
assert.strictEqual(seen.hash.time, 2.5);
assert.ok(seen.hash.line > 10);
assert.strictEqual(seen.home.time, 0);
assert.strictEqual(seen.home.painted, 0);
assert.strictEqual(seen.one_on.line, 3, 'line 2 is the jump to the start, line 3 the first mark');
assert.ok(seen.one_on.time > 0);
assert.ok(Math.abs(seen.period_s - 0.0008) < 1e-9);
assert.strictEqual(seen.one_back, 0);
assert.ok(Math.abs(seen.end.time - seen.end.max) < 1e-9);
assert.ok(seen.end.painted > 2000, 'the job is drawn in colours of power');
const [cut, whole] = seen.end.cut.match(/[0-9.]+/g).map(Number);
assert.strictEqual(cut, whole);
assert.strictEqual(seen.pressed, 'true');
assert.ok(seen.played_s > 0, 'it plays');
assert.strictEqual(seen.paused_s, seen.played_s, 'and pauses');
assert.ok(Number(seen.speeds[0]) > Number(seen.speeds[1]));
assert.ok(seen.wanted > 3);
assert.strictEqual(seen.clicked, seen.wanted);
assert.deepStrictEqual(seen.toggles, ['false', 'false']);
assert.ok(seen.focusable >= 11);
assert.strictEqual(seen.nameless, 0);
console.log('preview: the page plays in ' + chromium);
