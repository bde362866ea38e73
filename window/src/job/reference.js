// SPDX-License-Identifier: Apache-2.0
// The parameters of a scenario, as /api/reference describes them and as a scenario sets them.
// @ts-check

/** @typedef {{ key: string, path: string, range: string, kind: string, count: number, least: number | null, most: number | null,
 *   choices: string[], or_file: boolean, or_list: boolean, or_section: boolean, default: string, required: boolean, unit: string,
 *   help_html: string }} Key */
/** @typedef {{ title: string, help_html?: string, prefixes: string[], keys: Key[] }} Section */

/** Keys that the page shows elsewhere, with more than a field. */
const kElsewhere = new Set([
  'extends',
  'version',
  'machine',
  'dieline',
  'dieline.file',
  'layers',
  'firmware.source',
  'firmware.image',
  'firmware.mcu',
  'planner.gcode',
  'planner.order',
  'name',
  'title',
]);

/** Is it an element of a list, such as print.marks[].x_mm? @param {Key} key */
export const ofList = (key) => key.path.includes('[]');

/**
 * Sections with the keys that have a value, in the order of the reference.
 * @param {Section[]} sections @param {Record<string, any>} values flat, path → value
 * @returns {{ title: string, keys: Key[] }[]}
 */
export function setKeys(sections, values) {
  return sections
    .map(({ title, keys }) => ({
      title,
      keys: keys.filter((key) => !kElsewhere.has(key.path) && !ofList(key) && isSet(values, key)),
    }))
    .filter(({ keys }) => keys.length > 0);
}

/** @param {Record<string, any>} values @param {Key} key */
export const isSet = (values, key) =>
  key.path in values ||
  ((key.kind === 'list' || key.kind === 'section' || key.or_list || key.or_section) &&
    Object.keys(values).some((path) => path.startsWith(`${key.path}[`) || path.startsWith(`${key.path}.`)));

/**
 * Keys that could be added and fit all words that are searched for, the best first: in the name before the help.
 * @param {Section[]} sections @param {Record<string, any>} values @param {string} words @param {number} [most]
 * @returns {Key[]}
 */
export function addable(sections, values, words, most = 40) {
  const asked = words
    .toLowerCase()
    .split(/[\s.]+/)
    .filter(Boolean);
  const rank = (/** @type {Key} */ key) => {
    const name = key.path.toLowerCase();
    const help = plainWords(key.help_html).toLowerCase();
    let sum = 0;
    for (const word of asked) {
      if (name.split(/[._]/).some((part) => part.startsWith(word))) sum += 0;
      else if (name.includes(word)) sum += 1;
      else if (help.includes(word)) sum += 3;
      else return Infinity;
    }
    return sum;
  };
  return sections
    .flatMap((section) => section.keys)
    .filter(
      (key) =>
        !kElsewhere.has(key.path) &&
        !ofList(key) &&
        !isSet(values, key) &&
        key.kind !== 'section' &&
        key.kind !== 'list',
    )
    .map((key, place) => ({ key, place, rank: rank(key) }))
    .filter((found) => found.rank < Infinity)
    .sort((a, b) => a.rank - b.rank || a.place - b.place)
    .slice(0, most)
    .map(({ key }) => key);
}

/** Words of a help text, without its tags. @param {string} help_html */
export const plainWords = (help_html) =>
  (help_html ?? '')
    .replace(/<[^>]*>/g, '')
    .replace(/&lt;/g, '<')
    .replace(/&gt;/g, '>')
    .replace(/&quot;/g, '"')
    .replace(/&#39;/g, "'")
    .replace(/&amp;/g, '&');

/** @param {any} value @returns {string} as a field shows it */
export function fieldText(value) {
  if (value === null || value === undefined) return '';
  if (Array.isArray(value)) return value.map(fieldText).join(', ');
  return typeof value === 'object' ? JSON.stringify(value) : String(value);
}

const words = (/** @type {number | null} */ n) => (n === null || n === undefined ? '' : String(n));

/** @param {Key} key */
export function rangeWords(key) {
  if (key.kind !== 'number' && key.kind !== 'numbers') return '';
  if (key.least === null || key.most === null || key.least === undefined || key.most === undefined)
    return key.range ?? '';
  return `${words(key.least)} … ${words(key.most)}`;
}

/**
 * What is entered in a field as a value, or what is wrong with it in a sentence.
 * @param {Key} key @param {string} text
 * @returns {{ value: any } | { fault: string }}
 */
export function parsed(key, text) {
  const entered = text.trim();
  if (key.kind === 'flag') return { value: entered === 'true' };
  if (entered === '')
    return { fault: key.required ? 'A value is required here.' : 'Enter a value, or remove the parameter.' };
  if (key.kind === 'choice')
    return key.choices.includes(entered) || key.or_file
      ? { value: entered }
      : { fault: `One of ${key.choices.join(', ')}.` };
  if (key.kind === 'number') return number(key, entered);
  if (key.kind !== 'numbers') return { value: entered };
  const list = entered
    .replace(/^\[|\]$/g, '')
    .split(/[,;\s]+/)
    .filter(Boolean)
    .map((part) => number(key, part));
  const wrong = list.find((one) => 'fault' in one);
  if (wrong) return wrong;
  if (key.count > 1 && list.length !== key.count) return { fault: `${key.count} numbers, with commas between them.` };
  return { value: list.map((one) => /** @type {any} */ (one).value) };
}

/** @param {Key} key @param {string} text @returns {{ value: number } | { fault: string }} */
function number(key, text) {
  // A decimal comma is how many people write it.
  const value = Number(/^[-+]?\d+,\d+$/.test(text) ? text.replace(',', '.') : text);
  if (!Number.isFinite(value)) return { fault: `“${text}” is not a number.` };
  const unit = key.unit ? ` ${key.unit}` : '';
  if (key.least !== null && key.least !== undefined && value < key.least)
    return { fault: `At least ${key.least}${unit}.` };
  if (key.most !== null && key.most !== undefined && value > key.most) return { fault: `At most ${key.most}${unit}.` };
  return { value };
}

/** The value that a parameter begins with when it is added: its default where that is one. @param {Key} key */
export function firstValue(key) {
  const said = (key.default ?? '').replace(/[`\u00a0]/g, '').trim();
  if (key.kind === 'flag') return said === 'true' ? false : true;
  if (key.kind === 'number') {
    const value = Number(said);
    if (said !== '' && Number.isFinite(value)) return value;
    return key.least !== null && key.least !== undefined ? key.least : 0;
  }
  if (key.kind === 'numbers') return Array.from({ length: key.count || 1 }, () => Math.max(0, key.least ?? 0));
  if (key.kind === 'choice') return key.choices.includes(said) ? said : (key.choices[0] ?? '');
  return '';
}

/** A name for people: "mark_speed_mm_s" → "mark speed". @param {Key} key */
export function label(key) {
  const last = key.path.split('.').slice(-1)[0];
  const suffixes = [
    'mm_s3',
    'mm_s2',
    'mm_s',
    'j_per_mm',
    'j_mm2',
    'j_mm',
    'mm',
    'ms',
    'us',
    'um',
    'deg',
    'hz',
    'ppm',
    'w',
    's',
  ];
  const suffix = suffixes.find((s) => key.unit && last.endsWith(`_${s}`));
  return (suffix ? last.slice(0, -suffix.length - 1) : last).replace(/_/g, ' ');
}
