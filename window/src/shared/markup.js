// SPDX-License-Identifier: Apache-2.0
// The help texts of the reference come as a small part of HTML. They are rebuilt from a list of allowed tags, with text as text: what
// is not on the list is shown as it is written, and does nothing.
// @ts-check
import { h } from './dom.js';

const kTags = new Set(['code', 'em', 'strong', 'p', 'ul', 'ol', 'li', 'pre', 'a']);
const kEntities = { amp: '&', lt: '<', gt: '>', quot: '"', '#39': "'", nbsp: '\u00a0' };

/** @typedef {{ tag: string, href?: string, children: Node_[] } | string} Node_ */

/** @param {string} text */
const plain = (text) => text.replace(/&(amp|lt|gt|quot|#39|nbsp);/g, (_, name) => /** @type {any} */ (kEntities)[name]);

/** A link of the reference: a page of it or a heading, never another protocol. @param {string} attributes */
function hrefOf(attributes) {
  const found = /\bhref=(?:"([^"]*)"|'([^']*)')/.exec(attributes);
  const href = plain(found?.[1] ?? found?.[2] ?? '');
  return /^[\w./-]*(#[\w.-]*)?$/.test(href) && !href.startsWith('//') ? href : '';
}

/** @param {string} html @returns {Node_[]} */
export function parseMarkup(html) {
  /** @type {{ tag: string, href?: string, children: Node_[] }} */
  const root = { tag: '', children: [] };
  const open = [root];
  const put = (/** @type {Node_} */ node) => open[open.length - 1].children.push(node);
  const pattern = /<(\/?)([a-zA-Z0-9]+)((?:\s[^<>]*)?)>/g;
  let from = 0;
  for (let found = pattern.exec(html); found; found = pattern.exec(html)) {
    const [whole, closing, name, attributes] = found;
    const tag = name.toLowerCase();
    if (found.index > from) put(plain(html.slice(from, found.index)));
    from = found.index + whole.length;
    if (!kTags.has(tag)) put(whole);
    else if (closing) {
      const at = open.map((o) => o.tag).lastIndexOf(tag);
      if (at > 0) open.length = at;
    } else {
      const node = { tag, children: [], ...(tag === 'a' ? { href: hrefOf(attributes) } : {}) };
      put(node);
      open.push(node);
    }
  }
  if (from < html.length) put(plain(html.slice(from)));
  return root.children;
}

/** @param {string} html @param {(href: string) => string} [link] where a link of the reference leads; empty: it becomes text
 * @returns {Node[]} */
export function markup(html, link = () => '') {
  /** @type {(node: Node_) => Node} */
  const build = (node) => {
    if (typeof node === 'string') return document.createTextNode(node);
    const children = node.children.map(build);
    if (node.tag !== 'a') return h(node.tag, {}, children);
    const href = node.href ? link(node.href) : '';
    return href ? h('a', { href, target: '_blank', rel: 'noreferrer' }, children) : h('span', {}, children);
  };
  return parseMarkup(html).map(build);
}
