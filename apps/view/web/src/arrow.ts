import {
  type Camera, type Color, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3,
} from 'three';

// as the arrows of a marker
const shaftPx = 1.7, headPx = {length: 15, radius: 6}, ballPx = 4.5;
const up = new Vector3(0, 1, 0);

/** A vector as an arrow, from a ball, which alone is seen where it is zero: the flux density of the uniform fields
    beside the robot [mT], a force at its place [N]. */
export class Arrow {
  readonly group = new Group();
  private readonly material = new MeshBasicMaterial({depthTest: false, transparent: true});
  private readonly arrow = new Group();
  private readonly shaft = new Mesh(new CylinderGeometry(1, 1, 1, 8), this.material);
  private readonly head = new Mesh(new ConeGeometry(1, 1, 14), this.material);
  private readonly ball = new Mesh(new SphereGeometry(1, 16, 12), this.material);
  private lengthMm = 0;
  /** Where it ends [mm]. */
  tip: number[];
  /** In the vector's unit. */
  size = 0;

  constructor(foot: Vector3, public mmPerUnit: number) {
    this.arrow.add(this.shaft, this.head);
    this.group.add(this.arrow, this.ball);
    for (const part of [this.shaft, this.head, this.ball]) part.renderOrder = 5;
    this.group.position.copy(foot);
    this.tip = foot.toArray();
  }

  get visible(): boolean { return this.group.visible; }

  /** Where it begins [mm]. */
  get foot(): number[] { return this.group.position.toArray(); }

  dress(colour: Color): void { this.material.color = colour; }

  set(vector: number[]): void {
    const way = new Vector3().fromArray(vector).multiplyScalar(this.mmPerUnit);
    this.size = Math.hypot(...vector);
    this.lengthMm = way.length();
    this.tip = this.group.position.clone().add(way).toArray();
    if (this.lengthMm > 0) this.arrow.quaternion.setFromUnitVectors(up, way.normalize());
  }

  /** As thick on the screen from near and far; a short arrow is all head. */
  fit(camera: Camera, mmPerPxAtOne: number): void {
    const mmPerPx = mmPerPxAtOne * camera.position.distanceTo(this.group.position);
    const head = Math.min(headPx.length * mmPerPx, this.lengthMm), shaft = this.lengthMm - head;
    const radius = head * headPx.radius / headPx.length;
    this.ball.scale.setScalar(ballPx * mmPerPx);
    this.head.visible = head > 0;
    this.head.scale.set(radius, head, radius);
    this.head.position.y = shaft + head / 2;
    this.shaft.visible = shaft > 0;
    this.shaft.scale.set(shaftPx * mmPerPx, shaft, shaftPx * mmPerPx);
    this.shaft.position.y = shaft / 2;
  }
}
