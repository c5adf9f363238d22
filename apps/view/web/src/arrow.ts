import {
  type Camera, type Color, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3,
} from 'three';

// sizes on the screen, the same as those of a marker's arrows
const shaftPx = 1.7, headPx = {length: 15, radius: 6}, ballPx = 4.5;
const up = new Vector3(0, 1, 0);

/** A vector as an arrow that starts at a ball; a zero vector shows the ball alone. It shows the flux density of the
    uniform fields next to the robot [mT] or a force at its point of application [N]. */
export class Arrow {
  readonly group = new Group();
  private readonly material = new MeshBasicMaterial({depthTest: false, transparent: true});
  private readonly arrow = new Group();
  private readonly shaft = new Mesh(new CylinderGeometry(1, 1, 1, 8), this.material);
  private readonly head = new Mesh(new ConeGeometry(1, 1, 14), this.material);
  private readonly ball = new Mesh(new SphereGeometry(1, 16, 12), this.material);
  private lengthMm = 0;
  /** The end point [mm]. */
  tip: number[];
  /** The length of the vector, in its unit. */
  size = 0;

  constructor(foot: Vector3, public mmPerUnit: number) {
    this.arrow.add(this.shaft, this.head);
    this.group.add(this.arrow, this.ball);
    for (const part of [this.shaft, this.head, this.ball]) part.renderOrder = 5;
    this.group.position.copy(foot);
    this.tip = foot.toArray();
  }

  get visible(): boolean { return this.group.visible; }

  /** The start point [mm]. */
  get foot(): number[] { return this.group.position.toArray(); }

  setColour(colour: Color): void { this.material.color = colour; }

  set(vector: number[]): void {
    const offset = new Vector3().fromArray(vector).multiplyScalar(this.mmPerUnit);
    this.size = Math.hypot(...vector);
    this.lengthMm = offset.length();
    this.tip = this.group.position.clone().add(offset).toArray();
    if (this.lengthMm > 0) this.arrow.quaternion.setFromUnitVectors(up, offset.normalize());
  }

  /** Keeps the thickness on the screen constant at any distance; a short arrow is drawn as its head alone. */
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
