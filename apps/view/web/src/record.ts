import {robotName} from './document';
import type {Player} from './player';
import type {Robot} from './robot';
import {download} from './save';
import {byId, digits, withUnit} from './text';
import {drives} from './words';

/** Video formats in the order of preference: most programs read H.264; not every browser writes it. */
const kinds = [{type: 'video/mp4;codecs=avc1.640033', ending: 'mp4'}, {type: 'video/webm', ending: 'webm'},
               {type: 'video/mp4', ending: 'mp4'}];
const framesPerSecond = 30, lastMs = 700;  // how long the video shows the last shape

const kindOf = () => typeof MediaRecorder === 'undefined' || !HTMLCanvasElement.prototype.captureStream ? undefined
  : kinds.find(({type}) => MediaRecorder.isTypeSupported(type));

/** Formats the commands: "air = 1.4, tendon = 3 N". */
function commandsOf(robot: Robot): string {
  return robot.document.actuators.flatMap((actuator, i) => drives(actuator)
    ? [`${actuator.name} = ${withUnit(digits(robot.pose.commands[i]), actuator.unit)}`] : []).join(', ');
}

/** Frames of a video: the picture with the commands and the step written at its bottom. */
class Frames {
  readonly canvas = document.createElement('canvas');
  private readonly context = this.canvas.getContext('2d');

  constructor(private readonly picture: HTMLCanvasElement, private readonly robot: Robot) {
    this.canvas.width = picture.width - picture.width % 2;  // video codecs need even sizes
    this.canvas.height = picture.height - picture.height % 2;
  }

  draw(): void {
    const {context, canvas: {width, height}, picture} = this;
    if (!context) return;
    context.drawImage(picture, 0, 0, width, height);
    const size = Math.round(Math.max(14, height / 32)), words = [commandsOf(this.robot), byId('step-text').textContent];
    context.font = `${size}px sans-serif`;
    context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--text') || '#000';
    context.fillText(words.filter(Boolean).join('   '), size, height - size, width - 2 * size);
  }
}

/** A button that plays from the first step and saves a video; returns the function that records each drawn picture. */
export function makeRecorder(picture: HTMLCanvasElement, robot: Robot, player: Player): () => void {
  const button = byId<HTMLButtonElement>('record'), kind = kindOf();
  let frames: Frames | null = null, recorder: MediaRecorder | null = null;
  button.hidden = !kind;
  const end = () => setTimeout(() => recorder?.stop(), lastMs);
  const begin = ({type, ending}: {type: string; ending: string}) => {
    const made = frames = new Frames(picture, robot), parts: Blob[] = [];
    made.draw();
    const stream = made.canvas.captureStream(framesPerSecond);
    recorder = new MediaRecorder(stream, {mimeType: type, videoBitsPerSecond: 8e6});
    recorder.ondataavailable = ({data}) => parts.push(data);
    recorder.onstop = () => {
      for (const track of stream.getTracks()) track.stop();
      download(`${robotName(robot.document)}.${ending}`, new Blob(parts, {type: type.split(';')[0]}));
      frames = recorder = null;
      button.textContent = 'Record';
    };
    recorder.start();
    button.textContent = 'Stop';
    player.fromStart(end);
  };
  button.addEventListener('click', () => {
    if (recorder) player.stop();
    else if (kind) begin(kind);
  });
  return () => frames?.draw();
}
