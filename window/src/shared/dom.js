// SPDX-License-Identifier: Apache-2.0
// Elements without markup: a text is always a text node, whatever a file or a server put into it. Nothing in the window sets
// innerHTML; window/test/hostile.test.mjs looks for it.
// @ts-check

const kSvg = 'http://www.w3.org/2000/svg';

/** @typedef {Node | string | number | false | null | undefined} Child */

function put(
  /** @type {Element} */ element,
  /** @type {Record<string, any>} */ properties,
  /** @type {any[]} */ children,
) {
  for (const [name, value] of Object.entries(properties ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name === 'on') for (const [event, listener] of Object.entries(value)) element.addEventListener(event, listener);
    else if (name === 'value' || name === 'checked') /** @type {any} */ (element)[name] = value;
    else if (value === true) element.setAttribute(name, '');
    else element.setAttribute(name, String(value));
  }
  for (const child of children.flat(Infinity)) {
    if (child === undefined || child === null || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
  return element;
}

/**
 * An HTML element. `on` holds listeners by event; `true` sets an attribute without a value, `false` and null leave it out.
 * @param {string} tag @param {Record<string, any>} [properties] @param {...(Child | Child[])} children
 * @returns {any}
 */
export const h = (tag, properties = {}, ...children) => put(document.createElement(tag), properties, children);

/**
 * The same for SVG.
 * @param {string} tag @param {Record<string, any>} [properties] @param {...(Child | Child[])} children
 * @returns {any}
 */
export const svg = (tag, properties = {}, ...children) =>
  put(document.createElementNS(kSvg, tag), properties, children);

/** Puts these children in place of what an element holds. @param {Element} element @param {...(Child | Child[])} children */
export function fill(element, ...children) {
  element.replaceChildren(
    ...children
      .flat(Infinity)
      .filter((child) => child !== undefined && child !== null && child !== false)
      .map((child) => (child instanceof Node ? child : String(child))),
  );
  return element;
}

/** Sets a text only where it differs, so that a live region speaks once. @param {Element} element @param {string | number} text */
export function say(element, text) {
  const words = String(text);
  if (element.textContent !== words) element.textContent = words;
}

/** Sets or removes an attribute. @param {Element} element @param {string} name @param {string | number | boolean | null | undefined} value */
export function mark(element, name, value) {
  if (value === false || value === null || value === undefined) element.removeAttribute(name);
  else {
    const words = value === true ? '' : String(value);
    if (element.getAttribute(name) !== words) element.setAttribute(name, words);
  }
}

/**
 * Makes the children of `container` those of `items`, by key: an element whose key is still there stays, and so does the focus
 * in it.
 * @template T
 * @param {Element} container @param {T[]} items @param {(item: T, index: number) => string | number} keyOf
 * @param {(item: T) => Element} make @param {(element: any, item: T, index: number) => void} [update]
 */
export function keyed(container, items, keyOf, make, update) {
  /** @type {Map<string, Element>} */
  const known = /** @type {any} */ (container).keyedChildren ?? new Map();
  const next = new Map();
  items.forEach((item, index) => {
    const key = String(keyOf(item, index));
    const element = known.get(key) ?? make(item);
    update?.(element, item, index);
    next.set(key, element);
  });
  for (const [key, element] of known) if (next.get(key) !== element) element.remove();
  let place = container.firstElementChild;
  for (const element of next.values()) {
    if (element === place) place = element.nextElementSibling;
    else container.insertBefore(element, place);
  }
  /** @type {any} */ (container).keyedChildren = next;
}
