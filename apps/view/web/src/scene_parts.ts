import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, GridHelper, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  Points, PointsMaterial, Vector3,
} from 'three';
import {Line2} from 'three/examples/jsm/lines/Line2.js';
import {LineGeometry} from 'three/examples/jsm/lines/LineGeometry.js';
import {LineMaterial} from 'three/examples/jsm/lines/LineMaterial.js';
import {paint, regionColour, scaleOf} from './colours';
import {type CablePoint, noRegion, type Obstacle, type RobotDocument, type Workspace} from './document';

export const ofTheme = (name: string): Color =>
  new Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());

function geometryOf(positions: BufferAttribute, triangles: Uint32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute('position', positions);
  return geometry;
}

/** Builds the robot's surface with one material for each region; the last one is for triangles without region. */
export function makeBody(robot: RobotDocument, positions: BufferAttribute,
                         colours: BufferAttribute): Mesh<BufferGeometry, MeshLambertMaterial[]> {
  const {triangles, region, regions} = robot;
  const used = region.reduce((largest, r) => r === noRegion ? largest : Math.max(largest, r + 1), 1);
  const count = Math.max(regions.length, used);
  const numbers = Array.from(region, (r) => r === noRegion ? count : r);
  const order = Array.from(region.keys()).sort((a, b) => numbers[a] - numbers[b] || a - b);
  const index = new Uint32Array(triangles.length);
  order.forEach((t, k) => index.set(triangles.subarray(3 * t, 3 * t + 3), 3 * k));
  const geometry = geometryOf(positions, index);
  geometry.setAttribute('color', colours);
  for (let k = 1, first = 0; k <= order.length; ++k) {
    if (k < order.length && numbers[order[k]] === numbers[order[first]]) continue;
    geometry.addGroup(3 * first, 3 * (k - first), numbers[order[first]]);
    first = k;
  }
  const materials = Array.from({length: count + 1}, () =>
    new MeshLambertMaterial({flatShading: true, side: DoubleSide}));
  const body = new Mesh(geometry, materials);
  body.frustumCulled = false;
  return body;
}

/** Returns the colour of a material of the body. */
export const bodyColour = (number: number, count: number): string =>
  number < count - 1 ? regionColour(number) : '#999999';

/** Builds the reference shape, drawn behind the body where both overlap. */
export function makeGhost(robot: RobotDocument): Mesh<BufferGeometry, MeshBasicMaterial> {
  const ghost = new Mesh(geometryOf(new BufferAttribute(robot.rest, 3), robot.triangles),
    new MeshBasicMaterial({transparent: true, opacity: 0.16, depthWrite: false, polygonOffset: true,
                           polygonOffsetFactor: 4, polygonOffsetUnits: 4}));
  ghost.renderOrder = 1;
  return ghost;
}

const stone = () => new MeshLambertMaterial({color: 0x8d8d8d, flatShading: true, side: DoubleSide});

export const makeObstacle = ({positions, triangles}: Obstacle): Mesh =>
  new Mesh(geometryOf(new BufferAttribute(positions, 3), triangles), stone());

/** Builds the rigid bodies, which move with the vertices. */
export function makeBodies(robot: RobotDocument, positions: BufferAttribute): Mesh {
  const bodies = new Mesh(geometryOf(positions, robot.bodies), stone());
  bodies.frustumCulled = false;
  bodies.visible = robot.bodies.length > 0;
  return bodies;
}

/** Builds the grid below the robot, with cells of 1, 2 or 5 times a power of ten. */
export function makeGrid(size: number, middle: Vector3, lowest: number): {grid: GridHelper; cellMm: number} {
  const step = 10 ** Math.floor(Math.log10(size / 3));
  const cellMm = [1, 2, 5].map((n) => n * step).reverse().find((n) => size / n >= 6) ?? step;
  const cells = Math.ceil(size / cellMm / 2) * 2, grid = new GridHelper(cells * cellMm, cells);
  grid.rotation.x = Math.PI / 2;
  const whole = (value: number) => Math.round(value / cellMm) * cellMm;
  grid.position.set(whole(middle.x), whole(middle.y), lowest - size / 200);
  return {grid, cellMm};
}

/** Builds the workspace of a marker, as points of a few pixels. */
export function makeCloud({points, colour}: Workspace): Points<BufferGeometry, PointsMaterial> {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  const cloud = new Points(geometry, new PointsMaterial({size: 3, sizeAttenuation: false}));
  if (colour) {
    const colours = new Float32Array(points.length);
    paint(colour, scaleOf([colour], null, false), colours);
    geometry.setAttribute('color', new BufferAttribute(colours, 3));
    cloud.material.vertexColors = true;
  }
  return cloud;
}

function makeLine(width: number, order: number): Line2 {
  const line = new Line2(new LineGeometry(), new LineMaterial({linewidth: width, depthTest: false, transparent: true}));
  line.frustumCulled = false;
  line.renderOrder = order;
  return line;
}

/** A line of some pixels through points that move with the mesh, with a rim that separates it from the background: a
    cable or, thinner, a fibre. */
export class CarriedLine {
  readonly rim: Line2;
  readonly core: Line2;

  constructor(private readonly points: CablePoint[], width: number) {
    this.rim = makeLine(width + 2.5, 2);
    this.core = makeLine(width, 3);
  }

  follow(positions: Float32Array): void {
    const places = this.points.flatMap(({vertices, weights}) => [0, 1, 2].map((k) =>
      vertices.reduce((sum, v, i) => sum + weights[i] * positions[3 * v + k], 0)));
    for (const line of [this.rim, this.core]) {
      line.geometry.dispose();
      line.geometry = new LineGeometry();
      line.geometry.setPositions(places);
    }
  }
}
