import {type Packed, unpack} from './base64';
import type {EstimateDocument} from './estimate';
import type {MapDocument} from './map';

export type Kind = 'cable' | 'dea' | 'pneumatic' | 'magnetic' | 'growth' | 'motion' | 'force' | 'hold' | 'turn';
/** control: the commanded quantity; "length", "area" and "volume" are ratios to those at rest. load_unit: the unit of
    the actuator's main result, such as its tension; measure_unit: the unit of its length, area or volume, if that is
    another result; each is empty where there is none. flux_density: for a uniform magnetic field only, the flux
    density per mT of its command [mT]. */
export interface Actuator {
  name: string; kind: Kind; control: string; unit: string; low: number; high: number; rest: number; load_unit: string;
  measure_unit: string; flux_density?: number[];
}
/** body: the marker is the center of a rigid body. */
export interface Marker { name: string; at: number[]; body?: boolean }
export interface CablePoint { vertices: number[]; weights: number[] }
export interface Fibre { points: CablePoint[] }
export interface Cable { actuator: number; points: CablePoint[] }
/** The solver's report on a shape. */
export interface SolverReport { status: string; remark: string; iterations: number; seconds: number }
interface PackedStep extends SolverReport {
  commands: (number | null)[]; loads: (number | null)[]; measures: (number | null)[];
  markers: (number | null)[][]; time_s: number | null;
  positions: Packed; fields: Record<string, Packed>;
}
/** estimate: present where softkin view estimates forces from readings. */
export interface LiveDocument { path: string; model: string; estimate?: EstimateDocument }
interface PackedSurface { points: Packed; triangles: Packed }
/** The document that softkin writes into the page (runs/page_document.hpp). live: of softkin view only; workspace: the
    reachable positions of a marker. */
interface PackedDocument {
  softkin: string; command: string; robot: string; formulation: string; actuators: Actuator[]; markers: Marker[];
  regions: string[]; surface: {rest: Packed; triangles: Packed; region: Packed}; cables: Cable[];
  fibres?: Fibre[];
  obstacles: PackedSurface[]; bodies?: {triangles: Packed}; steps: PackedStep[]; map: MapDocument | null;
  live?: LiveDocument | null; workspace?: {marker: number; points: Packed; colour?: Packed} | null;
}

/** A computed shape; unknown numbers are NaN. */
export interface Step extends SolverReport {
  commands: number[]; loads: (number | null)[]; measures: (number | null)[]; markers: number[][];
  time: number | null; positions: Float32Array; fields: Record<string, Float32Array>;
}
export interface Obstacle { positions: Float32Array; triangles: Uint32Array }
/** colour: a value for each point, or null. */
export interface Workspace { marker: number; points: Float32Array; colour: Float32Array | null }
type Unpacked = 'surface' | 'steps' | 'obstacles' | 'bodies' | 'workspace' | 'live';
export interface RobotDocument extends Omit<PackedDocument, Unpacked> {
  rest: Float32Array; triangles: Uint32Array; region: Uint16Array; bodies: Uint32Array; obstacles: Obstacle[];
  steps: Step[]; live: LiveDocument | null; workspace: Workspace | null;
}

/** The region number of a triangle that belongs to no region. */
export const noRegion = 65535;

const floats = (packed: Packed): Float32Array => Float32Array.from(unpack(packed));
const orNaN = (value: number | null): number => value ?? NaN;

function readTriangles(packed: Packed, vertices: number): Uint32Array {
  const triangles = Uint32Array.from(unpack(packed));
  if (triangles.length % 3 !== 0) throw new RangeError('a triangle does not have three vertices');
  if (triangles.some((v) => v >= vertices)) throw new RangeError('a triangle refers to a vertex that does not exist');
  return triangles;
}

function readStep(step: PackedStep, vertices: number): Step {
  const positions = floats(step.positions), fields: Record<string, Float32Array> = {};
  if (positions.length !== 3 * vertices)
    throw new RangeError('a step and the surface differ in their number of vertices');
  for (const [name, values] of Object.entries(step.fields)) {
    fields[name] = floats(values);
    if (fields[name].length !== vertices)
      throw new RangeError(`${name} of a step and the surface differ in their number of vertices`);
  }
  return {status: step.status, remark: step.remark, iterations: step.iterations, seconds: step.seconds,
          loads: step.loads, measures: step.measures, time: step.time_s, commands: step.commands.map(orNaN),
          markers: step.markers.map((marker) => marker.map(orNaN)), positions, fields};
}

function readWorkspace({marker, points, colour}: NonNullable<PackedDocument['workspace']>): Workspace {
  const positions = floats(points), values = colour ? floats(colour) : null;
  if (positions.length % 3 !== 0 || (values && values.length !== positions.length / 3))
    throw new RangeError('the workspace differs in its numbers of points and colours');
  return {marker, points: positions, colour: values};
}

/** Reads the document of a robot; returns null for a page without one. Throws where the text is malformed. */
export function readDocument(text: string): RobotDocument | null {
  const read = JSON.parse(text) as PackedDocument | null;
  if (!read) return null;
  const {surface, obstacles, bodies, steps, workspace, live, ...rest} = read;
  const atRest = floats(surface.rest), vertices = atRest.length / 3;
  const triangles = readTriangles(surface.triangles, vertices), region = Uint16Array.from(unpack(surface.region));
  if (region.length !== triangles.length / 3)
    throw new RangeError('the surface differs in its numbers of triangles and regions');
  return {
    ...rest, rest: atRest, triangles, region,
    bodies: bodies ? readTriangles(bodies.triangles, vertices) : new Uint32Array(),
    obstacles: obstacles.map(({points, triangles: faces}) => {
      const positions = floats(points);
      return {positions, triangles: readTriangles(faces, positions.length / 3)};
    }),
    steps: steps.map((step) => readStep(step, vertices)),
    live: live ?? null,
    workspace: workspace ? readWorkspace(workspace) : null,
  };
}

/** Returns the robot's name: that of the scene file, without folder and ending. */
export const robotName = ({robot}: RobotDocument): string =>
  (robot.split(/[/\\]/).at(-1) ?? robot).replace(/\.ya?ml$/i, '') || 'Soft robot';
