// SPDX-License-Identifier: Apache-2.0
// CodeMirror as this page uses it: line numbers, what is wrong at its line, marked lines, and a text that can be set from outside
// without a loss of the place or of what can be undone.
// @ts-check
import { defaultKeymap, history, historyKeymap } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics } from '@codemirror/lint';
import { highlightSelectionMatches, search, searchKeymap } from '@codemirror/search';
import { Annotation, EditorState, RangeSet, StateEffect, StateField } from '@codemirror/state';
import {
  Decoration,
  EditorView,
  drawSelection,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
} from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { styleNonce } from '../shared/api.js';

/** Words of G-code: G and M, axes, Z as the laser, comments. */
const gcodeWords = StreamLanguage.define({
  name: 'gcode',
  token(stream) {
    if (stream.match(/^\([^)]*\)?/) || stream.match(/^;.*/)) return 'comment';
    if (stream.match(/^(LINE|ARC|CIRCLE)\b/)) return 'heading';
    if (stream.match(/^[GM]\s*\d+(\.\d+)?/i)) return 'keyword';
    if (stream.match(/^Z\s*[-+]?[\d.]+/i)) return 'atom';
    if (stream.match(/^[A-Z]/i)) return 'propertyName';
    if (stream.match(/^[-+]?[\d.]+/)) return 'number';
    stream.next();
    return null;
  },
});

const colours = HighlightStyle.define([
  { tag: tags.keyword, color: 'var(--acc)' },
  { tag: tags.heading, color: 'var(--mute)' },
  { tag: tags.atom, color: 'var(--half-cut)' },
  { tag: tags.comment, color: 'var(--mute)' },
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: 'var(--acc)' },
  { tag: [tags.string, tags.literal], color: 'var(--crease)' },
  { tag: tags.number, color: 'var(--fg)' },
]);

const look = EditorView.theme({
  '&': { color: 'var(--fg)', backgroundColor: 'var(--bg)', fontSize: '13px' },
  '.cm-content': { fontFamily: 'var(--mono)', caretColor: 'var(--fg)', padding: '6px 0' },
  '.cm-scroller': { fontFamily: 'var(--mono)', lineHeight: '1.55' },
  '.cm-gutters': { backgroundColor: 'var(--card)', color: 'var(--mute)', border: 'none' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'transparent' },
  '&.cm-focused .cm-activeLine': { backgroundColor: 'var(--card)' },
  '&.cm-focused': { outline: '2px solid var(--acc)', outlineOffset: '-2px' },
  '.cm-cursor': { borderLeftColor: 'var(--fg)' },
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground': {
    backgroundColor: 'var(--acc-soft)',
  },
  '.cm-line.of-chosen': { backgroundColor: 'var(--acc-soft)' },
  '.cm-line.of-now': { boxShadow: 'inset 3px 0 var(--acc)' },
  '.cm-tooltip, .cm-panels': { backgroundColor: 'var(--bg)', color: 'var(--fg)', border: '1px solid var(--line)' },
  '.cm-diagnostic-error': { borderLeftColor: 'var(--fail)' },
  '.cm-diagnostic-warning': { borderLeftColor: 'var(--np)' },
  '.cm-line.of-fault': { backgroundColor: 'var(--fail-soft)' },
  '.cm-fault-words': {
    color: 'var(--fail)',
    fontFamily: 'var(--sans)',
    whiteSpace: 'normal',
    padding: '0 6px 2px 6px',
  },
});

const fromOutside = Annotation.define();
/** @type {import('@codemirror/state').StateEffectType<Marks>} */
const setMarks = StateEffect.define();
/** Lines that are marked: chosen ones, the present one, faulty ones. */
const marks = StateField.define({
  create: () => Decoration.none,
  update(set, change) {
    let next = set.map(change.changes);
    for (const effect of change.effects) if (effect.is(setMarks)) next = decorationsOf(change.state, effect.value);
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** @typedef {{ chosen: number[], now: number | null, faults: number[] }} Marks lines, from 1 */

/** @param {EditorState} state @param {Marks} what */
function decorationsOf(state, { chosen, now, faults }) {
  const classes = new Map();
  const add = (/** @type {number | null} */ line, /** @type {string} */ name) => {
    if (line !== null && line >= 1 && line <= state.doc.lines)
      classes.set(line, `${classes.get(line) ?? ''} ${name}`.trim());
  };
  chosen.forEach((line) => add(line, 'of-chosen'));
  faults.forEach((line) => add(line, 'of-fault'));
  add(now, 'of-now');
  return RangeSet.of(
    [...classes]
      .sort((a, b) => a[0] - b[0])
      .map(([line, name]) => Decoration.line({ class: name }).range(state.doc.line(line).from)),
  );
}

/** The part in which two texts differ. @param {string} a @param {string} b @returns {{ from: number, to: number, insert: string } | null} */
export function difference(a, b) {
  if (a === b) return null;
  let from = 0;
  while (from < a.length && from < b.length && a[from] === b[from]) ++from;
  let end = 0;
  while (end < a.length - from && end < b.length - from && a[a.length - 1 - end] === b[b.length - 1 - end]) ++end;
  return { from, to: a.length - end, insert: b.slice(from, b.length - end) };
}

/**
 * @param {Element} parent
 * @param {{ label: string, language?: any, onText: (text: string) => void, onLine?: (line: number) => void }} options
 */
export function createEditor(parent, { label, language = gcodeWords, onText, onLine }) {
  let line = 0;
  const view = new EditorView({
    parent,
    state: EditorState.create({
      doc: '',
      extensions: [
        EditorView.cspNonce.of(styleNonce()),
        lineNumbers(),
        lintGutter(),
        history(),
        drawSelection(),
        highlightActiveLine(),
        highlightActiveLineGutter(),
        highlightSelectionMatches(),
        search({ top: true }),
        keymap.of([...searchKeymap, ...historyKeymap, ...defaultKeymap]),
        language,
        syntaxHighlighting(colours),
        look,
        marks,
        EditorView.lineWrapping,
        EditorView.contentAttributes.of({ 'aria-label': label, spellcheck: 'false' }),
        EditorView.updateListener.of((change) => {
          const outside = change.transactions.some((t) => t.annotation(fromOutside));
          if (change.docChanged && !outside) onText(change.state.doc.toString());
          const at = change.state.doc.lineAt(change.state.selection.main.head).number;
          if (at !== line && !outside && (change.selectionSet || change.docChanged) && change.view.hasFocus)
            onLine?.(at);
          line = at;
        }),
      ],
    }),
  });
  return {
    /** @param {string} text */
    setText(text) {
      const changes = difference(view.state.doc.toString(), text);
      if (changes) view.dispatch({ changes, annotations: fromOutside.of(true) });
    },
    /** @param {Marks} what */
    mark(what) {
      view.dispatch({ effects: setMarks.of(what) });
    },
    /** @param {{ line: number, column?: number, message: string, severity?: string }[]} issues */
    setIssues(issues) {
      const { doc } = view.state;
      view.dispatch(
        setDiagnostics(
          view.state,
          issues
            .filter((i) => i.line >= 1 && i.line <= doc.lines)
            .map((i) => {
              const at = doc.line(i.line);
              return {
                from: at.from,
                to: at.to,
                severity: i.severity === 'warning' ? 'warning' : 'error',
                message: i.message,
              };
            }),
        ),
      );
    },
    /** Brings a line into view, where nobody types. @param {number} number */
    show(number) {
      if (view.hasFocus || number < 1 || number > view.state.doc.lines) return;
      const at = view.state.doc.line(number).from;
      view.dispatch({
        effects: EditorView.scrollIntoView(at, { y: 'nearest', yMargin: 40 }),
        annotations: fromOutside.of(true),
      });
    },
    focus: () => view.focus(),
    view,
  };
}
