// SPDX-License-Identifier: Apache-2.0
// The page's own script and data, held against the G-code that kerfplan writes, which is read here anew.
'use strict';
const assert = require('assert');
const fs = require('fs');
const os = require('os');
const path = require('path');
const {jobs, run, fails, dataOf, playerOf} = require('./pages.js');

// Moves of kerfplan's own G-code: what this test needs of the dialect.
function movesOf(gcode) {
  const moves = [];
  let at = null, begun = false;
  gcode.split('\n').forEach((text, i) => {
    const match = /^G0([0-3]) X(\S+) Y(\S+)(?: I(\S+) J(\S+))? Z(\S+)/.exec(text);
    if (!match) return;
    const [g, x, y, ci, cj, z] = match.slice(1).map(Number);
    const move = {line: i + 1, g, z, from: at, to: [x, y], centre: at && [at[0] + ci, at[1] + cj]};
    if (g >= 2) {
      const a0 = Math.atan2(-cj, -ci), a1 = Math.atan2(y - move.centre[1], x - move.centre[0]);
      const turn = 2 * Math.PI, same = at[0] === x && at[1] === y;
      let sweep = g === 3 ? (a1 - a0) % turn : (a0 - a1) % turn;
      if (sweep < 0) sweep += turn;
      move.radius = Math.hypot(ci, cj);
      move.length = (same ? turn : sweep) * move.radius;
    } else if (at) {
      move.length = Math.hypot(x - at[0], y - at[1]);
    }
    at = [x, y];
    begun = begun || g > 0;
    if (begun) moves.push(move);
  });
  return moves;
}

function distance(move, [x, y]) {
  if (move.g >= 2) return Math.abs(Math.hypot(x - move.centre[0], y - move.centre[1]) - move.radius);
  const d = [move.to[0] - move.from[0], move.to[1] - move.from[1]], p = [x - move.from[0], y - move.from[1]];
  const u = Math.min(Math.max((p[0] * d[0] + p[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]), 0), 1);
  return Math.hypot(p[0] - u * d[0], p[1] - u * d[1]);
}

function checkMotion(name, args) {
  const html = run('preview', args), job = dataOf(html), player = playerOf(html), motion = player.makeMotion(job);
  const moves = movesOf(run('gcode', args)), by_line = new Map(moves.map((m) => [m.line, m]));
  assert.strictEqual(html, run('preview', args), name + ': same input, same bytes');
  assert.strictEqual(job.lines.join('\n') + '\n', run('gcode', args), name);
  assert.strictEqual(job.runs.reduce((sum, r) => sum + r[1], 1), motion.n, name + ': every period has its line');
  // The beam is on the line that is said to be under way, with the laser as its Z says.
  // While it catches up with the sheet it is beside its first line, in the dark.
  for (let i = 1; i <= job.catch_up; ++i) assert.strictEqual(motion.at(i * job.period_s).on, false, `${name}: dark before it is at speed`);
  for (let i = 1 + job.catch_up; i < motion.n; ++i) {
    const now = motion.at(i * job.period_s), move = by_line.get(now.line);
    assert.ok(move, `${name}: period ${i} belongs to line ${now.line}, which is no move`);
    assert.strictEqual(now.on, move.g > 0 && move.z > 0 && now.speed_mm_s > 0, `${name}: laser in period ${i}`);
    // At corners by no more than --corner-error, and by half a step of each axis, 0.0129 mm.
    if (move.g > 0) assert.ok(distance(move, [now.x, now.y]) < 5e-3 + Math.SQRT1_2 * 0.0129 + 1e-4, `${name}: period ${i} is off line ${now.line}`);
    assert.ok(now.power_w <= job.full_power_w + 1e-9 && now.speed_mm_s < 1000);
  }
  // Every line that cuts has its turn, in order, and nothing is cut that is not in the G-code.
  const steps = motion.steps.map((s) => s.line).filter((line, i, all) => line !== all[i - 1]);
  const long = (m) => m.length > 0.5;  // shorter ones may begin and end within one period
  assert.deepStrictEqual(steps.filter((l) => long(by_line.get(l))), moves.filter((m) => m.from && long(m)).map((m) => m.line), name);
  const end = motion.at(motion.duration_s), length = (jump) =>
    moves.filter((m) => m.from && (m.g === 0 || m.z === 0) === jump).reduce((sum, m) => sum + m.length, 0);
  // Chords of arcs are shorter than the arcs.
  assert.ok(Math.abs(end.cut_mm - length(false)) < 0.005 * length(false), `${name}: ${end.cut_mm} of ${length(false)} mm`);
  const dark_mm = end.jump_mm - motion.at(job.catch_up * job.period_s).jump_mm;
  assert.ok(Math.abs(dark_mm - length(true)) < 0.02 * length(true) + 1e-6, `${name}: ${dark_mm} of ${length(true)} mm`);
  // Power follows Z: a crease at half of it.
  for (const z of new Set(moves.filter((m) => m.g > 0).map((m) => m.z))) {
    let worst = 0;
    for (let i = 1 + job.catch_up; i < motion.n; ++i) {
      const now = motion.at(i * job.period_s);
      if (!now.on || by_line.get(now.line).z !== z || by_line.get(now.line).g > 1) continue;
      // Round a corner the chord that gives the speed is shorter than the way that gets the power.
      if (motion.at((i - 1) * job.period_s).line !== now.line) continue;
      worst = Math.max(worst, Math.abs(now.power_w - Math.min(0.3 * z * now.speed_mm_s, job.full_power_w)));
    }
    assert.ok(worst < 0.02 * job.full_power_w + 0.5, `${name}: power of Z${z} is off by ${worst} W`);
  }
  const pieces = player.piecesOf(job.segments);
  assert.strictEqual(pieces.length, moves.filter((m, i) => m.g > 0 && (i === 0 || moves[i - 1].g === 0)).length, name);
}

function checkStops() {
  const html = run('preview', jobs['carton on the belt']), player = playerOf(html), motion = player.makeMotion(dataOf(html));
  const forward = [0];
  while (forward.at(-1) < motion.duration_s) forward.push(player.nextStop(motion, forward.at(-1), 1));
  const back = [motion.duration_s];
  while (back.at(-1) > 0) back.push(player.nextStop(motion, back.at(-1), -1));
  assert.deepStrictEqual(back.reverse(), forward, 'stepping back meets the stops of stepping on');
  assert.strictEqual(forward.length, motion.steps.length + 1);
  // Between two periods the beam is between two places.
  const a = motion.at(1.0), b = motion.at(1.0004), c = motion.at(1.0008);
  assert.ok(Math.abs(b.x - (a.x + c.x) / 2) < 1e-9 && Math.abs(b.y - (a.y + c.y) / 2) < 1e-9);
  assert.deepStrictEqual(motion.at(-5), motion.at(0));
  assert.deepStrictEqual(motion.at(1e9), motion.at(motion.duration_s));
}

function checkSelfContained(html) {
  assert.doesNotMatch(html, /https?:|src=|<link|@import|url\(|fetch\(|XMLHttp|import\(/, 'nothing is loaded from elsewhere');
}

function checkHostileText() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'kerfplan-'));
  const file = path.join(folder, `<b onclick='x'>&.nc`);
  fs.writeFileSync(file, Buffer.concat([
    Buffer.from('G00 X0 Y0 ;</script><script>alert(1)</script><!-- \nG01 X-20 Z1 ('), Buffer.from([0xff, 0xc3, 0x41]),
    Buffer.from(')\n')]));
  const {stdout, status} = fails('preview', [file]);
  assert.strictEqual(status, 0);
  assert.strictEqual(stdout.match(/<script/g).length, 2, 'a comment opens no script');
  assert.ok(!stdout.includes('<b onclick'));
  assert.ok(dataOf(stdout).lines[0].includes('</script><script>alert(1)'), 'and is shown as it is');
  fs.writeFileSync(file, 'G00 X0 Y0\nG01 X1 Q1\n');
  const bad = fails('preview', [file]);
  assert.strictEqual(bad.status, 65);
  assert.match(bad.stderr, /line 2/);
  fs.rmSync(folder, {recursive: true});
}

for (const [name, args] of Object.entries(jobs)) {
  checkMotion(name, args);
  checkSelfContained(run('preview', args));
}
checkStops();
checkHostileText();
const misfit = run('preview', jobs['carton that does not fit']);
assert.match(misfit, /does not fit/);
assert.match(misfit, /<li>a belt speed of 300 mm\/s is too high/);
assert.match(misfit, /<li>from E\d+: .* the laser has 10 W/);
console.log('preview: script and data are good for ' + Object.keys(jobs).length + ' jobs');
