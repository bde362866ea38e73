// SPDX-License-Identifier: Apache-2.0
// What a job is made of: scenario, drawing, machine, release; and which process each layer of the drawing is.
// @ts-check
import { fill, h, keyed, mark, say, svg } from '../shared/dom.js';
import { watch } from '../shared/store.js';
import { nameInScenario, pathOfName } from './paths.js';
import * as S from './state.js';

export const kProcesses = ['cut', 'half-cut', 'crease', 'perforation', 'ignore'];
const kDash = { cut: '', 'half-cut': '6 2 1.5 2', crease: '5 2.5', perforation: '2 2', ignore: '1 3' };

/** The line by which a process is drawn, as a picture. @param {string} process */
export function swatch(process) {
  const line = svg('line', {
    x1: 0,
    y1: 6,
    x2: 18,
    y2: 6,
    stroke: `var(--${process}, var(--ignore))`,
    'stroke-dasharray': /** @type {any} */ (kDash)[process] ?? '',
  });
  return svg('svg', { class: 'swatch', viewBox: '0 0 18 12', 'aria-hidden': 'true' }, line);
}

const { baseName } = S;

/**
 * A select by groups: one's own files, then the examples. A value that no list has is shown as it is.
 * @param {HTMLSelectElement} select @param {{ value: string, text: string, shipped: boolean }[]} options @param {string} value @param {string} [hint]
 */
function fillSelect(select, options, value, hint = '') {
  const option = (/** @type {any} */ o) => h('option', { value: o.value }, o.text);
  const own = options.filter((o) => !o.shipped);
  const isFaulty = (/** @type {any} */ o) => /\/faults\/|\/fault-[^/]*$/.test(o.value);
  const shipped = options.filter((o) => o.shipped && !isFaulty(o));
  const faulty = options.filter((o) => o.shipped && isFaulty(o));
  const known = options.some((o) => o.value === value);
  fill(
    select,
    hint && h('option', { value: '' }, hint),
    !known && value !== '' && h('option', { value }, value),
    own.length > 0 && h('optgroup', { label: 'Yours, in this folder' }, own.map(option)),
    shipped.length > 0 && h('optgroup', { label: 'Examples, shipped with Kerfbench' }, shipped.map(option)),
    faulty.length > 0 && h('optgroup', { label: 'Examples with a known fault' }, faulty.map(option)),
  );
  select.value = value;
}

/** A path as it is told: shipped ones without the folder that all of a kind have. @param {string} path */
const shortPath = (path) => (S.isShipped(path) ? path.split('/').slice(2).join('/') || baseName(path) : path);

/** @param {{ path: string, title?: string }[]} list */
const optionsOf = (list) =>
  list.map((f) => ({
    value: f.path,
    shipped: S.isShipped(f.path),
    text: f.title ? `${shortPath(f.path)}: ${f.title}` : shortPath(f.path),
  }));

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function mountChoices(element, store, actions) {
  const box = h('div', { class: 'block' }, h('h2', {}, 'Job'));
  element.append(box);
  pickScenario(box, store, actions);
  pickDrawing(box, store, actions);
  pickMachine(box, store, actions);
  pickRelease(box, store, actions);
  box.append(loader(actions));
  mountLayers(element, store, actions);
}

/** @param {Element} box @param {string} id @param {string} label @param {(value: string) => void} chosen */
function pick(box, id, label, chosen) {
  const select = h('select', { id, on: { change: () => chosen(select.value) } });
  const fault = h('p', { class: 'fault', id: `${id}-fault`, role: 'status' });
  const row = h('div', { class: 'pick' }, h('label', { for: id }, label), select, fault);
  select.setAttribute('aria-describedby', fault.id);
  box.append(row);
  /** @param {string} words @param {boolean} [isWarning] */
  const wrong = (words, isWarning = false) => {
    say(fault, words);
    fault.hidden = words === '';
    fault.classList.toggle('warning', isWarning);
    mark(select, 'aria-invalid', words !== '' && !isWarning ? 'true' : null);
  };
  return { select, row, wrong };
}

/** @param {Element} box @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function pickScenario(box, store, actions) {
  const { select, wrong } = pick(box, 'scenario', 'Scenario', async (path) => {
    const { job } = store.get();
    if (S.isChanged(job) && !confirm(`${job?.path} is not saved. Leave it as it is in the file?`))
      select.value = job?.path ?? '';
    else if (path !== '') actions.open(path);
  });
  watch(
    store,
    (s) => [s.files, s.job?.path, s.check, s.reference],
    (s) => {
      fillSelect(select, optionsOf(s.files.scenarios), s.job?.path ?? '', s.job ? '' : 'Choose one…');
      const own = S.baseName(s.job?.path ?? '');
      const placeOf = (/** @type {any} */ i) =>
        i.file || i.line ? `${i.file || own}${i.line ? `, line ${i.line}` : ''}: ` : '';
      wrong(
        s.check.state === 'failed'
          ? (s.check.fault?.message ?? '')
          : S.unplaced(s)
              .map((i) => placeOf(i) + i.message)
              .join(' '),
      );
    },
  );
}

/** @param {import('./actions.js').Actions} actions */
function loader(actions) {
  const file = h('input', {
    type: 'file',
    id: 'file',
    multiple: true,
    class: 'visually-hidden',
    tabindex: -1,
    'aria-hidden': 'true',
    on: {
      change: () => {
        actions.take([...file.files]);
        file.value = '';
      },
    },
  });
  return h(
    'p',
    { class: 'drop-hint' },
    h('button', { id: 'load', on: { click: () => file.click() } }, 'Load a drawing…'),
    file,
    'or drop a DXF or SVG',
  );
}

/** @param {S.State} s @param {(key: string) => boolean} about */
const faultsAbout = (s, about) =>
  [...S.issuesByKey(s)]
    .filter(([key]) => about(key))
    .flatMap(([, issues]) => issues.map((i) => i.message))
    .concat(
      Object.entries(s.editFault)
        .filter(([key]) => about(key))
        .map(([, words]) => words),
    )
    .join(' ');

/** @param {Element} box @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function pickDrawing(box, store, actions) {
  const { select, row, wrong } = pick(box, 'drawing-file', 'Drawing', (path) => {
    const { job, session, check } = store.get();
    if (!job) return;
    const values = check.value?.values ?? {};
    const key = 'dieline.file' in values ? 'dieline.file' : 'dieline';
    actions.setKeys([{ path: key, value: nameInScenario(session, job.path, path) }]);
  });
  watch(
    store,
    (s) => [s.files, s.job, s.check, s.editFault],
    (s) => {
      row.hidden = !s.job;
      if (!s.job || !s.session) return;
      const values = s.check.value?.values ?? {};
      const name = s.check.value?.drawing?.file ?? values.dieline ?? values['dieline.file'] ?? '';
      const paths = s.files.drawings.map((/** @type {any} */ f) => f.path);
      fillSelect(
        select,
        optionsOf(s.files.drawings),
        paths.includes(name) ? name : pathOfName(s.session, s.job.path, String(name), paths),
      );
      const ofDrawing = (s.check.value?.issues ?? []).filter(
        (/** @type {any} */ i) =>
          (i.file ?? '') !== '' && (i.severity ?? 'error') === 'error' && !s.check.value?.drawing,
      );
      wrong(
        faultsAbout(s, (key) => key === 'dieline' || key === 'dieline.file') ||
          ofDrawing.map((/** @type {any} */ i) => `${i.file}${i.line ? `, line ${i.line}` : ''}: ${i.message}`).join(' '),
      );
    },
  );
  askUnit(box, store, actions);
}

/** Units that a drawing may be in, as people call them. @type {[string, string][]} */
const kUnits = [
  ['mm', 'mm'],
  ['px', 'px, 96 dpi'],
  ['pt', 'pt, 72 dpi'],
  ['in', 'inch'],
  ['cm', 'cm'],
];

/** Asks how long one unit is, where the drawing does not say it. @param {Element} box @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function askUnit(box, store, actions) {
  const size = h('p', { class: 'size', id: 'unit-size' });
  const radios = kUnits.map(([unit]) =>
    h('input', { type: 'radio', name: 'unit', value: unit, id: `unit-${unit}`, on: { change: () => void actions.place(unit) } }),
  );
  const question = h(
    'fieldset',
    { class: 'unit-question', id: 'unit-question', 'aria-describedby': 'unit-size', hidden: true },
    h('legend', {}, '1 unit of the drawing is'),
    h('div', { class: 'units' }, radios.map((radio, i) => h('label', {}, radio, kUnits[i][1]))),
    size,
  );
  box.append(question);
  watch(
    store,
    (s) => [s.check.value, s.job === null, s.job?.readOnly],
    (s) => {
      const unsaid = s.check.value?.drawing?.unsaid_unit;
      // A scenario that does not say it either is refused, and the answer mends it.
      const isRefused =
        !s.check.value?.drawing &&
        (s.check.value?.issues ?? []).some((/** @type {any} */ i) => /gives its size in px only/.test(i.message));
      question.hidden = !s.job || !(unsaid || isRefused);
      for (const radio of radios) radio.checked = radio.value === unsaid?.name;
      const [w, ht] = s.check.value?.drawing?.size_mm ?? [];
      say(
        size,
        unsaid
          ? `The file does not say it. So the drawing is ${w.toFixed(1)} × ${ht.toFixed(1)} mm.`
          : 'The file does not say it, nor does the scenario.',
      );
    },
  );
}

/** @param {Element} box @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function pickMachine(box, store, actions) {
  const { select, row, wrong } = pick(box, 'machine', 'Machine', (path) => {
    const { job, session } = store.get();
    if (job) actions.setKeys([{ path: 'machine', value: nameInScenario(session, job.path, path) }]);
  });
  watch(
    store,
    (s) => [s.files, s.job, s.check, s.editFault],
    (s) => {
      row.hidden = !s.job;
      if (!s.job || !s.session) return;
      const name = s.check.value?.machine?.file ?? s.check.value?.values?.machine ?? '';
      const paths = s.files.machines.map((/** @type {any} */ f) => f.path);
      const options = s.files.machines.map((/** @type {any} */ f) => ({
        value: f.path,
        text: f.name ?? baseName(f.path),
        shipped: S.isShipped(f.path),
      }));
      fillSelect(select, options, paths.includes(name) ? name : pathOfName(s.session, s.job.path, String(name), paths));
      const of = (/** @type {string} */ key) => key === 'machine';
      const isFault = 'machine' in s.editFault || (S.issuesByKey(s).get('machine') ?? []).some(S.isError);
      wrong(faultsAbout(s, of), !isFault);
    },
  );
}

/** Keys of the section `firmware` that belong to an image; the others (baud, lines) stay as they are. */
const kOfImage = ['source', 'image', 'mcu', 'clock_hz', 'baud'];

/**
 * What is set so that a scenario runs this image.
 * @param {{ path: string, mcu?: string, firmware?: Record<string, any> }} image @param {Record<string, any>} values of the scenario
 * @param {string} name as the scenario names the file
 */
export function releaseKeys(image, values, name) {
  /** @type {Record<string, any>} */
  const firmware = image.firmware ?? { image: name, ...(image.mcu ? { mcu: image.mcu } : {}) };
  return kOfImage
    .filter((key) =>
      key in firmware
        ? values[`firmware.${key}`] !== firmware[key]
        : image.firmware !== undefined && `firmware.${key}` in values,
    )
    .map((key) => ({ path: `firmware.${key}`, value: firmware[key] ?? null }));
}

/** @param {Element} box @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function pickRelease(box, store, actions) {
  const { select, row, wrong } = pick(box, 'release', 'Release', (path) => {
    const { job, session, files, check } = store.get();
    const image = files.images.find((/** @type {any} */ i) => i.path === path);
    if (!job || !image) return;
    const set = releaseKeys(image, check.value?.values ?? {}, nameInScenario(session, job.path, path));
    if (set.length > 0) actions.setKeys(set);
  });
  watch(
    store,
    (s) => [s.files, s.job, s.check, s.editFault],
    (s) => {
      row.hidden = !s.job;
      if (!s.job || !s.session) return;
      const values = s.check.value?.values ?? {};
      const name = String(values['firmware.image'] ?? '');
      const images = /** @type {any[]} */ (s.files.images);
      const found =
        images.find((i) => i.firmware?.image === name) ??
        images.find(
          (i) =>
            i.path ===
            pathOfName(
              s.session,
              s.job?.path ?? '',
              name,
              images.map((x) => x.path),
            ),
        );
      const options = images.map((i) => ({
        value: i.path,
        text: [i.title ?? shortPath(i.path), i.firmware?.mcu ?? i.mcu]
          .filter((word) => word && word !== 'native')
          .join(' · '),
        shipped: S.isShipped(i.path),
      }));
      fillSelect(
        select,
        options,
        found?.path ?? name,
        name === '' && !found ? (values['firmware.source'] ?? 'none') : '',
      );
      wrong(faultsAbout(s, (key) => key === 'firmware' || kOfImage.some((k) => key === `firmware.${k}`)));
    },
  );
}

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function mountLayers(element, store, actions) {
  const list = h('ul');
  const fault = h('p', { class: 'fault', role: 'status' });
  const box = h('div', { class: 'block' }, h('h2', {}, 'Layers'), list, fault);
  element.append(box);
  const make = (/** @type {any} */ layer) => {
    const select = h(
      'select',
      {
        'aria-label': `Process of layer ${layer.name}`,
        on: { change: () => actions.setKeys([{ path: ['layers', layer.name], value: select.value }]) },
      },
      kProcesses.map((p) => h('option', { value: p }, p)),
    );
    return h(
      'li',
      { class: 'layer' },
      h('span'),
      h('span', { class: 'name', title: layer.name }, layer.name),
      h('span', { class: 'count' }),
      select,
    );
  };
  const update = (/** @type {any} */ row, /** @type {any} */ layer) => {
    fill(row.children[0], swatch(layer.process));
    say(row.children[2], `${layer.count} · ${layer.length_mm.toFixed(0)} mm`);
    const select = row.children[3];
    if (!kProcesses.includes(layer.process) && select.options.length === kProcesses.length)
      select.append(h('option', { value: layer.process, disabled: true }, layer.process));
    select.value = layer.process;
  };
  watch(
    store,
    (s) => [s.check.value, s.job === null, s.editFault],
    (s) => {
      const layers = s.check.value?.drawing?.layers ?? [];
      box.hidden = !s.job || layers.length === 0;
      keyed(list, layers, (layer) => layer.name, make, update);
      const words = faultsAbout(s, (key) => key === 'layers' || key.startsWith('layers.'));
      say(fault, words);
      fault.hidden = words === '';
    },
  );
}
