import {PathError, readPath} from './csv';
import {drawn} from './curves';
import {FileTrack} from './path';
import {type Player, StepTrack} from './player';
import type {Robot} from './robot';
import type {RobotScene} from './scene';
import {readState} from './state';
import {byId, digits, element, mm} from './text';

const width = 340, height = 120, left = 40, right = 10, top = 20, bottom = 22;

/** Plots the distances from the waypoints over the rows. */
function plot(svg: SVGElement, track: FileTrack): void {
  const errors = [...track.errors].map((error, i) => [i, error]).filter(([, error]) => !Number.isNaN(error));
  const high = Math.max(1e-3, ...errors.map(([, error]) => error)), base = height - bottom;
  const x = (i: number) => left + i / Math.max(track.count - 1, 1) * (width - left - right);
  const y = (error: number) => base - error / high * (base - top);
  svg.replaceChildren(
    drawn('path', {class: 'axis', d: `M${left},${top}V${base}H${width - right}`}),
    drawn('text', {x: left, y: 12}, 'Distance from the waypoint [mm]'),
    drawn('text', {x: left - 4, y: top + 5, 'text-anchor': 'end'}, digits(high, 2)),
    drawn('text', {x: left - 4, y: base, 'text-anchor': 'end'}, '0'),
    drawn('text', {x: left, y: base + 14}, '1'),
    drawn('text', {x: width - right, y: base + 14, 'text-anchor': 'end'}, `row ${track.count}`),
    drawn('polyline', {class: 'sweep', points: errors.map(([i, error]) => `${x(i)},${y(error)}`).join(' ')}),
    ...errors.filter(([i]) => i === track.at)
      .map(([i, error]) => drawn('circle', {class: 'now', cx: x(i), cy: y(error), r: 5})));
}

function wordsOf(track: FileTrack): string {
  const {file, count, fileName, errors} = track;
  if (file.kind === 'commands') return `${fileName}: ${count} rows of commands.`;
  const known = [...errors].filter((error) => !Number.isNaN(error));
  if (!known.length) return `${fileName}: ${count} waypoints. Play them below the picture.`;
  const largest = Math.max(...known), row = errors.indexOf(largest);
  const mean = known.reduce((sum, error) => sum + error, 0) / known.length;
  return `${fileName}: ${known.length} of ${count} waypoints solved. Farthest from its waypoint: row ${row + 1} ` +
    `(line ${file.lines[row]}), ${mm(largest)} mm; on average ${mm(mean)} mm.`;
}

/** Plays a file of commands or waypoints that is opened or dropped; returns the function that updates its curve. */
export function makePathPanel(robot: Robot, scene: RobotScene, player: Player): () => void {
  const box = byId('path'), {actuators, markers} = robot.document;
  const able = !robot.isEstimating && (robot.map !== null || robot.document.live !== null);
  let track: FileTrack | null = null, drawnAt = -2;
  const choose = element('input', {type: 'file', accept: '.csv,.yaml,.yml,text/csv', class: 'away', tabindex: -1,
                                   'aria-hidden': 'true'});
  const open = element('button', {type: 'button'}, 'Open a file …');
  const close = element('button', {type: 'button'}, 'Close the file');
  const summary = element('p', {role: 'status'}), wrong = element('p', {role: 'alert', class: 'bad message'});
  const svg = drawn('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img',
                            'aria-label': 'Distance from the waypoints'});
  close.hidden = true;
  svg.setAttribute('hidden', '');
  box.append(element('div', {class: 'buttons'}, open, close), choose, summary, svg, wrong);
  byId('path-section').hidden = !able;
  byId('explain-path').textContent = 'Drop a CSV file on this page. Columns named by actuators contain commands (' +
    `${actuators.slice(0, 3).map(({name}) => name).join(', ')}${actuators.length > 3 ? ', …' : ''}); ` +
    `x_mm, y_mm, z_mm contain waypoints${markers.length > 1 ? ` (${markers[0].name}_x_mm, …)` : ''}; ` +
    't_s is the time. A state that was saved here (YAML) is shown again.';
  const update = (always: boolean) => {
    if (!track || (!always && track.at === drawnAt && !robot.link)) return;
    drawnAt = track.at;
    summary.textContent = wordsOf(track);
    if (track.errors.length) plot(svg, track);
  };
  const closeFile = () => {
    track?.end();
    track = null;
    robot.row = -1;
    summary.textContent = '';
    close.hidden = true;
    svg.setAttribute('hidden', '');
    scene.setDesiredPath([]);
    player.setTrack(new StepTrack(robot));
  };
  const showState = (text: string) => {
    const commands = readState(text, actuators), refusal = FileTrack.refusal(robot);
    if (refusal) throw new PathError(refusal);
    robot.remember();
    robot.command(commands);
  };
  const read = async (file: File) => {
    byId('path-section').hidden = false;
    wrong.textContent = '';
    try {
      if (/\.ya?ml$/i.test(file.name)) return showState(await file.text());
      const path = readPath(await file.text(), actuators, markers), refusal = FileTrack.refusal(robot, path);
      if (refusal) throw new PathError(refusal);
      closeFile();
      const next = track = new FileTrack(robot, path, file.name, () => { if (track === next) update(true); });
      track.start();
      close.hidden = false;
      svg.toggleAttribute('hidden', path.kind === 'commands');
      scene.setDesiredPath(track.desiredPath());
      player.setTrack(track);
      update(true);
      player.toggle();
    } catch (error) {
      wrong.textContent = `${file.name}: ${error instanceof Error ? error.message : String(error)}`;
      box.scrollIntoView({block: 'nearest'});
      if (!(error instanceof PathError)) throw error;
    }
  };
  open.addEventListener('click', () => choose.click());
  close.addEventListener('click', closeFile);
  choose.addEventListener('change', () => {
    const [file] = choose.files ?? [];
    choose.value = '';
    if (file) void read(file);
  });
  listenToDrops((file) => void read(file));
  return () => {
    track?.update();
    update(false);
  };
}

function listenToDrops(read: (file: File) => void): void {
  const mark = (on: boolean) => document.body.classList.toggle('dropping', on);
  window.addEventListener('dragover', (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    mark(true);
  });
  window.addEventListener('dragleave', (event) => { if (!event.relatedTarget) mark(false); });
  window.addEventListener('drop', (event) => {
    mark(false);
    const file = event.dataTransfer?.files[0];
    if (!file) return;
    event.preventDefault();
    read(file);
  });
}
