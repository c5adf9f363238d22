import {byId, element} from './text';

/** A page that shows results next to each other, without a robot. */
export interface ComparisonDocument {
  softkin: string; command: string;
  comparison: {notes: string[]; tables: {caption: string; rows: string[][]}[]; plot: string};
}

export function readComparison(text: string): ComparisonDocument | null {
  const read = JSON.parse(text) as Partial<ComparisonDocument> | null;
  return read?.comparison ? read as ComparisonDocument : null;
}

function tableOf(caption: string, [titles, ...rows]: string[][]): HTMLElement {
  return element('section', {}, element('h2', {}, caption), element('div', {class: 'scrolled', tabindex: 0},
    element('table', {'aria-label': caption},
      element('thead', {}, element('tr', {}, ...titles.map((title) => element('th', {scope: 'col'}, title)))),
      element('tbody', {}, ...rows.map((row) => element('tr', {}, ...row.map((cell) => element('td', {}, cell))))))));
}

export function showComparison({softkin, command, comparison: {notes, tables, plot}}: ComparisonDocument): void {
  document.title = 'Comparison – softkin';
  byId('robot').textContent = 'Comparison';
  byId('about-robot').textContent = 'Results next to each other; lengths are in mm.';
  for (const id of ['undo', 'reset', 'snapshot']) byId(id).hidden = true;
  const main = document.querySelector('main');
  main?.classList.add('comparison');
  main?.replaceChildren(
    element('section', {}, ...notes.map((note) => element('p', {}, note))),
    element('section', {}, element('img', {
      src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(plot)}`,
      alt: 'Plot of the values in the tables below',
    })),
    ...tables.map(({caption, rows}) => tableOf(caption, rows)),
    element('section', {id: 'origin'}, element('h2', {}, 'How this was computed'),
            element('p', {},
                    `Computed by softkin ${softkin}, a finite-element program for soft robots, by the command`),
            element('code', {}, command)));
}
