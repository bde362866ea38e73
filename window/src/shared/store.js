// SPDX-License-Identifier: Apache-2.0
// The one state of a page. It changes by pure functions from state to state; views look at it and never at each other.
// @ts-check

/**
 * @template S
 * @param {S} initial
 * @returns {{get: () => S, update: (change: (state: S) => S) => void, subscribe: (listener: (state: S, before: S) => void) => () => void}}
 */
export function createStore(initial) {
  let state = initial;
  /** @type {Set<(state: S, before: S) => void>} */
  const listeners = new Set();
  /** @type {((state: S) => S)[]} */
  const waiting = [];
  let telling = false;

  // A listener may ask for a change: it comes after all have seen the present one, so that nobody sees states out of order.
  function update(/** @type {(state: S) => S} */ change) {
    waiting.push(change);
    if (telling) return;
    telling = true;
    try {
      while (waiting.length > 0) {
        const before = state;
        state = /** @type {(state: S) => S} */ (waiting.shift())(before);
        if (state !== before) for (const listener of [...listeners]) listener(state, before);
      }
    } finally {
      telling = false;
      waiting.length = 0;
    }
  }

  return {
    get: () => state,
    update,
    subscribe(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
  };
}

/**
 * Calls `listener` only when what `pick` takes from the state is another one.
 * @template S, P
 * @param {{get: () => S, subscribe: (listener: (state: S, before: S) => void) => () => void}} store
 * @param {(state: S) => P[]} pick parts of the state, compared one by one by identity
 * @param {(state: S) => void} listener called at once, and at each change
 */
export function watch(store, pick, listener) {
  let seen = pick(store.get());
  listener(store.get());
  return store.subscribe((state) => {
    const parts = pick(state);
    if (parts.length === seen.length && parts.every((part, i) => Object.is(part, seen[i]))) return;
    seen = parts;
    listener(state);
  });
}
