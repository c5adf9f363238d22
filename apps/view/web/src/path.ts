import type {PathFile} from './csv';
import type {Track} from './player';
import type {Place, Robot} from './robot';

/** Time for inverse kinematics before the page can draw again [ms]. */
const sliceMs = 20;

/** The rows of a file, played with the map or with the running softkin. */
export class FileTrack implements Track {
  readonly name: string;
  readonly count: number;
  /** For each waypoint the largest distance of a marker [mm], NaN while unknown; empty for a file of commands. */
  readonly errors: Float64Array;
  private readonly commands: (number[] | null)[];
  private timer = 0;

  /** onFound: called when commands for more waypoints have been found. */
  constructor(private readonly robot: Robot, readonly file: PathFile, readonly fileName: string,
              private readonly onFound: () => void) {
    this.name = `rows of ${fileName}`;
    this.count = file.rows.length;
    this.commands = file.kind === 'commands' ? file.rows : file.rows.map(() => null);
    this.errors = new Float64Array(file.kind === 'waypoints' ? this.count : 0).fill(NaN);
  }

  /** Starts to compute the commands for the waypoints. */
  start(): void { if (this.file.kind === 'waypoints' && this.robot.map) this.solveFrom(0, this.robot.commands); }

  get at(): number { return this.robot.row; }

  time(i: number): number | null { return this.file.times?.[i] ?? null; }

  /** Returns why this page cannot play the file; empty where it can. */
  static refusal(robot: Robot, file: PathFile | null = null): string {
    const {link, map, document: {live}} = robot;
    if (robot.isEstimating) return 'This page estimates forces: type the readings, or stream them.';
    if (!map && !live) return 'This page contains no map (softkin fk --map), so it cannot move the robot.';
    if (live && !link?.state.control) return 'Take control first: this window only watches.';
    if (!file || file.kind === 'commands' || map) return '';
    return file.rows.some((row) => row.length > 1 || row[0].at.includes(null))
      ? 'Without a map (softkin view --map) waypoints need x_mm, y_mm and z_mm of one marker.' : '';
  }

  end(): void { clearTimeout(this.timer); }

  private solveFrom(first: number, start: number[]): void {
    const {rows} = this.file, until = performance.now() + sliceMs;
    let i = first, from = start;
    for (; i < rows.length && performance.now() < until; ++i) {
      const found = this.robot.findCommands(rows[i] as Place[], from);
      this.commands[i] = from = found?.commands ?? from;
      const markers = this.robot.evaluateMap(from)?.markers;
      if (markers && !this.robot.link) this.errors[i] = this.errorOf(i, markers);
    }
    this.onFound();
    if (i < rows.length) this.timer = window.setTimeout(() => this.solveFrom(i, from));
  }

  private places(i: number): Place[] { return this.file.kind === 'waypoints' ? this.file.rows[i] : []; }

  private errorOf(i: number, markers: number[][]): number {
    return Math.max(...this.places(i).map(({marker, at}) =>
      Math.hypot(...at.map((value, k) => value === null ? 0 : value - markers[marker][k]))));
  }

  show(i: number): void {
    const {robot} = this, commands = this.commands[i], [place] = this.places(i);
    if (commands) robot.command(commands, i);
    else if (place && robot.link) robot.reach(place.marker, place.at.map((value) => value ?? 0), i);
  }

  /** Updates the error of the shown row and the target after the robot has moved. */
  update(): void {
    const {robot} = this, {row, pose} = robot, [place] = row < 0 || row >= this.count ? [] : this.places(row);
    if (!place) return;
    if (!robot.link || (!robot.link.busy && pose.from === 'live')) this.errors[row] = this.errorOf(row, pose.markers);
    const errorMm = Number.isNaN(this.errors[row]) ? null : this.errors[row];
    const at = place.at.map((value, k) => value ?? pose.markers[place.marker][k]);
    robot.target = {marker: place.marker, at, errorMm, reached: false, why: robot.target?.why ?? ''};
  }

  /** Returns the desired path of the first marker; a free coordinate is that of the reference shape. */
  desiredPath(): number[][] {
    const {file, robot} = this;
    if (file.kind === 'commands') return [];
    return file.rows.map(([{marker, at}]) =>
      at.map((value, k) => value ?? robot.document.markers[marker].at[k]));
  }
}
