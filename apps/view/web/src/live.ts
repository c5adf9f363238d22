import {type Frame, readFrame} from './frame';
import type {MapDocument} from './map';

/** A request of the page to softkin view; only the newest one counts. */
export type LiveRequest = {type: 'command'; commands: number[]} | {type: 'target'; marker: number; at: number[]} |
  {type: 'readings'; commands: number[]; values: (number | null)[]};
/** connected: the server has reported who has control; free: nobody has; streamed: a stream of readings has. */
export interface LiveState {
  connected: boolean; secret: boolean; control: boolean; free: boolean; streamed: boolean; watchers: number;
  refused: string;
}
export interface LiveEvents {
  onFrame(frame: Frame, mine: boolean, newest: boolean): void;
  onState(state: LiveState): void;
  onOtherModel(): void;
  /** softkin has finished a map in the background. */
  onMap(map: MapDocument): void;
}
interface StateText extends Omit<LiveState, 'connected' | 'refused'> { type: 'state'; model: string }
interface MapText { type: 'map'; map: MapDocument }
interface RefusedText { type: 'refused'; id: number | null; why: string }

/** Delays before the next attempts to connect [ms]. */
const pauses = [500, 1000, 2000, 4000, 5000];
/** A newer request interrupts a search for a target that takes longer than this [ms]. */
const searchMs = 1000;

const disconnected: LiveState = {
  connected: false, secret: false, control: false, free: false, streamed: false, watchers: 0, refused: '',
};

/** The connection to softkin view: at most one request is in flight, and only the newest one waits. */
export class Live {
  state: LiveState = disconnected;
  private socket: WebSocket | null = null;
  private attempts = 0;
  private lastId = 0;
  private inFlight: {id: number; type: LiveRequest['type']; since: number} | null = null;
  private waiting: {id: number; request: LiveRequest} | null = null;
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
        if (typeof data === 'string') this.receive(JSON.parse(data) as StateText | RefusedText | MapText);
        else this.receiveFrame(readFrame(data, this.vertices));
      } catch (error) {
        socket.close();  // and connects again
        throw error;
      }
    });
    socket.addEventListener('close', () => {
      if (socket !== this.socket) return;
      this.clearRequests();
      this.setState(disconnected);
      setTimeout(() => this.connect(), pauses[Math.min(this.attempts++, pauses.length - 1)]);
    });
  }

  /** Returns whether the answer to the newest request is still missing. */
  get busy(): boolean { return this.inFlight !== null || this.waiting !== null; }

  /** Queues a request and returns its number, which is larger than those of earlier connections and windows. */
  send(request: LiveRequest): number {
    const id = this.lastId = Math.max(this.lastId + 1, Date.now() * 1000);
    this.waiting = {id, request};
    this.newest = id;
    this.sendNext();
    return id;
  }

  take(): void { this.sendMessage({type: 'take'}); }

  release(): void { this.sendMessage({type: 'release'}); }

  private sendMessage(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private sendNext(): void {
    clearTimeout(this.timer);
    if (!this.waiting || !this.state.control) return;
    if (this.inFlight) {
      const {type, since} = this.inFlight, left = since + searchMs - Date.now();
      if (type !== 'target') return;
      if (left > 0) {
        this.timer = window.setTimeout(() => this.sendNext(), left);
        return;
      }
    }
    const {id, request} = this.waiting;
    this.inFlight = {id, type: request.type, since: Date.now()};
    this.waiting = null;
    this.sendMessage({...request, id});
  }

  private clearRequests(): void {
    clearTimeout(this.timer);
    this.inFlight = this.waiting = null;
    this.newest = 0;
  }

  private setState(state: LiveState): void {
    this.state = state;
    if (!state.control) this.clearRequests();
    this.events.onState(state);
  }

  private receive(message: StateText | RefusedText | MapText): void {
    if (message.type === 'state') {
      if (message.model !== this.model) {
        this.events.onOtherModel();
        return;
      }
      this.attempts = 0;
      const {secret, control, free, streamed, watchers} = message;
      const refused = control === this.state.control ? this.state.refused : '';
      this.setState({connected: true, secret, control, free, streamed, watchers, refused});
    } else if (message.type === 'refused') {
      if (message.id !== null && message.id === this.inFlight?.id) this.inFlight = null;
      this.setState({...this.state, refused: message.why});
      this.sendNext();
    } else if (message.type === 'map') {
      this.events.onMap(message.map);
    }
  }

  private receiveFrame(frame: Frame): void {
    const mine = frame.id === this.inFlight?.id, newest = frame.id === this.newest;
    if (mine) this.inFlight = null;
    if (newest && this.state.refused) this.setState({...this.state, refused: ''});
    this.events.onFrame(frame, mine, newest);
    this.sendNext();
  }
}
