import {
  type Camera, BufferAttribute, BufferGeometry, type Color, DoubleSide, Group, LineBasicMaterial, LineLoop, Mesh,
  MeshBasicMaterial, Vector3,
} from 'three';
import {Arrow} from './arrow';
import {halfOpening, type EstimatedForce} from './estimate';

/** The number of vertices of a drawn ellipse. */
const corners = 48;
/** The length of the longest arrow, or of half the rim of a wider cone, as a fraction of the robot's size: after a
    change of scale, and the range in which the scale is kept. */
const longest = 0.32, kept = {low: 0.12, high: 0.4};

/** Returns the largest number of 1, 2 or 5 times a power of ten that does not exceed the limit. */
export function roundBelow(limit: number): number {
  const power = 10 ** Math.floor(Math.log10(limit));
  return (([5, 2, 1].find((n) => n * power <= limit * (1 + 1e-9))) ?? 1) * power;
}

const vector = (at: number[], scale = 1): Vector3 => new Vector3().fromArray(at).multiplyScalar(scale);

function ellipse(middle: Vector3, [a, b]: Vector3[]): Vector3[] {
  return Array.from({length: corners}, (_, i) => {
    const angle = 2 * Math.PI * i / corners;
    return middle.clone().addScaledVector(a, Math.cos(angle)).addScaledVector(b, Math.sin(angle));
  });
}

/** Builds triangles from a point to a ring around it. */
function fan(tip: Vector3, ring: Vector3[]): BufferGeometry {
  const index = ring.flatMap((_, i) => [0, 1 + i, 1 + (i + 1) % ring.length]);
  const geometry = new BufferGeometry().setFromPoints([tip, ...ring]);
  geometry.setIndex(new BufferAttribute(new Uint16Array(index), 1));
  return geometry;
}

/** One force: an arrow from its point of application, a cone over the ellipse that contains the arrow's tip, and the
    ellipse of the point of application. */
class ForceShape {
  readonly group = new Group();
  readonly arrow = new Arrow(new Vector3(), 1);
  private readonly parts: (Mesh | LineLoop)[];
  private readonly cone: Mesh;
  private readonly rim: LineLoop;
  private readonly spot: Mesh;
  private readonly edge: LineLoop;

  constructor(clear: MeshBasicMaterial, line: LineBasicMaterial) {
    this.cone = new Mesh(new BufferGeometry(), clear);
    this.spot = new Mesh(new BufferGeometry(), clear);
    this.rim = new LineLoop(new BufferGeometry(), line);
    this.edge = new LineLoop(new BufferGeometry(), line);
    this.parts = [this.cone, this.rim, this.spot, this.edge];
    for (const part of this.parts) {
      part.renderOrder = 3;
      part.frustumCulled = false;
    }
    this.group.add(...this.parts, this.arrow.group);
  }

  set(force: EstimatedForce, mmPerNewton: number): void {
    const at = vector(force.at_mm), tip = at.clone().add(vector(force.force_N, mmPerNewton));
    this.arrow.group.position.copy(at);
    this.arrow.mmPerUnit = mmPerNewton;
    this.arrow.set(force.force_N);
    this.cone.visible = this.rim.visible = halfOpening(force) > 0;
    this.draw(this.cone, this.rim, at, ellipse(tip, force.across_N.map((axis) => vector(axis, mmPerNewton))));
    this.spot.visible = this.edge.visible = force.place_mm !== null;
    if (force.place_mm) this.draw(this.spot, this.edge, at, ellipse(at, force.place_mm.map((axis) => vector(axis))));
  }

  private draw(face: Mesh, edge: LineLoop, from: Vector3, ring: Vector3[]): void {
    for (const part of [face, edge]) part.geometry.dispose();
    face.geometry = fan(from, ring);
    edge.geometry = new BufferGeometry().setFromPoints(ring);
  }
}

/** The estimated forces, all drawn to one scale. */
export class Forces {
  readonly group = new Group();
  /** The length of an arrow of 1 N [mm]. */
  mmPerNewton = 0;
  private shapes: ForceShape[] = [];
  private colour: Color | null = null;
  // drawn on top of the body, which would hide the forces that press into it
  private readonly clear = new MeshBasicMaterial({transparent: true, opacity: 0.2, depthTest: false, depthWrite: false,
                                                  side: DoubleSide});
  private readonly line = new LineBasicMaterial({transparent: true, opacity: 0.8, depthTest: false});

  constructor(private readonly size: number) {}

  /** The start and end point of each arrow [mm]. */
  get arrows(): {foot: number[]; tip: number[]}[] { return this.shapes.map(({arrow}) => arrow); }

  setColour(colour: Color): void {
    this.colour = this.clear.color = this.line.color = colour;
    for (const {arrow} of this.shapes) arrow.setColour(colour);
  }

  set(forces: EstimatedForce[]): void {
    const reach = Math.max(0, ...forces.map(({force_N: force, across_N: across}) =>
      Math.max(Math.hypot(...force), Math.hypot(...across[0]))));
    const fraction = reach * this.mmPerNewton / this.size;
    const isKept = fraction > kept.low && fraction < kept.high;
    if (reach > 0 && !isKept) this.mmPerNewton = roundBelow(longest * this.size / reach);
    while (this.shapes.length > forces.length) this.group.remove((this.shapes.pop() as ForceShape).group);
    while (this.shapes.length < forces.length) {
      const shape = new ForceShape(this.clear, this.line);
      if (this.colour) shape.arrow.setColour(this.colour);
      this.shapes.push(shape);
      this.group.add(shape.group);
    }
    forces.forEach((force, i) => this.shapes[i].set(force, this.mmPerNewton));
  }

  fit(camera: Camera, mmPerPxAtOne: number): void {
    for (const {arrow} of this.shapes) arrow.fit(camera, mmPerPxAtOne);
  }
}
