import {
  type Camera, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Vector3,
} from 'three';

const lengthPx = 74, shaftFrom = 0.3, grabPx = {mouse: 9, touch: 20};
// Okabe and Ito 2008: told apart also by eyes with colour blindness; the letters say the rest.
const colours = ['#d55e00', '#009e73', '#3d8fd1'];
const directions = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];

interface Pixel { x: number; y: number }
type Project = (at: number[]) => Pixel;

/** Arrows along x, y and z at a place, to drag it along one of them. */
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

  /** null: none. */
  set(place: number[] | null): void {
    this.place = place;
    this.group.visible = place !== null;
    if (place) this.group.position.fromArray(place);
  }

  /** As long on the screen from near and far. */
  fit(camera: Camera, mmPerPxAtOne: number): void {
    this.lengthMm = lengthPx * mmPerPxAtOne * camera.position.distanceTo(this.group.position);
    this.group.scale.setScalar(this.lengthMm);
    this.arrows.forEach((arrow, k) => { arrow.visible = this.onScreen(k) !== null; });
  }

  private tip(k: number, share: number): number[] {
    return (this.place ?? [0, 0, 0]).map((x, i) => x + (i === k ? share * this.lengthMm : 0));
  }

  /** The way of an arrow in pixels; null where it points at the eye. */
  private onScreen(k: number): Pixel | null {
    if (!this.place) return null;
    const from = this.project(this.place), to = this.project(this.tip(k, 1)), x = to.x - from.x, y = to.y - from.y;
    return Math.hypot(x, y) > 0.25 * lengthPx ? {x, y} : null;
  }

  /** Where the letter of an axis stands; null: nowhere. */
  letterAt(k: number): Pixel | null { return this.onScreen(k) && this.project(this.tip(k, 1.15)); }

  /** The axis under a pixel, or -1. */
  under(x: number, y: number, touch: boolean): number {
    if (!this.place) return -1;
    const from = this.project(this.place);
    let best = -1, least = touch ? grabPx.touch : grabPx.mouse;
    directions.forEach((_, k) => {
      const way = this.onScreen(k);
      if (!way) return;
      const far = Math.hypot(way.x, way.y), along = ((x - from.x) * way.x + (y - from.y) * way.y) / far;
      const beside = Math.abs((x - from.x) * way.y - (y - from.y) * way.x) / far;
      if (along > shaftFrom * far && along < 1.1 * far && beside < least) [best, least] = [k, beside];
    });
    return best;
  }

  /** How far a move of the pointer [px] leads along an axis [mm]. */
  along(k: number, dx: number, dy: number): number {
    const way = this.onScreen(k);
    return way ? (dx * way.x + dy * way.y) / (way.x * way.x + way.y * way.y) * this.lengthMm : 0;
  }
}
