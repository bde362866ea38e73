// SPDX-License-Identifier: Apache-2.0
'use strict';

// The motion as arrays over the interpolation periods: places from the program's own steps in 1e-9 mm, so that
// sums are exact; ways as planned, since whole steps leave a period's speed to chance. No document is needed up
// to startPage().
function makeMotion(job) {
  const n = job.x.length;
  const x = new Float64Array(n), y = new Float64Array(n);
  const cut_mm = new Float64Array(n), jump_mm = new Float64Array(n);
  for (let i = 0, sx = 0, sy = 0; i < n; ++i) {
    x[i] = (sx += job.x[i]) / 1e9;
    y[i] = (sy += job.y[i]) / 1e9;
    if (i === 0) continue;
    const way = job.way_nm[i] / 1e6;
    cut_mm[i] = cut_mm[i - 1] + (job.power[i] > 0 ? way : 0);
    jump_mm[i] = jump_mm[i - 1] + (job.power[i] > 0 ? 0 : way);
  }
  // A step is a stretch of one G-code line: samples (first, last].
  const steps = [], step_of = new Int32Array(n);
  for (let i = 0, k = 0; k < job.runs.length; ++k) {
    const [line, count] = job.runs[k];
    steps.push({line, first: i, last: i + count});
    for (let j = 0; j < count; ++j) step_of[++i] = k;
  }
  if (n > 0 && steps.length > 0) step_of[0] = 0;
  const duration_s = (n - 1) * job.period_s;
  return {x, y, power: job.power, cut_mm, jump_mm, steps, step_of, n, duration_s,
    at(t_s) {
      const u = Math.min(Math.max(t_s / job.period_s, 0), n - 1);
      const i = Math.min(Math.ceil(u - 1e-9), n - 1), from = Math.max(i - 1, 0), w = i > 0 ? u - from : 0;
      const mix = (a) => a[from] + w * (a[i] - a[from]);
      const way = i > 0 ? job.way_nm[i] / 1e6 : 0;
      return {sample: i, step: step_of[i], line: steps.length ? steps[step_of[i]].line : 0, x: mix(x), y: mix(y),
        power_w: job.power[i] / 255 * job.full_power_w, on: job.power[i] > 0, speed_mm_s: way / job.period_s,
        cut_mm: mix(cut_mm), jump_mm: mix(jump_mm)};
    },
    stepStart_s: (k) => steps[k].first * job.period_s,
    stepEnd_s: (k) => steps[k].last * job.period_s};
}

// Where "one line on" and "one line back" lead.
function nextStop(motion, t_s, sense) {
  const eps = 1e-9;
  if (sense > 0) {
    for (let k = 0; k < motion.steps.length; ++k)
      if (motion.stepEnd_s(k) > t_s + eps) return motion.stepEnd_s(k);
    return motion.duration_s;
  }
  for (let k = motion.steps.length; k-- > 0;)
    if (motion.stepStart_s(k) < t_s - eps) return motion.stepStart_s(k);
  return 0;
}

// Power as a share 0 … 1 of the most that the job uses: dark violet over orange to yellow, all visible on light and dark.
const kRamp = [[88, 60, 160], [160, 52, 140], [216, 67, 84], [240, 128, 30], [245, 188, 20]];
function rampColour(share) {
  const u = Math.min(Math.max(share, 0), 1) * (kRamp.length - 1), i = Math.min(Math.floor(u), kRamp.length - 2);
  return 'rgb(' + kRamp[i].map((c, k) => Math.round(c + (u - i) * (kRamp[i + 1][k] - c))).join(',') + ')';
}

// Points of a segment [line, jump, z, x0, y0, x1, y1, cx, cy, sweep], fine enough for the screen.
function pointsOf(s) {
  const [, , , x0, y0, x1, y1, cx, cy, sweep] = s;
  if (sweep === 0) return [[x0, y0], [x1, y1]];
  const n = Math.max(2, Math.ceil(Math.abs(sweep) / 0.05)), a = Math.atan2(y0 - cy, x0 - cx), r = Math.hypot(x0 - cx, y0 - cy);
  const points = [];
  for (let i = 0; i <= n; ++i) points.push([cx + r * Math.cos(a + sweep * i / n), cy + r * Math.sin(a + sweep * i / n)]);
  return points;
}

// First points of the stretches that are cut without a jump: what the order numbers stand at.
function piecesOf(segments) {
  const pieces = [];
  segments.forEach((s, i) => {
    if (!s[1] && (i === 0 || segments[i - 1][1])) pieces.push({x: s[3], y: s[4], line: s[0]});
  });
  return pieces;
}

function startPage(doc, win) {
  const job = JSON.parse(doc.getElementById('job').textContent);
  const motion = makeMotion(job), pieces = piecesOf(job.segments);
  const $ = (id) => doc.getElementById(id);
  const canvas = $('view'), done = doc.createElement('canvas');
  const state = {t: 0, playing: false, jumps: true, numbers: true, scale: 1, dx: 0, dy: 0, drawn: -1, width: 0, height: 0};
  const most = Math.max(1, job.power.reduce((a, b) => Math.max(a, b), 0));
  const kSpeeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20];
  let speed = kSpeeds.reduce((a, b) =>
    Math.abs(Math.log(motion.duration_s / b / 12)) < Math.abs(Math.log(motion.duration_s / a / 12)) ? b : a);

  const outlines = job.segments.map((s) => ({jump: s[1], points: pointsOf(s)}));
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const {points} of outlines) for (const [px, py] of points) {
    box[0] = Math.min(box[0], px); box[1] = Math.min(box[1], py);
    box[2] = Math.max(box[2], px); box[3] = Math.max(box[3], py);
  }

  const sx = (px) => px * state.scale + state.dx, sy = (py) => -py * state.scale + state.dy;
  const colour = (name) => win.getComputedStyle(doc.documentElement).getPropertyValue(name).trim();

  function fit() {
    const w = Math.max(box[2] - box[0], 1e-3), h = Math.max(box[3] - box[1], 1e-3);
    state.scale = 0.86 * Math.min(state.width / w, Math.max(state.height - 40, 50) / h);
    state.dx = (state.width - (box[0] + box[2]) * state.scale) / 2;
    state.dy = (state.height - 30 + (box[1] + box[3]) * state.scale) / 2;
    state.drawn = -1;
    draw();
  }

  function resize() {
    const r = canvas.parentElement.getBoundingClientRect(), ratio = win.devicePixelRatio || 1;
    const first = state.width === 0;
    state.width = r.width;
    state.height = r.height;
    for (const c of [canvas, done]) {
      c.width = Math.max(1, Math.round(r.width * ratio));
      c.height = Math.max(1, Math.round(r.height * ratio));
      c.getContext('2d').setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    state.drawn = -1;
    if (first || !state.moved) fit(); else draw();
  }

  // The way that has been run is kept on a canvas of its own, to which playing only adds.
  function drawDone(upto) {
    const g = done.getContext('2d');
    if (state.drawn < 0 || upto < state.drawn) {
      g.clearRect(0, 0, state.width, state.height);
      state.drawn = 0;
    }
    const kind = (i) => (motion.power[i] > 0 ? 1 + Math.round(24 * motion.power[i] / most) : 0);
    g.lineCap = g.lineJoin = 'round';
    for (let i = state.drawn; i < upto;) {
      const k = kind(i + 1);
      g.beginPath();
      g.moveTo(sx(motion.x[i]), sy(motion.y[i]));
      while (i < upto && kind(i + 1) === k) g.lineTo(sx(motion.x[++i]), sy(motion.y[i]));
      if (k === 0 && !state.jumps) continue;
      g.setLineDash(k === 0 ? [5, 4] : []);
      g.lineWidth = k === 0 ? 1.2 : 2.8;
      g.strokeStyle = k === 0 ? colour('--jump') : rampColour((k - 1) / 24);
      g.stroke();
    }
    state.drawn = upto;
  }

  function drawField(g) {
    if (!job.field) return;
    const shift = job.field.beta_mm + job.belt_mm_s * state.t, f = job.field;
    const x0 = sx(f.min[0] - shift), x1 = sx(f.max[0] - shift), y0 = sy(f.max[1]), y1 = sy(f.min[1]);
    g.fillStyle = colour('--field');
    g.fillRect(x0, y0, x1 - x0, y1 - y0);
    g.strokeStyle = colour('--jump');
    g.setLineDash([]);
    g.lineWidth = 1;
    g.strokeRect(x0, y0, x1 - x0, y1 - y0);
  }

  function drawNumbers(g) {
    const taken = [];
    g.font = '600 11px system-ui,"DejaVu Sans",sans-serif';
    g.textBaseline = 'middle';
    pieces.forEach((p, i) => {
      const px = sx(p.x), py = sy(p.y), text = String(i + 1), w = g.measureText(text).width + 8;
      // Numbers that would lie on each other are left out until there is room.
      if (taken.some((q) => Math.abs(q[0] - px) < (q[2] + w) / 2 && Math.abs(q[1] - py) < 15)) return;
      taken.push([px, py, w]);
      g.fillStyle = colour('--bg');
      g.strokeStyle = colour('--mute');
      g.lineWidth = 1;
      g.beginPath();
      g.rect(px - w / 2, py - 7.5, w, 15);
      g.fill();
      g.stroke();
      g.fillStyle = colour('--fg');
      g.fillText(text, px - w / 2 + 4, py + 0.5);
    });
  }

  function draw() {
    const g = canvas.getContext('2d'), now = motion.at(state.t);
    g.clearRect(0, 0, state.width, state.height);
    drawField(g);
    for (const jump of [true, false]) {
      if (jump && !state.jumps) continue;
      g.beginPath();
      for (const o of outlines) {
        if (Boolean(o.jump) !== jump) continue;
        o.points.forEach(([px, py], i) => (i === 0 ? g.moveTo(sx(px), sy(py)) : g.lineTo(sx(px), sy(py))));
      }
      g.setLineDash(jump ? [2, 4] : []);
      g.lineWidth = jump ? 0.8 : 1.4;
      g.strokeStyle = colour(jump ? '--jump' : '--todo');
      g.globalAlpha = jump ? 0.55 : 1;
      g.stroke();
      g.globalAlpha = 1;
    }
    drawDone(Math.max(0, now.sample - 1));
    g.drawImage(done, 0, 0, state.width, state.height);
    const i = Math.max(0, now.sample - 1);
    g.setLineDash(now.on ? [] : [5, 4]);
    g.lineWidth = now.on ? 2.8 : 1.2;
    g.strokeStyle = now.on ? rampColour(motion.power[now.sample] / most) : colour('--jump');
    g.beginPath();
    g.moveTo(sx(motion.x[i]), sy(motion.y[i]));
    g.lineTo(sx(now.x), sy(now.y));
    g.stroke();
    if (state.numbers) drawNumbers(g);
    g.setLineDash([]);
    g.beginPath();
    g.arc(sx(now.x), sy(now.y), 6, 0, 2 * Math.PI);
    g.lineWidth = 2;
    g.strokeStyle = colour('--fg');
    g.stroke();
    if (now.on) {
      g.fillStyle = rampColour(motion.power[now.sample] / most);
      g.fill();
    }
  }

  // ---- list of lines: only those in sight are in the document
  const kRow = 20, list = $('list'), rows = $('rows');
  const step_at = new Map();
  motion.steps.forEach((s, k) => { if (!step_at.has(s.line)) step_at.set(s.line, k); });
  const jump_lines = new Set(job.segments.filter((s) => s[1]).map((s) => s[0]));
  rows.style.height = job.lines.length * kRow + 'px';

  function drawList(follow) {
    const now = motion.at(state.t), height = list.clientHeight || 400;
    if (follow) {
      const top = (now.line - 1) * kRow;
      if (top < list.scrollTop + kRow || top > list.scrollTop + height - 3 * kRow) list.scrollTop = top - height / 3;
    }
    const first = Math.max(0, Math.floor(list.scrollTop / kRow) - 5);
    const last = Math.min(job.lines.length, first + Math.ceil(height / kRow) + 12);
    const fragment = doc.createDocumentFragment();
    for (let i = first; i < last; ++i) {
      const row = doc.createElement('div'), number = doc.createElement('b'), k = step_at.get(i + 1);
      number.textContent = String(i + 1);
      row.className = 'row' + (k === undefined ? ' still' : jump_lines.has(i + 1) ? ' jump' : '') +
        (k !== undefined && motion.stepEnd_s(k) <= state.t + 1e-9 ? ' done' : '');
      row.id = 'line' + (i + 1);
      row.setAttribute('role', 'option');
      row.setAttribute('aria-selected', String(i + 1 === now.line));
      row.style.top = i * kRow + 'px';
      row.append(number, job.lines[i]);
      row.addEventListener('click', () => { if (k !== undefined) { pause(); seek(motion.stepStart_s(k) + 1e-7); } });
      fragment.append(row);
    }
    rows.replaceChildren(fragment);
    list.setAttribute('aria-activedescendant', 'line' + now.line);
  }

  // ---- transport
  const fixed = (v, d) => v.toFixed(d);
  function show(follow = true) {
    const now = motion.at(state.t), end = motion.at(motion.duration_s);
    $('scrub').value = String(state.t);
    $('scrub').setAttribute('aria-valuetext', `${fixed(state.t, 3)} s, line ${now.line}`);
    $('time').textContent = `${fixed(state.t, 3)} / ${fixed(motion.duration_s, 3)} s`;
    $('r-line').textContent = `${now.line}: ${(job.lines[now.line - 1] || '').trim()}`;
    $('r-state').textContent = now.on ? 'cuts' : now.speed_mm_s > 0 ? 'jumps' : 'waits';
    $('r-power').textContent = `${fixed(now.power_w, 1)} W of ${job.full_power_w} W`;
    $('r-speed').textContent = `${fixed(now.speed_mm_s, 1)} mm/s`;
    $('r-place').textContent = `${fixed(now.x, 3)}, ${fixed(now.y, 3)} mm`;
    $('r-cut').textContent = `${fixed(now.cut_mm, 1)} of ${fixed(end.cut_mm, 1)} mm`;
    $('r-jump').textContent = `${fixed(now.jump_mm, 1)} of ${fixed(end.jump_mm, 1)} mm`;
    draw();
    drawList(follow);
  }
  function seek(t_s) {
    state.t = Math.min(Math.max(t_s, 0), motion.duration_s);
    show();
  }
  let last_ms = 0;
  function tick(ms) {
    if (!state.playing) return;
    state.t += Math.max(0, ms - last_ms) / 1000 * speed;
    last_ms = ms;
    if (state.t >= motion.duration_s) {
      state.t = motion.duration_s;
      pause();
    }
    show();
    win.requestAnimationFrame(tick);
  }
  function pause() {
    state.playing = false;
    $('play').textContent = '▶ Play';
    $('play').setAttribute('aria-pressed', 'false');
  }
  function play() {
    if (state.t >= motion.duration_s) state.t = 0;
    state.playing = true;
    $('play').textContent = '❚❚ Pause';
    $('play').setAttribute('aria-pressed', 'true');
    win.requestAnimationFrame((ms) => { last_ms = ms; tick(ms); });
  }
  function step(sense) {
    pause();
    seek(nextStop(motion, state.t, sense));
  }
  function setSpeed(value) {
    speed = value;
    $('speed').value = String(value);
  }
  function toggle(what) {
    state[what] = !state[what];
    $(what).setAttribute('aria-pressed', String(state[what]));
    state.drawn = -1;
    draw();
  }
  function zoom(factor, px, py) {
    state.moved = true;
    state.dx = px + (state.dx - px) * factor;
    state.dy = py + (state.dy - py) * factor;
    state.scale *= factor;
    state.drawn = -1;
    draw();
  }

  for (const v of kSpeeds) {
    const option = doc.createElement('option');
    option.value = String(v);
    option.textContent = v + ' ×';
    $('speed').append(option);
  }
  setSpeed(speed);
  $('scrub').max = String(motion.duration_s);
  $('scrub').addEventListener('input', () => { pause(); seek(Number($('scrub').value)); });
  $('play').addEventListener('click', () => (state.playing ? pause() : play()));
  $('back').addEventListener('click', () => step(-1));
  $('on').addEventListener('click', () => step(1));
  $('first').addEventListener('click', () => { pause(); seek(0); });
  $('last').addEventListener('click', () => { pause(); seek(motion.duration_s); });
  $('speed').addEventListener('change', () => setSpeed(Number($('speed').value)));
  $('jumps').addEventListener('click', () => toggle('jumps'));
  $('numbers').addEventListener('click', () => toggle('numbers'));
  $('fit').addEventListener('click', () => { state.moved = false; fit(); });
  list.addEventListener('scroll', () => drawList(false));
  const keys = {
    ' ': () => (state.playing ? pause() : play()),
    ArrowRight: (e) => { if (e.shiftKey) { pause(); seek(state.t + job.period_s); } else step(1); },
    ArrowLeft: (e) => { if (e.shiftKey) { pause(); seek(state.t - job.period_s); } else step(-1); },
    Home: () => { pause(); seek(0); },
    End: () => { pause(); seek(motion.duration_s); },
    '+': () => setSpeed(kSpeeds[Math.min(kSpeeds.indexOf(speed) + 1, kSpeeds.length - 1)]),
    '-': () => setSpeed(kSpeeds[Math.max(kSpeeds.indexOf(speed) - 1, 0)]),
    f: () => { state.moved = false; fit(); },
    j: () => toggle('jumps'),
    n: () => toggle('numbers'),
  };
  doc.addEventListener('keydown', (e) => {
    const act = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    const pressing = e.key === ' ' && e.target.tagName === 'BUTTON' && e.target.id !== 'play';
    if (!act || e.ctrlKey || e.altKey || e.metaKey || e.target.tagName === 'SELECT' || pressing) return;
    e.preventDefault();
    act(e);
  });
  canvas.addEventListener('wheel', (e) => {
    e.preventDefault();
    const r = canvas.getBoundingClientRect();
    zoom(Math.exp(-e.deltaY * 0.0015), e.clientX - r.left, e.clientY - r.top);
  }, {passive: false});
  let drag = null;
  canvas.addEventListener('pointerdown', (e) => { drag = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener('pointerup', () => { drag = null; });
  canvas.addEventListener('pointermove', (e) => {
    if (!drag) return;
    state.moved = true;
    state.dx += e.clientX - drag[0];
    state.dy += e.clientY - drag[1];
    drag = [e.clientX, e.clientY];
    state.drawn = -1;
    draw();
  });
  const ramp = [0, 0.25, 0.5, 0.75, 1].map((u) => rampColour(u)).join(',');
  $('ramp').style.background = `linear-gradient(90deg,${ramp})`;
  $('most').textContent = `${fixed(most / 255 * job.full_power_w, 1)} W`;
  win.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { state.drawn = -1; draw(); });
  win.addEventListener('resize', () => { resize(); show(); });
  // job.html#t=1.25 opens at 1.25 s.
  const fromHash = () => {
    const match = /^#t=([0-9.]+)$/.exec(win.location.hash);
    if (match) { pause(); seek(Number(match[1])); }
  };
  win.addEventListener('hashchange', fromHash);
  resize();
  show();
  fromHash();
}

if (typeof document !== 'undefined') startPage(document, window);
if (typeof module !== 'undefined') module.exports = {makeMotion, nextStop, rampColour, pointsOf, piecesOf};
