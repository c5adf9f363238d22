import {
  type Camera, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Vector3,
} from 'three';

const lengthPx = 74, shaftFrom = 0.3, grabPx = {mouse: 9, touch: 20};
// Okabe and Ito 2008: distinguishable with colour blindness; each arrow also has the letter of its axis.
const colours = ['#d55e00', '#009e73', '#3d8fd1'];
const directions = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];

interface Pixel { x: number; y: number }
type Project = (at: number[]) => Pixel;

/** Arrows along x, y and z at a point, to drag it along one axis. */
export class Handles {
  readonly group = new Group();
  private place: number[] | null = null;
  private lengthMm = 1;
  private readonly arrows: Group[];

  constructor(private readonly project: Project) {
    this.arrows = directions.map((direction, k) => {
      const material = new MeshBasicMaterial({color: colours[k], depthTest: false, transparent: true});
      const shaft = new Mesh(new CylinderGeometry(0.022, 0.022, 0.8 - shaftFrom, 8), material);
      const head = new Mesh(new ConeGeometry(0.08, 0.2, 14), material);
      shaft.position.y = (0.8 + shaftFrom) / 2;
      head.position.y = 0.9;
      const arrow = new Group();
      arrow.add(shaft, head);
      for (const part of [shaft, head]) part.renderOrder = 5;
      arrow.quaternion.setFromUnitVectors(directions[1], direction);
      return arrow;
    });
    this.group.add(...this.arrows);
    this.group.visible = false;
  }

  /** Moves the arrows to a point; null hides them. */
  set(place: number[] | null): void {
    this.place = place;
    this.group.visible = place !== null;
    if (place) this.group.position.fromArray(place);
  }

  /** Keeps the length on the screen constant at any distance. */
  fit(camera: Camera, mmPerPxAtOne: number): void {
    this.lengthMm = lengthPx * mmPerPxAtOne * camera.position.distanceTo(this.group.position);
    this.group.scale.setScalar(this.lengthMm);
    this.arrows.forEach((arrow, k) => { arrow.visible = this.onScreen(k) !== null; });
  }

  private tip(k: number, fraction: number): number[] {
    return (this.place ?? [0, 0, 0]).map((x, i) => x + (i === k ? fraction * this.lengthMm : 0));
  }

  /** Returns the projection of an arrow [px]; null where it points towards or away from the camera. */
  private onScreen(k: number): Pixel | null {
    if (!this.place) return null;
    const from = this.project(this.place), to = this.project(this.tip(k, 1)), x = to.x - from.x, y = to.y - from.y;
    return Math.hypot(x, y) > 0.25 * lengthPx ? {x, y} : null;
  }

  /** Returns the position of the letter of an axis [px]; null where it is not shown. */
  letterAt(k: number): Pixel | null { return this.onScreen(k) && this.project(this.tip(k, 1.15)); }

  /** Returns the axis whose arrow is at a pixel, or -1. */
  under(x: number, y: number, touch: boolean): number {
    if (!this.place) return -1;
    const from = this.project(this.place);
    let best = -1, smallest = touch ? grabPx.touch : grabPx.mouse;
    directions.forEach((_, k) => {
      const arrow = this.onScreen(k);
      if (!arrow) return;
      const length = Math.hypot(arrow.x, arrow.y), along = ((x - from.x) * arrow.x + (y - from.y) * arrow.y) / length;
      const across = Math.abs((x - from.x) * arrow.y - (y - from.y) * arrow.x) / length;
      if (along > shaftFrom * length && along < 1.1 * length && across < smallest) [best, smallest] = [k, across];
    });
    return best;
  }

  /** Converts a motion of the pointer [px] to a distance along an axis [mm]. */
  along(k: number, dx: number, dy: number): number {
    const arrow = this.onScreen(k);
    return arrow ? (dx * arrow.x + dy * arrow.y) / (arrow.x * arrow.x + arrow.y * arrow.y) * this.lengthMm : 0;
  }
}
