import {type Frame, readFrame} from './frame';
import type {MapDocument} from './map';

/** What the page asks of softkin view; the newest alone counts. */
export type Ask = {type: 'command'; commands: number[]} | {type: 'target'; marker: number; at: number[]} |
  {type: 'readings'; commands: number[]; values: (number | null)[]};
/** connected: the server has said who controls; streamed: readings that come by its other port do. */
export interface LiveState {
  connected: boolean; secret: boolean; control: boolean; free: boolean; streamed: boolean; watchers: number;
  refused: string;
}
export interface LiveEvents {
  onFrame(frame: Frame, mine: boolean, newest: boolean): void;
  onState(state: LiveState): void;
  onOtherModel(): void;
  /** softkin has made it meanwhile. */
  onMap(map: MapDocument): void;
}
interface StateText extends Omit<LiveState, 'connected' | 'refused'> { type: 'state'; model: string }
interface MapText { type: 'map'; map: MapDocument }
interface RefusedText { type: 'refused'; id: number | null; why: string }

/** Of pauses before it tries again [ms]. */
const pauses = [500, 1000, 2000, 4000, 5000];
/** A search for a target that takes longer gives way to a newer request [ms]. */
const searchMs = 1000;

const away: LiveState = {connected: false, secret: false, control: false, free: false, streamed: false, watchers: 0,
                         refused: ''};

/** The connection to softkin view: at most one request is on its way, and the newest waits. */
export class Live {
  state: LiveState = away;
  private socket: WebSocket | null = null;
  private tries = 0;
  private lastId = 0;
  private onWay: {id: number; type: Ask['type']; since: number} | null = null;
  private waiting: {id: number; ask: Ask} | null = null;
  private newest = 0;
  private timer = 0;

  constructor(private readonly url: string, private readonly secret: string, private readonly model: string,
              private readonly vertices: number, private readonly events: LiveEvents) {}

  connect(): void {
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => socket.send(JSON.stringify({type: 'hello', secret: this.secret})));
    socket.addEventListener('message', ({data}: MessageEvent<string | ArrayBuffer>) => {
      if (socket !== this.socket) return;
      try {
        if (typeof data === 'string') this.hear(JSON.parse(data) as StateText | RefusedText | MapText);
        else this.show(readFrame(data, this.vertices));
      } catch (error) {
        socket.close();  // and begins anew
        throw error;
      }
    });
    socket.addEventListener('close', () => {
      if (socket !== this.socket) return;
      this.forget();
      this.tell(away);
      setTimeout(() => this.connect(), pauses[Math.min(this.tries++, pauses.length - 1)]);
    });
  }

  /** True while an answer to the newest request is to come. */
  get busy(): boolean { return this.onWay !== null || this.waiting !== null; }

  /** Number of the request. Larger than those of other windows before, and than those before a new connection. */
  send(ask: Ask): number {
    const id = this.lastId = Math.max(this.lastId + 1, Date.now() * 1000);
    this.waiting = {id, ask};
    this.newest = id;
    this.next();
    return id;
  }

  take(): void { this.say({type: 'take'}); }

  release(): void { this.say({type: 'release'}); }

  private say(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private next(): void {
    clearTimeout(this.timer);
    if (!this.waiting || !this.state.control) return;
    if (this.onWay) {
      const {type, since} = this.onWay, left = since + searchMs - Date.now();
      if (type !== 'target') return;
      if (left > 0) {
        this.timer = window.setTimeout(() => this.next(), left);
        return;
      }
    }
    const {id, ask} = this.waiting;
    this.onWay = {id, type: ask.type, since: Date.now()};
    this.waiting = null;
    this.say({...ask, id});
  }

  private forget(): void {
    clearTimeout(this.timer);
    this.onWay = this.waiting = null;
    this.newest = 0;
  }

  private tell(state: LiveState): void {
    this.state = state;
    if (!state.control) this.forget();
    this.events.onState(state);
  }

  private hear(message: StateText | RefusedText | MapText): void {
    if (message.type === 'state') {
      if (message.model !== this.model) {
        this.events.onOtherModel();
        return;
      }
      this.tries = 0;
      const {secret, control, free, streamed, watchers} = message;
      const refused = control === this.state.control ? this.state.refused : '';
      this.tell({connected: true, secret, control, free, streamed, watchers, refused});
    } else if (message.type === 'refused') {
      if (message.id !== null && message.id === this.onWay?.id) this.onWay = null;
      this.tell({...this.state, refused: message.why});
      this.next();
    } else if (message.type === 'map') {
      this.events.onMap(message.map);
    }
  }

  private show(frame: Frame): void {
    const mine = frame.id === this.onWay?.id, newest = frame.id === this.newest;
    if (mine) this.onWay = null;
    if (newest && this.state.refused) this.tell({...this.state, refused: ''});
    this.events.onFrame(frame, mine, newest);
    this.next();
  }
}
