import {
  AmbientLight, Box3, BufferAttribute, BufferGeometry, DirectionalLight, type GridHelper, Line, LineBasicMaterial, Mesh,
  MeshBasicMaterial, type MeshLambertMaterial, PerspectiveCamera, type Points, type PointsMaterial, Scene,
  SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {Arrow} from './arrow';
import {colourAt, paint, type Scale} from './colours';
import type {RobotDocument} from './document';
import type {EstimatedForce} from './estimate';
import {largestField} from './field';
import {Forces} from './forces';
import {Handles} from './handles';
import {
  bodyColour, CarriedLine, makeBodies, makeBody, makeCloud, makeGhost, makeGrid, makeObstacle, ofTheme,
} from './scene_parts';

export type Part = 'ghost' | 'traces' | 'markers' | 'grid' | 'clear' | 'workspace' | 'around' |
  'field' | 'forces';
type Thread = Line<BufferGeometry, LineBasicMaterial>;
type Ball = Mesh<SphereGeometry, MeshBasicMaterial>;

const threadOf = (): Thread =>
  new Line(new BufferGeometry(), new LineBasicMaterial({depthTest: false, transparent: true}));

const viewDirection = new Vector3(-0.55, -1, 0.45);

/** Returns whether the processor draws, for which antialiasing would cost several times the rest of the picture. */
function isSoftwareRenderer(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl?.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) ?? '');
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** The robot in 3-D; it is drawn again after a change. */
export class RobotScene {
  readonly camera = new PerspectiveCamera(35, 1, 0.1, 1e5);
  readonly controls: OrbitControls;
  readonly gridMm: number;
  readonly handles = new Handles((at) => this.project(at));
  /** The arrow of the uniform magnetic fields; null where there are none. */
  readonly field: Arrow | null;
  /** The estimated forces. */
  readonly forces: Forces;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly ambient = new AmbientLight(0xffffff);
  private readonly body: Mesh<BufferGeometry, MeshLambertMaterial[]>;
  private readonly ghost: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly around: Mesh[];
  private readonly cloud: Points<BufferGeometry, PointsMaterial> | null;
  private readonly positions: BufferAttribute;
  private readonly colours: BufferAttribute;
  private readonly balls: Ball[];
  private readonly rings: Ball[];
  private readonly traces: Thread[];
  private readonly cables: CarriedLine[];
  private readonly fibres: CarriedLine[];
  private readonly target: Ball;
  private readonly gap = threadOf();
  private readonly desiredPath = threadOf();  // through the waypoints
  private readonly grid: GridHelper;
  private readonly size: number;
  private readonly box = new Box3();
  private tensions: (number | null)[] = [];
  private isScheduled = false;
  private isCameraKept = false;    // after the user moved it
  private isCameraLocked = false;  // during a drag
  private isInSight = true;
  onDrawn: () => void = () => {};

  constructor(private readonly canvas: HTMLCanvasElement, robot: RobotDocument, shapes: Float32Array[]) {
    this.renderer = new WebGLRenderer({canvas, antialias: !isSoftwareRenderer()});
    for (const shape of [robot.rest, ...shapes, ...(robot.workspace ? [robot.workspace.points] : [])])
      this.box.union(new Box3().setFromArray(shape as unknown as number[]));
    this.size = this.box.getSize(new Vector3()).length() || 1;
    this.positions = new BufferAttribute(Float32Array.from(robot.rest), 3);
    this.colours = new BufferAttribute(new Float32Array(robot.rest.length).fill(1), 3);
    this.body = makeBody(robot, this.positions, this.colours);
    this.ghost = makeGhost(robot);
    this.around = [...robot.obstacles.map(makeObstacle), makeBodies(robot, this.positions)];
    this.cloud = robot.workspace && makeCloud(robot.workspace);
    const ball = new SphereGeometry(this.size / 80, 20, 14);
    const onTop = () => new MeshBasicMaterial({depthTest: false, transparent: true});
    this.balls = robot.markers.map(() => new Mesh(ball, onTop()));
    this.rings = robot.markers.map(() => new Mesh(ball, onTop()));
    this.rings.forEach((ring, i) => this.balls[i].add(ring));
    this.target = new Mesh(new SphereGeometry(this.size / 55, 20, 14),
                           new MeshBasicMaterial({wireframe: true, depthTest: false, transparent: true}));
    this.traces = robot.markers.map(threadOf);
    this.cables = robot.cables.map(({points}) => new CarriedLine(points, 3.5));
    this.fibres = (robot.fibres ?? []).map(({points}) => new CarriedLine(points, 1));
    for (const part of [...this.traces, this.gap, this.desiredPath, ...this.balls, this.target]) {
      part.frustumCulled = false;
      part.renderOrder = 4;
    }
    for (const marker of this.balls) marker.renderOrder = 7;
    for (const ring of this.rings) {
      ring.scale.setScalar(1.4);
      ring.renderOrder = 6;
    }
    this.gap.visible = this.target.visible = this.desiredPath.visible = false;
    ({grid: this.grid, cellMm: this.gridMm} =
      makeGrid(this.size, this.box.getCenter(new Vector3()), this.box.min.z));
    this.field = this.makeFieldArrow(largestField(robot.actuators));
    this.forces = new Forces(this.size);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(-0.4, -1, 1.4);
    this.camera.add(sun);
    this.scene.add(this.ambient, this.camera, this.grid, this.body, this.ghost, ...this.around,
                   ...this.traces, ...[...this.cables, ...this.fibres].flatMap(({rim, core}) => [rim, core]),
                   ...this.balls, this.target, this.gap, this.desiredPath, this.handles.group, this.forces.group);
    if (this.cloud) this.scene.add(this.cloud);
    if (this.field) this.scene.add(this.field.group);
    this.controls = new OrbitControls(this.camera);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => this.keepCamera());
    this.camera.up.set(0, 0, 1);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    this.lookFrom(viewDirection.clone());
    this.applyTheme();
  }

  /** Creates the arrow left of the robot; in the largest field [mT] it is a quarter of the robot long. */
  private makeFieldArrow(largest: number[] | null): Arrow | null {
    if (!largest) return null;
    const mmPerUnit = 0.25 * this.size / Math.hypot(...largest);
    const reach = new Vector3().fromArray(largest).multiplyScalar(mmPerUnit);
    const foot = this.box.getCenter(new Vector3()).setX(this.box.min.x - reach.x - 0.08 * this.size);
    this.box.expandByPoint(foot.clone().sub(reach)).expandByPoint(foot.clone().add(reach));
    return new Arrow(foot, mmPerUnit);
  }

  /** Sets all colours to those of the theme. */
  applyTheme(): void {
    this.scene.background = ofTheme('--stage');
    // bright enough for shaded sides to be visible
    this.ambient.intensity = document.documentElement.dataset.theme === 'dark' ? 2.2 : 1.3;
    for (const {rim} of this.cables) rim.material.color = ofTheme('--cable');
    for (const {rim, core} of this.fibres) {
      rim.material.color = ofTheme('--paper');
      core.material.color = ofTheme('--cable');
    }
    this.ghost.material.color = ofTheme('--ghost');
    for (const ball of [...this.balls, this.target]) ball.material.color = ofTheme('--target');
    for (const ring of this.rings) ring.material.color = ofTheme('--paper');
    for (const line of this.traces) line.material.color = ofTheme('--trace');
    if (this.cloud && !this.cloud.material.vertexColors) this.cloud.material.color = ofTheme('--accent');
    this.field?.setColour(ofTheme('--field'));
    this.forces.setColour(ofTheme('--force'));
    this.gap.material.color = ofTheme('--bad');
    this.desiredPath.material.color = ofTheme('--accent');
    const grid = this.grid.material;
    this.grid.geometry.deleteAttribute('color');
    grid.vertexColors = false;
    grid.color = ofTheme('--grid');
    grid.needsUpdate = true;
    this.setTensions(this.tensions);
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Connects the camera to the pointer; listeners that were added before are called first. */
  listen(): void { this.controls.connect(this.canvas); }

  /** Moves the camera so that the whole robot is visible from a direction, also on a narrow picture. */
  lookFrom(direction: Vector3): void {
    const middle = this.box.getCenter(new Vector3()), half = Math.tan(this.camera.fov * Math.PI / 360);
    const size = this.box.getSize(new Vector3()).length();
    const distance = 0.56 * size / half / Math.min(1, this.camera.aspect) + 0.1 * size;
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(direction.normalize(), distance);
    this.camera.near = this.size / 200;
    this.camera.far = this.size * 50;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** Moves the camera away where the robot leaves the visible box, unless the user has moved the camera. */
  private keepInSight(positions: Float32Array): void {
    const shape = new Box3().setFromArray(positions as unknown as number[]);
    if (this.box.containsBox(shape)) return;
    this.box.union(shape.expandByScalar(0.1 * this.size));
    this.isInSight = false;
    this.moveCameraBack();
  }

  private moveCameraBack(): void {
    if (this.isCameraKept || this.isCameraLocked || this.isInSight) return;
    this.isInSight = true;
    this.lookFrom(viewDirection.clone());
  }

  /** Keeps the camera where it is, whatever the robot does. */
  keepCamera(): void { this.isCameraKept = true; }

  /** Locks the camera during a drag. */
  lockCamera(locked: boolean): void {
    this.isCameraLocked = locked;
    this.moveCameraBack();
  }

  /** Turns the camera by angles [rad] and moves it nearer by a factor, for the keyboard. */
  turn(right: number, up: number, nearer: number): void {
    this.keepCamera();
    const off = this.camera.position.clone().sub(this.controls.target), flat = Math.hypot(off.x, off.y);
    const length = off.length() / nearer, azimuth = Math.atan2(off.y, off.x) + right;
    const height = Math.min(Math.max(Math.atan2(off.z, flat) + up, -1.5), 1.5);
    off.set(Math.cos(azimuth) * Math.cos(height), Math.sin(azimuth) * Math.cos(height), Math.sin(height));
    this.camera.position.copy(this.controls.target).addScaledVector(off, length);
    this.controls.update();
    this.draw();
  }

  setShape(positions: Float32Array, markers: number[][]): void {
    this.positions.copyArray(positions);
    this.keepInSight(positions);
    this.positions.needsUpdate = true;
    this.balls.forEach((ball, i) => { if (markers[i]) ball.position.fromArray(markers[i]); });
    for (const line of [...this.cables, ...this.fibres]) line.follow(positions);
    this.draw();
  }

  /** Colours the body by values; null: by region. */
  setColours(values: ArrayLike<number> | null, scale: Scale | null): void {
    const coloured = values !== null && scale !== null;
    if (coloured) {
      paint(values, scale, this.colours.array as Float32Array);
      this.colours.needsUpdate = true;
    }
    this.body.material.forEach((material, r, all) => {
      if (material.vertexColors !== coloured) material.needsUpdate = true;
      material.vertexColors = coloured;
      material.color.set(coloured ? '#ffffff' : bodyColour(r, all.length));
    });
    this.draw();
  }

  /** Colours the cables by their tensions, as fractions of the largest one; null: unknown. */
  setTensions(fractions: (number | null)[]): void {
    this.tensions = fractions;
    this.cables.forEach(({core}, c) => {
      const fraction = fractions[c] ?? null;
      if (fraction === null) core.material.color = ofTheme('--cable');
      else core.material.color.set(`rgb(${colourAt(fraction, false).map(Math.round).join()})`);
    });
    this.draw();
  }

  setTrace(marker: number, points: number[][]): void { this.setLine(this.traces[marker], points); }

  /** Shows the desired path of a marker. */
  setDesiredPath(points: number[][]): void {
    this.desiredPath.visible = points.length > 0;
    this.setLine(this.desiredPath, points);
  }

  private setLine(line: Thread, points: number[][]): void {
    line.geometry.dispose();
    line.geometry = new BufferGeometry().setFromPoints(points.map((at) => new Vector3().fromArray(at)));
    this.draw();
  }

  /** Shows the flux density of the uniform fields [mT]. */
  setField(field: number[]): void {
    this.field?.set(field);
    this.draw();
  }

  setForces(forces: EstimatedForce[]): void {
    this.forces.set(forces);
    this.draw();
  }

  setTarget(target: number[] | null, marker: number): void {
    this.target.visible = this.gap.visible = target !== null;
    if (target) {
      this.target.position.fromArray(target);
      this.gap.geometry.setFromPoints([this.target.position, this.balls[marker].position]);
    }
    this.draw();
  }

  show(part: Part, on: boolean): void {
    if (part === 'ghost') this.ghost.visible = on;
    if (part === 'grid') this.grid.visible = on;
    if (part === 'workspace' && this.cloud) this.cloud.visible = on;
    if (part === 'around') for (const mesh of this.around) mesh.visible = on;
    if (part === 'traces') for (const line of this.traces) line.visible = on;
    if (part === 'markers') for (const ball of this.balls) ball.visible = on;
    if (part === 'field' && this.field) this.field.group.visible = on;
    if (part === 'forces') this.forces.group.visible = on;
    if (part === 'clear') for (const material of this.body.material) {
      material.needsUpdate = material.transparent !== on;
      material.transparent = on;
      material.opacity = on ? 0.45 : 1;
      material.depthWrite = !on;
    }
    this.draw();
  }

  /** Projects a point onto the canvas [px]. */
  project(at: number[]): {x: number; y: number} {
    const p = new Vector3().fromArray(at).project(this.camera);
    return {x: (p.x + 1) / 2 * this.canvas.clientWidth, y: (1 - p.y) / 2 * this.canvas.clientHeight};
  }

  /** Returns the direction from the camera to a point, of unit length. */
  directionTo(at: number[]): number[] {
    return new Vector3().fromArray(at).sub(this.camera.position).normalize().toArray();
  }

  /** Projects a pixel onto the plane through a point with a normal, by default the plane of the screen. */
  under(x: number, y: number, through: number[], planeNormal?: number[]): number[] {
    const point = new Vector3().fromArray(through), normal = this.camera.getWorldDirection(new Vector3());
    if (planeNormal) normal.fromArray(planeNormal);
    const ray = new Vector3(2 * x / this.canvas.clientWidth - 1, 1 - 2 * y / this.canvas.clientHeight, 0.5)
      .unproject(this.camera).sub(this.camera.position).normalize();
    const distance = point.sub(this.camera.position).dot(normal) / ray.dot(normal);
    return this.camera.position.clone().addScaledVector(ray, distance).toArray();
  }

  /** Requests a new picture; several requests before the next frame give one picture. */
  draw(): void {
    if (this.isScheduled) return;
    this.isScheduled = true;
    requestAnimationFrame(() => {
      this.isScheduled = false;
      this.drawNow();
    });
  }

  private drawNow(): void {
    this.camera.updateMatrixWorld();
    const mmPerPxAtOne = 2 * Math.tan(this.camera.fov * Math.PI / 360) / (this.canvas.clientHeight || 1);
    this.handles.fit(this.camera, mmPerPxAtOne);
    this.field?.fit(this.camera, mmPerPxAtOne);
    this.forces.fit(this.camera, mmPerPxAtOne);
    this.renderer.render(this.scene, this.camera);
    this.onDrawn();
  }

  picture(): Promise<Blob | null> {
    this.drawNow();
    return new Promise((done) => this.canvas.toBlob(done, 'image/png'));
  }
}
