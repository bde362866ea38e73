// SPDX-License-Identifier: Apache-2.0
// The order of the cuts as a list that people move about in.
// @ts-check

/**
 * Takes the items out and puts them, in their own order, before the place `to` of the list as it was.
 * @param {number[]} order @param {number[]} ids what is moved @param {number} to 0 … order.length
 * @returns {number[]}
 */
export function moved(order, ids, to) {
  const taken = new Set(ids);
  const before = order.slice(0, to).filter((id) => !taken.has(id));
  const after = order.slice(to).filter((id) => !taken.has(id));
  return [...before, ...order.filter((id) => taken.has(id)), ...after];
}

/**
 * One place up or down, as a block: what is moved stays together.
 * @param {number[]} order @param {number[]} ids @param {-1 | 1} sense @returns {number[]}
 */
export function nudged(order, ids, sense) {
  const places = order.map((id, i) => (ids.includes(id) ? i : -1)).filter((i) => i >= 0);
  if (places.length === 0) return order;
  const to = sense < 0 ? Math.max(places[0] - 1, 0) : Math.min(places[places.length - 1] + 2, order.length);
  return moved(order, ids, to);
}

/** Ids as `lint` writes them: [3, 5, 6, 7] is "3,5-7". @param {number[]} ids */
export function idWords(ids) {
  const parts = [];
  for (let i = 0; i < ids.length;) {
    let k = i;
    while (k + 1 < ids.length && ids[k + 1] === ids[k] + 1) ++k;
    parts.push(k - i >= 2 ? `${ids[i]}-${ids[k]}` : ids.slice(i, k + 1).join(','));
    i = k + 1;
  }
  return parts.join(',');
}
