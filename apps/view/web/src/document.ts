import {type Packed, unpack} from './base64';
import type {EstimateDocument} from './estimate';
import type {MapDocument} from './map';

export type Kind = 'cable' | 'dea' | 'pneumatic' | 'magnetic' | 'growth' | 'motion' | 'force' | 'hold' | 'turn';
/** control: what is commanded; "length", "area" and "volume" are ratios to those at rest. load_unit: of the main
    quantity that the actuator results in, measure_unit: of its length, area or volume besides that, each empty where
    there is none. flux_density: of a uniform magnetic field alone, what one mT of its command adds to it [mT]. */
export interface Actuator {
  name: string; kind: Kind; control: string; unit: string; low: number; high: number; rest: number; load_unit: string;
  measure_unit: string; flux_density?: number[];
}
/** body: it is the center of a rigid body. */
export interface Marker { name: string; at: number[]; body?: boolean }
export interface CablePoint { vertices: number[]; weights: number[] }
export interface Fibre { points: CablePoint[] }
export interface Cable { actuator: number; points: CablePoint[] }
/** What the program says of a shape beside its numbers. */
export interface Told { status: string; remark: string; iterations: number; seconds: number }
interface PackedStep extends Told {
  commands: (number | null)[]; loads: (number | null)[]; measures: (number | null)[];
  markers: (number | null)[][]; time_s: number | null;
  positions: Packed; fields: Record<string, Packed>;
}
/** estimate: where it tells from readings. */
export interface LiveDocument { path: string; model: string; estimate?: EstimateDocument }
interface PackedSurface { points: Packed; triangles: Packed }
/** What softkin writes into the page (runs/page_document.hpp). live: of softkin view alone; workspace: where a marker
    can be. */
interface PackedDocument {
  softkin: string; command: string; robot: string; formulation: string; actuators: Actuator[]; markers: Marker[];
  regions: string[]; surface: {rest: Packed; triangles: Packed; region: Packed}; cables: Cable[];
  fibres?: Fibre[];
  obstacles: PackedSurface[]; bodies?: {triangles: Packed}; steps: PackedStep[]; map: MapDocument | null;
  live?: LiveDocument | null; workspace?: {marker: number; points: Packed; colour?: Packed} | null;
}

/** Numbers that the program does not know are NaN. */
export interface Step extends Told {
  commands: number[]; loads: (number | null)[]; measures: (number | null)[]; markers: number[][];
  time: number | null; positions: Float32Array; fields: Record<string, Float32Array>;
}
export interface Obstacle { positions: Float32Array; triangles: Uint32Array }
/** colour: a number for each point; null: none. */
export interface Workspace { marker: number; points: Float32Array; colour: Float32Array | null }
type Unpacked = 'surface' | 'steps' | 'obstacles' | 'bodies' | 'workspace' | 'live';
export interface RobotDocument extends Omit<PackedDocument, Unpacked> {
  rest: Float32Array; triangles: Uint32Array; region: Uint16Array; bodies: Uint32Array; obstacles: Obstacle[];
  steps: Step[]; live: LiveDocument | null; workspace: Workspace | null;
}

/** Of a triangle that belongs to no region. */
export const noRegion = 65535;

const floats = (packed: Packed): Float32Array => Float32Array.from(unpack(packed));
const known = (value: number | null): number => value ?? NaN;

function readTriangles(packed: Packed, vertices: number): Uint32Array {
  const triangles = Uint32Array.from(unpack(packed));
  if (triangles.length % 3 !== 0) throw new RangeError('a triangle lacks a corner');
  if (triangles.some((v) => v >= vertices)) throw new RangeError('a triangle has no such vertex');
  return triangles;
}

function readStep(step: PackedStep, vertices: number): Step {
  const positions = floats(step.positions), fields: Record<string, Float32Array> = {};
  if (positions.length !== 3 * vertices) throw new RangeError('a step has another number of vertices');
  for (const [name, values] of Object.entries(step.fields)) {
    fields[name] = floats(values);
    if (fields[name].length !== vertices) throw new RangeError(`a step's ${name} has another number of vertices`);
  }
  return {status: step.status, remark: step.remark, iterations: step.iterations, seconds: step.seconds,
          loads: step.loads, measures: step.measures, time: step.time_s, commands: step.commands.map(known),
          markers: step.markers.map((marker) => marker.map(known)), positions, fields};
}

function readWorkspace({marker, points, colour}: NonNullable<PackedDocument['workspace']>): Workspace {
  const at = floats(points), values = colour ? floats(colour) : null;
  if (at.length % 3 !== 0 || (values && values.length !== at.length / 3))
    throw new RangeError('the workspace has another number of colours than points');
  return {marker, points: at, colour: values};
}

/** Throws where the text is no document of a robot. */
export function readDocument(text: string): RobotDocument | null {
  const read = JSON.parse(text) as PackedDocument | null;
  if (!read) return null;
  const {surface, obstacles, bodies, steps, workspace, live, ...rest} = read;
  const atRest = floats(surface.rest), vertices = atRest.length / 3;
  const triangles = readTriangles(surface.triangles, vertices), region = Uint16Array.from(unpack(surface.region));
  if (region.length !== triangles.length / 3) throw new RangeError('the surface has another number of regions');
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

/** The name that people know: of a scene's file, without its folder. */
export const robotName = ({robot}: RobotDocument): string =>
  (robot.split(/[/\\]/).at(-1) ?? robot).replace(/\.ya?ml$/i, '') || 'Soft robot';
