import type {Actuator, Marker} from './document';
import type {Place} from './robot';

interface Rows { lines: number[]; times: number[] | null }
/** A file that moves the robot: commands, as for softkin fk --path, or waypoints, as for softkin follow. */
export type PathFile = Rows & ({kind: 'commands'; rows: number[][]} | {kind: 'waypoints'; rows: Place[][]});
interface Table { header: number; columns: string[]; rows: number[][]; lines: number[] }

/** An error in a file, as one sentence for the user. */
export class PathError extends Error {}

const errorAt = (line: number, message: string): PathError => new PathError(`Line ${line}: ${message}`);
const listed = (names: string[]): string => names.slice(0, 6).join(', ') + (names.length > 6 ? ', …' : '');

function readTable(text: string): Table {
  const table: Table = {header: 0, columns: [], rows: [], lines: []};
  text.replace(/^\uFEFF/, '').split(/\r\n|\n|\r/).forEach((whole, n) => {
    const line = n + 1, trimmed = whole.trim();
    if (!trimmed || trimmed.startsWith('#')) return;
    if (!table.header && trimmed.includes(';'))
      throw errorAt(line, 'separate the cells by commas, not semicolons, and write numbers with a decimal point.');
    const cells = trimmed.split(',').map((cell) => cell.trim());
    if (!table.header) {
      const duplicate = cells.find((cell, i) => cells.indexOf(cell) < i);
      if (cells.every((cell) => cell !== '' && Number.isFinite(Number(cell))))
        throw errorAt(line, 'it holds numbers where columns should be named.');
      if (cells.includes('')) throw errorAt(line, `column ${cells.indexOf('') + 1} has no name.`);
      if (duplicate) throw errorAt(line, `column ${duplicate} appears twice.`);
      Object.assign(table, {header: line, columns: cells});
      return;
    }
    if (cells.length !== table.columns.length)
      throw errorAt(line, `it has ${cells.length} cells, but there are ${table.columns.length} columns.`);
    table.rows.push(cells.map((cell, c) => {
      const value = Number(cell);
      if (cell === '' || !Number.isFinite(value))
        throw errorAt(line, `column ${table.columns[c]} must hold a number, not "${cell.slice(0, 40)}".`);
      return value;
    }));
    table.lines.push(line);
  });
  if (!table.header) throw new PathError('The file is empty: a line of column names is needed.');
  if (!table.rows.length) throw errorAt(table.header, 'no row follows the names of the columns.');
  return table;
}

function readTimes({columns, rows, lines}: Table): number[] | null {
  const column = columns.indexOf('t_s');
  if (column < 0) return null;
  return rows.map((row, r) => {
    if (r > 0 && !(row[column] > rows[r - 1][column]))
      throw errorAt(lines[r], `column t_s must grow: ${row[column]} follows ${rows[r - 1][column]}.`);
    return row[column];
  });
}

/** Returns the names that the column of an actuator may have, such as magnet_Am2 for the unit A m^2. */
const namesOf = ({name, unit}: Actuator): string[] => unit ? [name, `${name}_${unit.replace(/[ ^]/g, '')}`] : [name];

/** Returns the value; throws PathError where it is outside the actuator's range. name: of the value, in the message */
export function inRange(value: number, {low, high, unit}: Actuator, line: number, name: string): number {
  if (value >= low && value <= high) return value;
  throw errorAt(line, `${name}: ${value} is outside its range, ${low} to ${high}${unit && ` ${unit}`}.`);
}

function readCommands(table: Table, actuators: Actuator[]): number[][] {
  const of = table.columns.map((column) => actuators.findIndex((actuator) => namesOf(actuator).includes(column)));
  of.forEach((a, c) => {
    const column = table.columns[c];
    if (a < 0 && column !== 't_s') throw errorAt(table.header, `column ${column} names no actuator; this robot has ` +
      `${listed(actuators.flatMap((actuator) => namesOf(actuator).slice(-1)))}, and t_s is the time.`);
    if (a >= 0 && of.indexOf(a) < c)
      throw errorAt(table.header, `column ${column}: another column is of that actuator.`);
  });
  return table.rows.map((row, r) => {
    const commands = actuators.map(({rest, low, high}) => Math.min(Math.max(rest, low), high));
    row.forEach((value, c) => {
      if (of[c] < 0) return;
      commands[of[c]] = inRange(value, actuators[of[c]], table.lines[r], `column ${table.columns[c]}`);
    });
    return commands;
  });
}

/** Returns the marker and axis of a column; null where it is not a coordinate. */
function coordinate(column: string): {marker: string; axis: number} | null {
  const found = /^(?:(.+)_)?([xyz])(_mm)?$/.exec(column);
  return found && {marker: found[1] ?? '', axis: 'xyz'.indexOf(found[2])};
}

function readWaypoints(table: Table, markers: Marker[]): Place[][] {
  const {header, columns} = table, names = markers.map(({name}) => name);
  const of = columns.map((column) => {
    const found = coordinate(column);
    if (!found) {
      if (column === 't_s') return null;
      throw errorAt(header, `column ${column} is no coordinate: x_mm, y_mm, z_mm, or ${names[0] ?? 'MARKER'}_x_mm, ….`);
    }
    if (!column.endsWith('_mm')) throw errorAt(header, `column ${column} lacks its unit: ${column}_mm.`);
    if (!found.marker && names.length !== 1)
      throw errorAt(header,
                    `column ${column}: of which marker? Write ${listed(names.map((name) => `${name}_${column}`))}.`);
    const marker = found.marker ? names.indexOf(found.marker) : 0;
    if (marker < 0)
      throw errorAt(header, `column ${column}: there is no marker ${found.marker}; this robot has ${listed(names)}.`);
    return {marker, axis: found.axis};
  });
  const used = [...new Set(of.flatMap((one) => one ? [one.marker] : []))];
  return table.rows.map((row) => used.map((marker): Place => ({
    marker,
    at: [0, 1, 2].map((axis) => {
      const c = of.findIndex((one) => one?.marker === marker && one.axis === axis);
      return c < 0 ? null : row[c];
    }),
  })));
}

/** Reads a file of commands or waypoints. Throws PathError. */
export function readPath(text: string, actuators: Actuator[], markers: Marker[]): PathFile {
  const table = readTable(text), {lines, columns} = table, times = readTimes(table);
  const names = actuators.flatMap(namesOf);
  const isPlace = !columns.some((column) => names.includes(column)) && columns.some((column) => coordinate(column));
  if (columns.every((column) => column === 't_s'))
    throw errorAt(table.header, 'no column names an actuator or a coordinate.');
  return isPlace ? {kind: 'waypoints', rows: readWaypoints(table, markers), lines, times}
    : {kind: 'commands', rows: readCommands(table, actuators), lines, times};
}
