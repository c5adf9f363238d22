import './style.css';
import {type ComparisonDocument, readComparison, showComparison} from './comparison';
import {colourFor} from './colours';
import {makeCurves} from './curves';
import {type LiveDocument, readDocument, type RobotDocument, robotName} from './document';
import {makeDrag, placeOfHandles} from './drag';
import {fieldOf} from './field';
import {listenToKeys} from './keys';
import {Live} from './live';
import {makeLivePanel} from './live_panel';
import {makeLooks} from './looks';
import {eventTime, Meter} from './meter';
import {makeOutputs, makeTable, stateWords, showOrigin} from './numbers';
import {makePathPanel} from './path_panel';
import {makePlayer} from './player';
import {makeReadings} from './readings';
import {makeRecorder} from './record';
import {Robot} from './robot';
import {download, makeSave} from './save';
import {RobotScene} from './scene';
import {makeSliders} from './sliders';
import {makeTarget} from './target';
import {cornersOf, makeTensions} from './tensions';
import {byId} from './text';
import {makeLabels, explainSliders, showHeading} from './top';

function chooseTheme(dark: boolean): void {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  byId('theme').textContent = dark ? 'Light' : 'Dark';
  colourFor(dark);
}

async function savePicture(robot: Robot, scene: RobotScene): Promise<void> {
  const picture = await scene.picture();
  if (picture) download(`${robotName(robot.document)}.png`, picture);
}

/** Connects the robot to the running softkin view. */
function goLive(robot: Robot, meter: Meter, {path, model}: LiveDocument): Live {
  const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}${path}`;
  const live = new Live(url, location.hash.slice(1), model, robot.document.rest.length / 3, {
    onFrame: (frame, mine, newest) => {
      meter.answer(frame.id);
      robot.receive(frame, mine, newest);
    },
    onState: () => robot.onChange(),
    onOtherModel: () => location.reload(),
    onMap: (map) => {
      robot.takeMap(map);
      showOrigin(robot);
      robot.onChange();
    },
  });
  robot.link = {
    get state() { return live.state; },
    get busy() { return live.busy; },
    send: (request) => {
      const since = eventTime(), id = live.send(request);
      meter.request(id, since);
      return id;
    },
  };
  return live;
}

function readPage(): RobotDocument {
  const read = readDocument(byId('softkin-page').textContent ?? 'null');
  if (!read) throw new Error('This page contains no robot: open a page that softkin wrote.');
  // a page saved as a file has no running softkin
  return location.protocol.startsWith('http') ? read : {...read, live: null};
}

function startComparison(read: ComparisonDocument): void {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  chooseTheme(dark.matches);
  dark.addEventListener('change', () => chooseTheme(dark.matches));
  byId('theme').addEventListener('click', () => chooseTheme(document.documentElement.dataset.theme !== 'dark'));
  showComparison(read);
}

function start(): void {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  chooseTheme(dark.matches);
  const read = readPage(), robot = new Robot(read), canvas = byId<HTMLCanvasElement>('canvas'), meter = new Meter();
  showHeading(robot);
  const corners = cornersOf(robot);
  const shapes = [...read.steps.map(({positions}) => positions), ...corners.flatMap((at) => robot.shapeAt(at) ?? [])];
  const scene = new RobotScene(canvas, read, shapes);
  makeDrag(canvas, robot, scene);
  scene.listen();
  const live = read.live && goLive(robot, meter, read.live), player = makePlayer(robot);
  const undo = byId<HTMLButtonElement>('undo'), reset = byId<HTMLButtonElement>('reset'), state = byId('state');
  const parts = [makePathPanel(robot, scene, player), makeSliders(byId('sliders'), robot), makeTarget(robot),
                 makeLooks(robot, scene, shapes), makeTensions(robot, scene, byId('looks'), corners),
                 makeCurves(byId('curves'), robot), makeTable(robot), makeOutputs(robot),
                 makeSave(robot), player.update,
                 makeReadings(robot, () => scene.forces.mmPerNewton), ...(live ? [makeLivePanel(live)] : [])];
  const labels = makeLabels(robot, scene), record = makeRecorder(canvas, robot, player);
  byId('curves-section').hidden = !read.actuators.some((actuator) => actuator.load_unit);
  showOrigin(robot);
  byId('grid-size').textContent = `Grid: ${scene.gridMm} mm`;
  scene.onDrawn = () => {
    labels();
    record();
    meter.drawn();
  };
  robot.onChange = () => {
    scene.setForces(robot.estimate?.forces ?? []);  // first, as the readings panel shows the scale of the forces
    for (const part of parts) part();
    scene.setShape(robot.pose.positions, robot.pose.markers);
    scene.setTarget(robot.target?.at ?? null, robot.target?.marker ?? 0);
    scene.setField(fieldOf(read.actuators, robot.commands));
    scene.handles.set(placeOfHandles(robot));
    if (!live && robot.pose.from === 'map') meter.show(eventTime());
    explainSliders(robot, live && live.state);
    undo.disabled = !robot.canUndo;
    reset.disabled = !robot.able && !robot.steps.length;
    byId('hint').hidden ||= robot.canUndo;  // hidden after the first action
    const {text, bad} = stateWords(robot);
    if (state.textContent !== text) state.textContent = text;
    state.classList.toggle('bad', bad);
  };
  if (robot.steps.length > 1)
    read.markers.forEach((_, i) => scene.setTrace(i, robot.steps.map((step) => step.markers[i])));
  const actions = {undo: () => robot.undo(), reset: () => robot.reset(), play: () => player.toggle(),
                   picture: () => void savePicture(robot, scene)};
  undo.addEventListener('click', actions.undo);
  reset.addEventListener('click', actions.reset);
  byId('snapshot').addEventListener('click', actions.picture);
  const theme = (on: boolean) => {
    chooseTheme(on);
    scene.applyTheme();
    robot.onChange();  // redraws curves and cables in the theme's colours
  };
  byId('theme').addEventListener('click', () => theme(document.documentElement.dataset.theme !== 'dark'));
  dark.addEventListener('change', () => theme(dark.matches));
  listenToKeys(scene, actions);
  if (robot.steps.length === 1 && !robot.map) robot.showStep(0);  // the only shape on the page
  else robot.rest();
  live?.connect();
}

try {
  const comparison = readComparison(byId('softkin-page').textContent ?? 'null');
  if (comparison) startComparison(comparison);
  else start();
} catch (error) {
  byId('hint').textContent = `The robot can't be shown: ${error instanceof Error ? error.message : String(error)}`;
}
