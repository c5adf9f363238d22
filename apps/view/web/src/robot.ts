import type {RobotDocument, SolverReport, Step} from './document';
import type {Estimate} from './estimate';
import type {Frame} from './frame';
import type {Goal} from './inverse';
import type {LiveRequest} from './live';
import {KinematicMap, type MapDocument} from './map';
import {measured} from './words';

/** The shown state: a step of the run (step: its number, else -1), or a result of the map or of the running softkin.
    report: of the solver; null for a result of the map and for the reference shape. */
export interface Pose {
  commands: number[]; loads: (number | null)[]; measures: (number | null)[]; markers: number[][];
  positions: Float32Array; fields: Record<string, Float32Array>; step: number;
  from: 'rest' | 'step' | 'map' | 'live'; report: SolverReport | null;
}
/** errorMm: null during the search; why: the explanation of the running softkin, else empty. */
export interface Target { marker: number; at: number[]; errorMm: number | null; reached: boolean; why: string }
/** A desired position of a marker; free coordinates are null. */
export interface Place { marker: number; at: (number | null)[] }
/** The connection to the running softkin. */
export interface Link { readonly state: {control: boolean}; readonly busy: boolean; send(request: LiveRequest): number }
interface Memory { commands: number[]; step: number; values: (number | null)[] }

/** The robot of a document, with its commands and their history. */
export class Robot {
  map: KinematicMap | null = null;
  readonly steps: Step[];
  pose: Pose;
  /** The commands that the user requested; the pose follows. */
  commands: number[];
  target: Target | null = null;
  /** The commands are outside the map. */
  outside = false;
  /** The marker that has the arrows and the typed target. */
  selected = 0;
  /** The shown row of a played file; -1: none. */
  row = -1;
  link: Link | null = null;
  /** The readings, one for each column of the estimate; null: no reading. */
  values: (number | null)[];
  /** The estimate from the readings; null: none yet. */
  estimate: Estimate | null = null;
  onChange: () => void = () => {};
  private past: Memory[] = [];
  private loadOutputs: number[] = [];     // the map's output of each actuator's load, or -1
  private measureOutputs: number[] = [];  // the same for its measure
  private order: number[] = [];           // the actuator of each input of the map
  private markerOutputs: number[] = [];

  constructor(readonly document: RobotDocument) {
    const {actuators, markers, rest} = document;
    this.takeMap(document.map);
    this.steps = document.live ? [] : document.steps;
    this.commands = actuators.map((a) => a.rest);
    this.values = document.live?.estimate?.columns.map(() => null) ?? [];
    const unknown = actuators.map(() => null);
    this.pose = {commands: this.commands, loads: unknown, measures: unknown, markers: markers.map((m) => m.at),
                 positions: rest, fields: {}, step: -1, from: 'rest', report: null};
    const first = document.live ? document.steps[0] : undefined;
    if (first) this.pose = {...first, step: -1, from: 'live', report: first};
  }

  /** Uses a map, unless its inputs or its shape do not belong to this robot. */
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

  /** Shows the first state of the page: with a map, the equilibrium at the rest commands under the scene's loads. */
  rest(): void {
    const commands = this.restCommands();
    if (!this.link && this.map && this.evaluateMap(commands)) this.command(commands);
    else this.onChange();
  }

  /** Returns the rest commands, moved into the ranges. */
  private restCommands(): number[] {
    return this.document.actuators.map((a) => Math.min(Math.max(a.rest, a.low), a.high));
  }

  /** Returns whether the user can move the robot on this page. */
  get able(): boolean { return this.link ? this.link.state.control : this.map !== null && !this.document.live; }

  /** Evaluates the map without showing the result. */
  evaluateMap(commands: number[]): Omit<Pose, 'positions'> | null {
    const found = this.map?.fk(this.order.map((a) => commands[a]));
    if (!found || !this.map) return null;
    const {outputs} = found;
    const markers = this.markerOutputs.map((m, i) =>
      m < 0 ? this.document.markers[i].at : outputs.slice(3 * m, 3 * m + 3));
    const values = (of: number[]) => of.map((q) => q < 0 ? null : outputs[q]);
    const loads = values(this.loadOutputs).map((load, a) => load ?? this.commandedLoad(a, commands));
    return {commands, markers, loads, measures: values(this.measureOutputs), fields: {}, step: -1, from: 'map',
            report: null};
  }

  /** Returns a commanded tension or pressure, which is not among the map's outputs; else null. */
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
    if (this.able && this.isEstimating) this.link?.send({type: 'readings', commands: this.inRanges(commands), values});
    else if (this.able) this.link?.send({type: 'command', commands});
    this.move(commands);
  }

  /** Returns whether the page estimates forces from readings. */
  get isEstimating(): boolean { return Boolean(this.document.live?.estimate); }

  /** Replaces the readings and requests a new estimate. */
  setReadings(values: (number | null)[]): void {
    this.remember();
    this.values = values;
    this.command(this.commands);
  }

  /** Clamps the commands: estimated ones can be outside their ranges by rounding. */
  private inRanges(commands: number[]): number[] {
    return this.document.actuators.map(({low, high}, a) => Math.min(Math.max(commands[a], low), high));
  }

  /** Shows the shape of the map at the commands. */
  private move(commands: number[]): void {
    this.commands = commands;
    const found = this.evaluateMap(commands), positions = this.shapeAt(commands);
    this.outside = this.map !== null && (!found || !positions);
    if (found && positions) this.pose = {...found, positions};
    else if (!this.link) this.pose = {...this.pose, commands, step: -1};
    this.onChange();
  }

  reset(): void {
    if (this.link && !this.able) return;
    this.remember();
    this.values = this.values.map(() => null);
    if (this.able) this.command(this.restCommands());
    else if (this.steps.length) this.showStep(0);
  }

  showStep(step: number): void {
    const of = this.steps[step];
    this.outside = false;
    this.target = null;
    this.row = -1;
    this.commands = of.commands;
    this.pose = {commands: of.commands, loads: of.loads, measures: of.measures, markers: of.markers,
                 positions: of.positions, fields: of.fields, step, from: 'step', report: of};
    this.onChange();
  }

  /** Moves a marker to a target by inverse kinematics. */
  reach(marker: number, at: number[], row = -1): void {
    if (!this.able) return;
    this.row = row;
    const found = this.findCommands([{marker, at}]);
    if (!found && !this.link) return;
    const errorMm = found?.errorMm ?? null, reached = found?.reached ?? false;
    this.target = {marker, at, errorMm: this.link ? null : errorMm, reached: !this.link && reached, why: ''};
    this.link?.send({type: 'target', marker, at});
    this.move(found?.commands ?? this.commands);
  }

  /** Returns the commands near `from` that bring the markers nearest to their places, by the map; null where there are
      none. */
  findCommands(places: Place[], from = this.commands): {commands: number[]; errorMm: number; reached: boolean} | null {
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

  /** Shows a shape from the running softkin. newest: it answers the newest request; mine: a request of this window. */
  receive(frame: Frame, mine: boolean, newest: boolean): void {
    const last = newest || this.link?.busy !== true;
    if (!last && !(mine && !this.map)) return;
    const {commands, loads, measures, markers, positions, fields, target} = frame;
    this.pose = {commands, loads, measures, markers, positions, fields, step: -1, from: 'live', report: frame};
    if (last) {
      this.commands = commands;
      this.outside = false;
      this.estimate = frame.estimate ?? null;
      if (!mine) this.showReadings();
      this.target = target && {marker: target.marker, at: target.at, errorMm: target.error_mm,
                               reached: target.reached, why: target.why};
    }
    this.onChange();
  }

  /** Shows the readings of another window or of a stream, which the estimate contains. */
  private showReadings(): void {
    const {columns} = this.document.live?.estimate ?? {columns: []}, read = this.estimate?.readings;
    if (read) this.values = columns.map(({name}) => read.find(({column}) => column === name)?.read ?? null);
  }

  /** Returns whether the user can drag a marker; the center of a rigid body moves only by contact with the robot. */
  canReach(marker: number): boolean {
    if (this.document.markers[marker]?.body || this.isEstimating) return false;
    return this.link ? this.able : this.able && this.markerOutputs[marker] >= 0;
  }
}
