// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Searches in ascending lists of numbers.

/** @typedef {ArrayLike<number>} Ascending */

/**
 * Number of entries that are less than or equal to a value: the last of them is one before.
 * @param {Ascending} values @param {number} value
 */
export function countUpTo(values, value) {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (values[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * Number of entries that are less than a value.
 * @param {Ascending} values @param {number} value
 */
export function countBefore(values, value) {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * Value of a column at a time, on the straight line between its neighbours; NaN outside of the times and beside a gap.
 * @param {Ascending} times @param {Ascending} column @param {number} t
 */
export function valueAt(times, column, t) {
  const after = countUpTo(times, t);
  if (after === 0) return NaN;
  if (after === times.length) return t === times[after - 1] ? column[after - 1] : NaN;
  const share = (t - times[after - 1]) / (times[after] - times[after - 1]);
  if (share === 0) return column[after - 1];
  return column[after - 1] + share * (column[after] - column[after - 1]);
}
