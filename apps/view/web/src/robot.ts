import type {RobotDocument, Step, Told} from './document';
import type {Estimate} from './estimate';
import type {Frame} from './frame';
import type {Goal} from './inverse';
import type {Ask} from './live';
import {KinematicMap, type MapDocument} from './map';
import {measured} from './words';

/** What is shown: a step of the run (step: its number, else -1), an answer of the map or of the running program. */
export interface Pose {
  commands: number[]; loads: (number | null)[]; measures: (number | null)[]; markers: number[][];
  positions: Float32Array; fields: Record<string, Float32Array>; step: number;
  from: 'rest' | 'step' | 'map' | 'live'; told: Told | null;
}
/** errorMm: null while it is sought; why: of the running program, else empty. */
export interface Target { marker: number; at: number[]; errorMm: number | null; reached: boolean; why: string }
/** A place for a marker; coordinates that do not count are null. */
export interface Place { marker: number; at: (number | null)[] }
/** The running program, as the robot sees it. */
export interface Link { readonly state: {control: boolean}; readonly busy: boolean; send(ask: Ask): number }
interface Memory { commands: number[]; step: number; values: (number | null)[] }

/** The robot of a document, its commands, and what was before. */
export class Robot {
  map: KinematicMap | null = null;
  readonly steps: Step[];
  pose: Pose;
  /** What the user asks for; the pose follows. */
  commands: number[];
  target: Target | null = null;
  /** Commands of the map are outside what it covers. */
  outside = false;
  /** The marker that numbers and arrows are of. */
  selected = 0;
  /** Of a file that is played: the row shown; -1: none. */
  row = -1;
  link: Link | null = null;
  /** What was read, of the columns of which something is told; null: not read. */
  values: (number | null)[];
  /** What they told; null: nothing yet. */
  estimate: Estimate | null = null;
  onChange: () => void = () => {};
  private past: Memory[] = [];
  private loadOutputs: number[] = [];     // of each actuator, or -1
  private measureOutputs: number[] = [];  // the same
  private order: number[] = [];  // of each input of the map: its actuator
  private markerOutputs: number[] = [];

  constructor(readonly document: RobotDocument) {
    const {actuators, markers, rest} = document;
    this.takeMap(document.map);
    this.steps = document.live ? [] : document.steps;
    this.commands = actuators.map((a) => a.rest);
    this.values = document.live?.estimate?.columns.map(() => null) ?? [];
    const unknown = actuators.map(() => null);
    this.pose = {commands: this.commands, loads: unknown, measures: unknown, markers: markers.map((m) => m.at),
                 positions: rest, fields: {}, step: -1, from: 'rest', told: null};
    const first = document.live ? document.steps[0] : undefined;
    if (first) this.pose = {...first, step: -1, from: 'live', told: first};
  }

  /** Shapes of a map without modes of this surface can't be drawn: it is not taken. */
  takeMap(document: MapDocument | null): void {
    const {actuators, markers, rest} = this.document, map = document && new KinematicMap(document);
    const known = map?.inputs.map(({name}) => actuators.findIndex((actuator) => actuator.name === name)) ?? [];
    const fits = known.every((a) => a >= 0) &&
      map?.shape(map.inputs.map(({low, high}) => (low + high) / 2))?.length === rest.length;
    this.map = fits ? map : null;
    this.order = known;
    this.markerOutputs = markers.map(({name}) => this.map?.markers.indexOf(name) ?? -1);
    const output = (...names: string[]) => this.map?.outputs.findIndex(({name}) => names.includes(name)) ?? -1;
    this.loadOutputs = actuators.map(({name, load_unit: unit}) => unit === '' ? -1
      : unit === measured || unit === 'mL' ? output(`${name}_ratio`) : output(`${name}_pressure`, `${name}_tension`));
    this.measureOutputs = actuators.map(({name, measure_unit: unit}) => unit === '' ? -1 : output(`${name}_ratio`));
  }

  /** As the page opens; the map has the equilibrium at rest under the loads of the scene. */
  rest(): void {
    const at = this.document.actuators.map((a) => Math.min(Math.max(a.rest, a.low), a.high));
    if (!this.link && this.map && this.ask(at)) this.command(at);
    else this.onChange();
  }

  /** Someone can move it here. */
  get able(): boolean { return this.link ? this.link.state.control : this.map !== null && !this.document.live; }

  /** What the map says, without showing it. */
  ask(commands: number[]): Omit<Pose, 'positions'> | null {
    const found = this.map?.fk(this.order.map((a) => commands[a]));
    if (!found || !this.map) return null;
    const {outputs} = found;
    const markers = this.markerOutputs.map((m, i) =>
      m < 0 ? this.document.markers[i].at : outputs.slice(3 * m, 3 * m + 3));
    const values = (of: number[]) => of.map((q) => q < 0 ? null : outputs[q]);
    const loads = values(this.loadOutputs).map((load, a) => load ?? this.commandedLoad(a, commands));
    return {commands, markers, loads, measures: values(this.measureOutputs), fields: {}, step: -1, from: 'map',
            told: null};
  }

  /** A tension or pressure that is commanded is none of the map's outputs. */
  private commandedLoad(actuator: number, commands: number[]): number | null {
    const {unit, load_unit: load} = this.document.actuators[actuator];
    return unit !== '' && unit === load ? commands[actuator] : null;
  }

  shapeAt(commands: number[]): Float32Array | null {
    return this.map?.shape(this.order.map((a) => commands[a])) ?? null;
  }

  remember(): void {
    const {commands, values, pose: {step}} = this, last = this.past.at(-1);
    const same = (a: (number | null)[], b: (number | null)[]) => a.every((value, i) => value === b[i]);
    if (last && last.step === step && same(last.commands, commands) && same(last.values, values)) return;
    this.past.push({commands: commands.slice(), step, values: values.slice()});
    if (this.past.length > 200) this.past.shift();
  }

  get canUndo(): boolean { return this.past.length > 0 && (this.link === null || this.able); }

  undo(): void {
    if (!this.canUndo) return;
    const last = this.past.pop() as Memory;
    this.values = last.values;
    if (last.step >= 0) this.showStep(last.step);
    else this.command(last.commands);
  }

  command(commands: number[], row = -1): void {
    this.target = null;
    this.row = row;
    const {values} = this;
    if (this.able && this.tells) this.link?.send({type: 'readings', commands: this.inRanges(commands), values});
    else if (this.able) this.link?.send({type: 'command', commands});
    this.move(commands);
  }

  /** What pushes it is told from readings. */
  get tells(): boolean { return Boolean(this.document.live?.estimate); }

  /** All that was read, told anew. */
  read(values: (number | null)[]): void {
    this.remember();
    this.values = values;
    this.command(this.commands);
  }

  /** Commands that are told may be a rounding outside of theirs. */
  private inRanges(commands: number[]): number[] {
    return this.document.actuators.map(({low, high}, a) => Math.min(Math.max(commands[a], low), high));
  }

  /** Shows what the map says. */
  private move(commands: number[]): void {
    this.commands = commands;
    const found = this.ask(commands), positions = this.shapeAt(commands);
    this.outside = this.map !== null && (!found || !positions);
    if (found && positions) this.pose = {...found, positions};
    else if (!this.link) this.pose = {...this.pose, commands, step: -1};
    this.onChange();
  }

  reset(): void {
    if (this.link && !this.able) return;
    this.remember();
    this.values = this.values.map(() => null);
    if (this.able) this.command(this.document.actuators.map((a) => Math.min(Math.max(a.rest, a.low), a.high)));
    else if (this.steps.length) this.showStep(0);
  }

  showStep(step: number): void {
    const of = this.steps[step];
    this.outside = false;
    this.target = null;
    this.row = -1;
    this.commands = of.commands;
    this.pose = {commands: of.commands, loads: of.loads, measures: of.measures, markers: of.markers,
                 positions: of.positions, fields: of.fields, step, from: 'step', told: of};
    this.onChange();
  }

  /** The actuators follow a marker that is dragged. */
  reach(marker: number, at: number[], row = -1): void {
    if (!this.able) return;
    this.row = row;
    const found = this.seek([{marker, at}]);
    if (!found && !this.link) return;
    const errorMm = found?.errorMm ?? null, reached = found?.reached ?? false;
    this.target = {marker, at, errorMm: this.link ? null : errorMm, reached: !this.link && reached, why: ''};
    this.link?.send({type: 'target', marker, at});
    this.move(found?.commands ?? this.commands);
  }

  /** Commands of the map, near those from which it starts, that bring markers nearest to their places. */
  seek(places: Place[], from = this.commands): {commands: number[]; errorMm: number; reached: boolean} | null {
    const {map} = this;
    if (!map || places.some(({marker}) => this.markerOutputs[marker] < 0)) return null;
    const now = this.order.map((a) => from[a]);
    const inside = map.fk(now) ? now : map.inputs.map(({low, high}) => (low + high) / 2);
    const goals = places.flatMap(({marker, at}): Goal[] => at.flatMap((value, k) =>
      value === null ? [] : [{output: 3 * this.markerOutputs[marker] + k, value}]));
    const found = map.lead(goals, inside);
    if (!found) return null;
    const commands = from.slice();
    this.order.forEach((a, i) => { commands[a] = found.commands[i]; });
    return {commands, errorMm: found.errorMm, reached: found.reached};
  }

  /** The running program has answered: newest, what was asked last; mine, something that was asked here. */
  answered(frame: Frame, mine: boolean, newest: boolean): void {
    const last = newest || this.link?.busy !== true;
    if (!last && !(mine && !this.map)) return;
    const {commands, loads, measures, markers, positions, fields, target} = frame;
    this.pose = {commands, loads, measures, markers, positions, fields, step: -1, from: 'live', told: frame};
    if (last) {
      this.commands = commands;
      this.outside = false;
      this.estimate = frame.estimate ?? null;
      if (!mine) this.showRead();
      this.target = target && {marker: target.marker, at: target.at, errorMm: target.error_mm,
                               reached: target.reached, why: target.why};
    }
    this.onChange();
  }

  /** What another window or a stream read, from what was told of it. */
  private showRead(): void {
    const {columns} = this.document.live?.estimate ?? {columns: []}, read = this.estimate?.readings;
    if (read) this.values = columns.map(({name}) => read.find(({column}) => column === name)?.read ?? null);
  }

  /** A rigid body goes where the robot pushes it: its center is no marker to be led somewhere. */
  canReach(marker: number): boolean {
    if (this.document.markers[marker]?.body || this.tells) return false;
    return this.link ? this.able : this.able && this.markerOutputs[marker] >= 0;
  }
}
