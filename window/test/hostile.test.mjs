// SPDX-License-Identifier: Apache-2.0
// Names from drawings, and help that somebody could have changed, are data.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { parseMarkup } from '../src/shared/markup.js';

const source = fileURLToPath(new URL('../src/', import.meta.url));
const modules = readdirSync(source, { recursive: true })
  .filter((name) => name.endsWith('.js'))
  .map((name) => join(source, name));

test('no module makes markup or code of a text', () => {
  assert.ok(modules.length > 20);
  for (const file of modules) {
    const text = readFileSync(file, 'utf8').replace(/^\s*(\/\/|\*|\/\*).*$/gm, '');
    for (const way of [
      /\.innerHTML\b/,
      /\.outerHTML\b/,
      /insertAdjacentHTML/,
      /document\.write/,
      /\beval\(/,
      /new Function\b/,
      /createContextualFragment/,
      /srcdoc/,
      /setTimeout\(\s*['"`]/,
    ])
      assert.doesNotMatch(text, way, file);
  }
});

const words = (nodes) => nodes.map((n) => (typeof n === 'string' ? n : words(n.children))).join('');
const tags = (nodes) => nodes.flatMap((n) => (typeof n === 'string' ? [] : [n.tag, ...tags(n.children)]));

test('help has its own tags alone; all others stay text', () => {
  const nodes = parseMarkup(
    'Half the <code>kerf</code>, <b onclick="x()">bold</b> <script>alert(1)</script><img src=x onerror=y> &lt;i&gt; &amp;lt;',
  );
  assert.deepEqual(tags(nodes), ['code']);
  assert.equal(
    words(nodes),
    'Half the kerf, <b onclick="x()">bold</b> <script>alert(1)</script><img src=x onerror=y> <i> &lt;',
  );
});

test('links of help lead within the reference', () => {
  const href = (html) => parseMarkup(html).find((n) => n.tag === 'a').href;
  assert.equal(href('<a href="machine.md">x</a>'), 'machine.md');
  assert.equal(href('<a href="../how-to/my-firmware.md#a-b">x</a>'), '../how-to/my-firmware.md#a-b');
  for (const bad of [
    'javascript:alert(1)',
    '//elsewhere.example/x',
    'https://elsewhere.example',
    'data:text/html,x',
    '&#106;avascript:x',
    'java\tscript:x',
  ])
    assert.equal(href(`<a href="${bad}">x</a>`), '', bad);
});

test('tags that are not closed, or closed twice, lose no words', () => {
  const cases = {
    '<ul><li>a<li>b': 'ab',
    '</p>a</p>': 'a',
    '<p>a': 'a',
    'a < b > c': 'a < b > c',
    '<': '<',
    '<code': '<code',
    '<a href="x>y</a>': 'y',
  };
  for (const [html, left] of Object.entries(cases)) assert.equal(words(parseMarkup(html)), left);
});
