// SPDX-License-Identifier: Apache-2.0
// Chromium through its DevTools protocol, over a pipe: no port, no package. Tests wait for what a page shows and never for a
// time; a limit only ends a wait that would never end.
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync, mkdirSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';

const kLimit_ms = Number(process.env.KERFBENCH_BROWSER_LIMIT_MS ?? 60000);

/** Path of Chromium, or null. */
export function findChromium() {
  for (const name of [process.env.KERFBENCH_CHROMIUM, 'chromium', 'chromium-browser', 'google-chrome'].filter(
    Boolean,
  )) {
    const found = spawnSync('sh', ['-c', 'command -v "$1"', 'sh', name], { encoding: 'utf8' });
    if (found.status === 0) return found.stdout.trim();
  }
  return null;
}

class Pipe {
  constructor(child) {
    this.out = child.stdio[3];
    this.waiting = new Map();
    this.listeners = new Set();
    this.next = 1;
    let rest = '';
    child.stdio[4].setEncoding('utf8');
    child.stdio[4].on('data', (part) => {
      const messages = (rest + part).split('\0');
      rest = messages.pop() ?? '';
      for (const text of messages) this.take(JSON.parse(text));
    });
    child.once('exit', () => {
      for (const { reject } of this.waiting.values()) reject(new Error('the browser has ended'));
      this.waiting.clear();
    });
  }
  take(message) {
    const call = this.waiting.get(message.id);
    if (call) {
      this.waiting.delete(message.id);
      if (message.error) call.reject(new Error(`${call.method}: ${message.error.message}`));
      else call.resolve(message.result);
      return;
    }
    for (const listener of this.listeners) listener(message);
  }
  send(method, params = {}, sessionId = undefined) {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, method });
      this.out.write(JSON.stringify({ id, method, params, sessionId }) + '\0');
    });
  }
}

const kKeys = {
  Enter: [13, '\r'],
  Tab: [9],
  Escape: [27],
  Space: [32, ' '],
  Backspace: [8],
  Delete: [46],
  Home: [36],
  End: [35],
  ',': [188, ','],
  '.': [190, '.'],
  PageUp: [33],
  PageDown: [34],
  ArrowLeft: [37],
  ArrowUp: [38],
  ArrowRight: [39],
  ArrowDown: [40],
};

/** One page of the browser. */
export class Page {
  constructor(pipe, sessionId) {
    this.pipe = pipe;
    this.sessionId = sessionId;
    this.errors = [];
    this.requests = [];
    pipe.listeners.add((message) => {
      if (message.sessionId !== sessionId) return;
      const { method, params } = message;
      if (method === 'Runtime.exceptionThrown') {
        const { exceptionDetails: d } = params;
        this.errors.push(d.exception?.description ?? d.text);
      }
      if (method === 'Log.entryAdded' && params.entry.level === 'error')
        this.errors.push(`${params.entry.text} ${params.entry.url ?? ''}`);
      if (method === 'Runtime.consoleAPICalled' && params.type === 'error')
        this.errors.push(params.args.map((a) => a.value ?? a.description).join(' '));
      if (method === 'Network.requestWillBeSent') this.requests.push(params.request.url);
    });
  }

  send(method, params) {
    return this.pipe.send(method, params, this.sessionId);
  }

  /** Opens an address and waits for its load event. */
  async open(url) {
    const loaded = this.event('Page.loadEventFired');
    const { errorText } = await this.send('Page.navigate', { url });
    if (errorText) throw new Error(`${url}: ${errorText}`);
    await loaded;
  }

  /** The next event of this name. */
  event(name) {
    return new Promise((resolve, reject) => {
      const end = setTimeout(() => {
        this.pipe.listeners.delete(take);
        reject(new Error(`no ${name}`));
      }, kLimit_ms);
      const take = (message) => {
        if (message.sessionId !== this.sessionId || message.method !== name) return;
        clearTimeout(end);
        this.pipe.listeners.delete(take);
        resolve(message.params);
      };
      this.pipe.listeners.add(take);
    });
  }

  /** Calls a function in the page with these arguments (JSON) and gives its value. */
  async run(body, ...args) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', {
      expression: `(${body})(...${JSON.stringify(args)})`,
      awaitPromise: true,
      returnByValue: true,
      userGesture: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Waits until a function in the page gives something true, and gives it. */
  async until(body, ...args) {
    const end = Date.now() + kLimit_ms;
    for (;;) {
      const value = await this.run(
        `async (f, a) => { const g = eval('(' + f + ')'); let v = await g(...a);
        for (let i = 0; !v && i < 20; ++i) { await new Promise((r) => setTimeout(r, 25)); v = await g(...a); } return v; }`,
        String(body),
        args,
      );
      if (value) return value;
      if (Date.now() > end)
        throw new Error(
          `this never became true: ${body} ${JSON.stringify(args)}\n${(await this.text()).slice(0, 1500)}`,
        );
    }
  }

  /** The visible text of what a selector finds first; of the page without one. */
  text(selector = 'body') {
    return this.run('(s) => document.querySelector(s)?.innerText ?? null', selector);
  }

  /** Waits until a visible element's text has these words, or fits a pattern. */
  untilText(selector, words) {
    const [source, flags] =
      words instanceof RegExp ? [words.source, words.flags] : [words.replace(/[.*+?^${}()|[\]\\]/g, '\\$&'), ''];
    return this.until(
      `(s, source, flags) => [...document.querySelectorAll(s)].some((e) => e.checkVisibility() && new RegExp(source, flags).test(e.innerText ?? ''))`,
      selector,
      source,
      flags,
    );
  }

  /** Middle of an element in the window, after it was scrolled into view. `words`: the element whose text is or has this. */
  async place(selector, words = null) {
    const at = await this.until(
      `(s, words) => {
      const all = [...document.querySelectorAll(s)].filter((e) => e.checkVisibility());
      const of = (e) => (e.innerText || e.getAttribute('aria-label') || '').trim();
      const e = words === null ? all[0] : all.find((e) => of(e) === words) ?? all.find((e) => of(e).includes(words));
      if (!e || e.disabled) return null;
      e.scrollIntoView({block: 'nearest', behavior: 'instant'});
      const r = e.getBoundingClientRect();
      return r.width > 0 ? {x: r.x + r.width / 2, y: r.y + r.height / 2} : null;
    }`,
      selector,
      words,
    );
    return at;
  }

  async mouse(type, { x, y }, more = {}) {
    await this.send('Input.dispatchMouseEvent', {
      type,
      x,
      y,
      button: 'left',
      buttons: type === 'mouseReleased' ? 0 : 1,
      clickCount: 1,
      ...more,
    });
  }

  async clickAt(at, modifiers = 0) {
    await this.mouse('mouseMoved', at, { buttons: 0, button: 'none', modifiers });
    await this.mouse('mousePressed', at, { modifiers });
    await this.mouse('mouseReleased', at, { modifiers });
  }

  async click(selector, words = null, modifiers = 0) {
    await this.clickAt(await this.place(selector, words), modifiers);
  }

  async drag(from, to, steps = 6) {
    await this.mouse('mouseMoved', from, { buttons: 0, button: 'none' });
    await this.mouse('mousePressed', from);
    for (let i = 1; i <= steps; ++i)
      await this.mouse('mouseMoved', {
        x: from.x + ((to.x - from.x) * i) / steps,
        y: from.y + ((to.y - from.y) * i) / steps,
      });
    await this.mouse('mouseReleased', to);
  }

  /** A key by its name ('a', 'Enter', 'ArrowUp'). modifiers: 1 Alt, 2 Control, 4 Meta, 8 Shift. */
  async key(name, modifiers = 0) {
    const [code, text] = kKeys[name] ?? [name.toUpperCase().charCodeAt(0), modifiers & 6 ? undefined : name];
    const key = name === 'Space' ? ' ' : name;
    const common = {
      key,
      code: /^[a-z]$/i.test(name) ? `Key${name.toUpperCase()}` : name.length === 1 ? '' : name,
      windowsVirtualKeyCode: code,
      modifiers,
    };
    await this.send('Input.dispatchKeyEvent', { type: text ? 'keyDown' : 'rawKeyDown', text, ...common });
    await this.send('Input.dispatchKeyEvent', { type: 'keyUp', ...common });
  }

  type(text) {
    return this.send('Input.insertText', { text });
  }

  /** Replaces what a field holds and leaves it, as a user does. */
  async fillIn(selector, text) {
    await this.run('(s) => { const e = document.querySelector(s); e.focus(); e.select?.(); }', selector);
    await this.type(text);
    await this.key('Enter');
  }

  /** Chooses an option by its value or its text. */
  choose(selector, option) {
    return this.run(
      `(s, option) => { const e = document.querySelector(s);
      const o = [...e.options].find((o) => o.value === option || o.text === option);
      if (!o) throw new Error('no option ' + option + ' in ' + [...e.options].map((o) => o.value));
      e.value = o.value; e.dispatchEvent(new Event('input', {bubbles: true})); e.dispatchEvent(new Event('change', {bubbles: true})); }`,
      selector,
      option,
    );
  }

  /** Drops files from disk onto the middle of an element. */
  async drop(selector, files) {
    const at = await this.place(selector);
    const data = { items: [], files, dragOperationsMask: 1 };
    // Over the element twice: what the page shows for the drag may lie over it, and a drop needs a target that has said yes.
    for (const type of ['dragEnter', 'dragOver', 'dragOver', 'drop'])
      await this.send('Input.dispatchDragEvent', { type, ...at, data });
  }

  /** Size of the window, and what the user prefers. */
  async look({ width = 1440, height = 900, scale = 1, dark = false, still = false } = {}) {
    await this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: scale, mobile: false });
    await this.send('Emulation.setEmulatedMedia', {
      features: [
        { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' },
        { name: 'prefers-reduced-motion', value: still ? 'reduce' : 'no-preference' },
      ],
    });
  }

  /** Writes a PNG of the window. */
  async screenshot(path) {
    // Two frames, so that what was just changed is painted.
    await this.run('() => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))');
    const { data } = await this.send('Page.captureScreenshot', { format: 'png' });
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, Buffer.from(data, 'base64'));
  }
}

/**
 * Starts a headless browser with software GL and one page. `close()` ends it and removes its profile.
 */
export async function launch({ width = 1440, height = 900 } = {}) {
  const chromium = findChromium();
  if (!chromium) throw new Error('chromium is not installed');
  const profile = mkdtempSync(join(tmpdir(), 'kerfbench-browser-'));
  const child = spawn(
    chromium,
    [
      '--headless=new',
      '--no-sandbox',
      '--remote-debugging-pipe',
      `--user-data-dir=${profile}`,
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--disable-dev-shm-usage',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-extensions',
      '--hide-scrollbars',
      '--lang=en',
      '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1',
      `--window-size=${width},${height}`,
      'about:blank',
    ],
    { stdio: ['ignore', 'ignore', process.env.KERFBENCH_BROWSER_LOG ? 'inherit' : 'ignore', 'pipe', 'pipe'] },
  );
  const ended = new Promise((resolve) => child.once('exit', resolve));
  const pipe = new Pipe(child);
  async function newPage() {
    const { targetId } = await pipe.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await pipe.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(pipe, sessionId);
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await page.send(`${domain}.enable`);
    await page.look({ width, height });
    return page;
  }
  return {
    newPage,
    async close() {
      await pipe.send('Browser.close').catch(() => {});
      await ended;
      rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
    },
  };
}
