import {
  type Camera, BufferAttribute, BufferGeometry, type Color, DoubleSide, Group, LineBasicMaterial, LineLoop, Mesh,
  MeshBasicMaterial, Vector3,
} from 'three';
import {Arrow} from './arrow';
import {halfOpening, type ToldForce} from './estimate';

/** Corners of an ellipse that is drawn. */
const corners = 48;
/** Of the robot's size: the arrow, or half of a wider cone, is as long; the scale stays while it is between these. */
const longest = 0.32, kept = {low: 0.12, high: 0.4};

/** 1, 2 or 5 times a power of ten, at most so much. */
export function roundBelow(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  return (([5, 2, 1].find((n) => n * power <= most * (1 + 1e-9))) ?? 1) * power;
}

const vector = (at: number[], scale = 1): Vector3 => new Vector3().fromArray(at).multiplyScalar(scale);

function ellipse(middle: Vector3, [a, b]: Vector3[]): Vector3[] {
  return Array.from({length: corners}, (_, i) => {
    const angle = 2 * Math.PI * i / corners;
    return middle.clone().addScaledVector(a, Math.cos(angle)).addScaledVector(b, Math.sin(angle));
  });
}

/** Triangles from a point to a ring around it. */
function fan(tip: Vector3, ring: Vector3[]): BufferGeometry {
  const index = ring.flatMap((_, i) => [0, 1 + i, 1 + (i + 1) % ring.length]);
  const geometry = new BufferGeometry().setFromPoints([tip, ...ring]);
  geometry.setIndex(new BufferAttribute(new Uint16Array(index), 1));
  return geometry;
}

/** One force: an arrow from its place, a cone over the ellipse that holds the arrow's tip, the ellipse of its place. */
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

  set(force: ToldForce, mmPerNewton: number): void {
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

/** The forces that were told, all to one scale. */
export class Forces {
  readonly group = new Group();
  /** As long is an arrow of 1 N [mm]. */
  mmPerNewton = 0;
  private shapes: ForceShape[] = [];
  private colour: Color | null = null;
  // on top of the body: what pushes is not hidden by what it pushes into
  private readonly clear = new MeshBasicMaterial({transparent: true, opacity: 0.2, depthTest: false, depthWrite: false,
                                                  side: DoubleSide});
  private readonly line = new LineBasicMaterial({transparent: true, opacity: 0.8, depthTest: false});

  constructor(private readonly size: number) {}

  /** Where each arrow begins and ends [mm]. */
  get arrows(): {foot: number[]; tip: number[]}[] { return this.shapes.map(({arrow}) => arrow); }

  dress(colour: Color): void {
    this.colour = this.clear.color = this.line.color = colour;
    for (const {arrow} of this.shapes) arrow.dress(colour);
  }

  set(forces: ToldForce[]): void {
    const reach = Math.max(0, ...forces.map(({force_N: force, across_N: across}) =>
      Math.max(Math.hypot(...force), Math.hypot(...across[0]))));
    const drawn = reach * this.mmPerNewton / this.size;
    const stays = drawn > kept.low && drawn < kept.high;
    if (reach > 0 && !stays) this.mmPerNewton = roundBelow(longest * this.size / reach);
    while (this.shapes.length > forces.length) this.group.remove((this.shapes.pop() as ForceShape).group);
    while (this.shapes.length < forces.length) {
      const shape = new ForceShape(this.clear, this.line);
      if (this.colour) shape.arrow.dress(this.colour);
      this.shapes.push(shape);
      this.group.add(shape.group);
    }
    forces.forEach((force, i) => this.shapes[i].set(force, this.mmPerNewton));
  }

  fit(camera: Camera, mmPerPxAtOne: number): void {
    for (const {arrow} of this.shapes) arrow.fit(camera, mmPerPxAtOne);
  }
}
